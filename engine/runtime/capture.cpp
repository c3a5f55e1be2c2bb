#include "engine/runtime/capture.h"

#include "engine/core/error.h"

namespace viscera {
namespace {

// Frames under way: enough to hide the read-back, few enough to bound the memory.
constexpr std::size_t frames_in_flight = 3;
// A tag holds the frame's number above this many bits of the target's.
constexpr unsigned target_bits = 16;

}  // namespace

Image clear_image(const PlanContent& content) {
    Image image = make_image(content.width, content.height, content.format);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, content.clear[static_cast<std::size_t>(c)]);
            }
        }
    }
    return image;
}

void Capture::start(const FrameReport& report, const std::vector<std::string>& names,
                    const Executor& executor) {
    hand_over();
    while (pending_.size() >= frames_in_flight) {
        place(read_back_.wait().value());
    }
    const std::uint64_t number = first_frame_ + pending_.size();
    pending_.push_back({.frame = {.report = report, .targets = {}}, .missing = 0});
    Pending& pending = pending_.back();
    for (const std::string& name : names) {
        const std::optional<Executor::Output> output = executor.output(name);
        if (!output) {
            throw Error(ErrorCode::usage, "dump", "no live pass writes a target '" + name + "'");
        }
        if (output->texture == nullptr) {
            pending.frame.targets.push_back({name, clear_image(*output->content)});
            continue;
        }
        read_back_.start(*output->texture, (number << target_bits) | pending.frame.targets.size());
        pending.frame.targets.push_back({name, {}});
        ++pending.missing;
    }
    poll(false);
}

void Capture::place(gl::ReadBack::Result&& result) {
    Pending& pending = pending_[static_cast<std::size_t>((result.tag >> target_bits) - first_frame_)];
    pending.frame.targets[result.tag & ((1U << target_bits) - 1U)].image = std::move(result.image);
    --pending.missing;
    hand_over();
}

void Capture::hand_over() {
    while (!pending_.empty() && pending_.front().missing == 0) {
        CapturedFrame frame = std::move(pending_.front().frame);
        pending_.pop_front();
        ++first_frame_;
        if (sink_) {
            sink_(std::move(frame));
        }
    }
}

void Capture::poll(bool wait) {
    while (std::optional<gl::ReadBack::Result> result = wait ? read_back_.wait() : read_back_.poll()) {
        place(std::move(*result));
    }
    hand_over();
}

}  // namespace viscera
