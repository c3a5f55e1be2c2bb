#include "engine/runtime/frame_writer.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <system_error>

#include "engine/core/error.h"
#include "engine/io/png.h"

namespace viscera {
namespace {

std::string stem(std::uint64_t index) {
    std::array<char, 24> text{};
    std::snprintf(text.data(), text.size(), "%04llu", static_cast<unsigned long long>(index));
    return text.data();
}

}  // namespace

TargetReport summarise(const std::string& name, const Image& image) {
    TargetReport report{.name = name, .format = image.format, .width = image.width, .height = image.height};
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const float value : to_floats(image)) {
        if (std::isnan(value)) {
            ++report.nan;
        } else if (std::isinf(value)) {
            ++report.inf;
        } else {
            low = std::min(low, static_cast<double>(value));
            high = std::max(high, static_cast<double>(value));
        }
    }
    if (low <= high) {
        report.min = low;
        report.max = high;
    }
    return report;
}

FrameWriter::FrameWriter(FrameWriterOptions options, std::function<void(FrameReport&&)> done)
    : options_(std::move(options)), done_(std::move(done)) {
    std::error_code failure;
    std::filesystem::create_directories(options_.folder, failure);
    if (failure) {
        throw Error(ErrorCode::file, options_.folder.string(),
                    "cannot make this folder: " + failure.message());
    }
    // Before anything is rendered that could not be kept.
    if (::access(options_.folder.c_str(), W_OK | X_OK) != 0) {
        throw Error(ErrorCode::file, options_.folder.string(),
                    "cannot be written: " + std::generic_category().message(errno));
    }
    thread_ = std::thread([this] { run(); });
}

FrameWriter::~FrameWriter() {
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void FrameWriter::rethrow_locked() {
    if (error_) {
        std::rethrow_exception(error_);
    }
}

void FrameWriter::submit(CapturedFrame&& frame) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return error_ || frames_.size() < options_.queue; });
    rethrow_locked();
    frames_.push_back(std::move(frame));
    changed_.notify_all();
}

void FrameWriter::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return error_ || (frames_.empty() && !busy_); });
    rethrow_locked();
}

void FrameWriter::run() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return stop_ || (!error_ && !frames_.empty()); });
        if (error_ || frames_.empty()) {
            return;  // told to stop, and nothing is left that could be written
        }
        CapturedFrame frame = std::move(frames_.front());
        frames_.pop_front();
        busy_ = true;
        lock.unlock();
        std::exception_ptr failure;
        try {
            write(frame);
            if (done_) {
                done_(std::move(frame.report));
            }
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        busy_ = false;
        error_ = failure;
        changed_.notify_all();
    }
}

namespace {

/// All digits of a time: EXR headers hold floats, and a state that is loaded again goes on from this time.
std::string exact_text(double value) {
    std::array<char, 32> text{};
    const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
    return {text.data(), result.ptr};
}

}  // namespace

void FrameWriter::write(CapturedFrame& frame) const {
    const std::string prefix = stem(frame.report.index) + ".";
    std::vector<io::ExrPart> parts;
    frame.report.targets.clear();
    for (CapturedTarget& target : frame.targets) {
        TargetReport report = summarise(target.name, target.image);
        if (std::ranges::find(options_.png, target.name) != options_.png.end()) {
            io::write_png(options_.folder / (prefix + target.name + ".png"), target.image, {.alpha = false});
        }
        io::ExrPart part{
            .name = target.name, .image = std::move(target.image), .attributes = options_.attributes};
        part.attributes.push_back({"viscera:time_s", static_cast<float>(frame.report.time_s)});
        part.attributes.push_back({"viscera:time", exact_text(frame.report.time_s)});
        part.attributes.push_back({"viscera:frame", static_cast<float>(frame.report.index)});
        const std::filesystem::path file =
            options_.folder / (prefix + (options_.multipart ? "exr" : target.name + ".exr"));
        report.file = file.string();
        if (!options_.multipart) {
            io::write_exr(file, std::span(&part, 1), options_.compression);
        }
        parts.push_back(std::move(part));
        frame.report.targets.push_back(std::move(report));
    }
    if (options_.multipart && !parts.empty()) {
        io::write_exr(options_.folder / (prefix + "exr"), parts, options_.compression);
    }
}

}  // namespace viscera
