#include "engine/io/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <system_error>
#include <utility>

#include "engine/core/error.h"

namespace viscera::io {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, int error) {
    throw Error(ErrorCode::file, file.string(), what + ": " + std::generic_category().message(error));
}

/// Closes a descriptor however the scope is left.
class Descriptor {
  public:
    explicit Descriptor(int value) : value_(value) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { static_cast<void>(close()); }

    [[nodiscard]] int get() const { return value_; }
    /// 0, or the error that only closing brings to light (quota, network folders).
    [[nodiscard]] int close() {
        const int value = std::exchange(value_, -1);
        return value >= 0 && ::close(value) != 0 ? errno : 0;
    }

  private:
    int value_;
};

/// Removes the unfinished file unless it has been renamed.
class Unfinished {
  public:
    explicit Unfinished(std::filesystem::path path) : path_(std::move(path)) {}
    Unfinished(const Unfinished&) = delete;
    Unfinished& operator=(const Unfinished&) = delete;
    ~Unfinished() {
        if (!finished_) {
            ::unlink(path_.c_str());
        }
    }
    void finish() { finished_ = true; }

  private:
    std::filesystem::path path_;
    bool finished_ = false;
};

/// Opens a new file beside the final one, under a name of its own; gives that name. Names are drawn, so that
/// none comes twice: whoever still knows one from before (to remove it, say) cannot hit another's file.
std::pair<int, std::filesystem::path> open_beside(const std::filesystem::path& file) {
    constexpr int most_tries = 1000;
    std::random_device draw;
    for (int n = 0;; ++n) {
        std::filesystem::path beside = file;
        beside.replace_filename("." + file.filename().string() + "." + std::to_string(draw()) + ".part");
        const int descriptor = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) {
            return {descriptor, std::move(beside)};
        }
        if (errno != EEXIST || n == most_tries) {
            fail(file, "cannot be written", errno);
        }
    }
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::size_t most_bytes) {
    Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor.get() < 0) {
        fail(file, "cannot be opened", errno);
    }
    struct stat status {};
    if (::fstat(descriptor.get(), &status) != 0) {
        fail(file, "cannot be read", errno);
    }
    if (!S_ISREG(status.st_mode)) {
        throw Error(ErrorCode::file, file.string(), "is not a file");
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size > most_bytes) {
        throw Error(ErrorCode::file, file.string(),
                    std::to_string(size) + " bytes are more than the " + std::to_string(most_bytes) +
                        " that are read");
    }
    std::string bytes(size, '\0');
    std::size_t done = 0;
    while (done < size) {
        const ssize_t got = ::read(descriptor.get(), bytes.data() + done, size - done);
        if (got < 0 && errno != EINTR) {
            fail(file, "cannot be read", errno);
        }
        if (got == 0) {
            break;
        }
        done += got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    bytes.resize(done);
    return bytes;
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
    write_file(file, std::span(&bytes, 1));
}

void write_file(const std::filesystem::path& file, std::span<const std::string_view> parts) {
    auto [opened, beside] = open_beside(file);
    Descriptor descriptor(opened);
    Unfinished unfinished(beside);
    for (std::string_view bytes : parts) {
        while (!bytes.empty()) {
            const ssize_t put = ::write(descriptor.get(), bytes.data(), bytes.size());
            if (put < 0 && errno != EINTR) {
                fail(file, "cannot be written", errno);
            }
            bytes.remove_prefix(put > 0 ? static_cast<std::size_t>(put) : 0);
        }
    }
    if (const int error = descriptor.close(); error != 0) {
        fail(file, "cannot be written", error);
    }
    if (::rename(beside.c_str(), file.c_str()) != 0) {
        fail(file, "cannot be written", errno);
    }
    unfinished.finish();
}

std::string lower_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension;
}

}  // namespace viscera::io
