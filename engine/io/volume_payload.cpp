#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <system_error>
#include <vector>

#include "engine/core/error.h"
#include "engine/io/volume_head.h"

namespace viscera::io {

namespace {

/// A file that is read from front to back.
class InputFile {
  public:
    InputFile(const std::filesystem::path& file, std::uint64_t offset)
        : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)), at_(offset) {
        if (descriptor_ < 0) {
            throw std::system_error(errno, std::generic_category(), file.filename().string());
        }
    }
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile() { ::close(descriptor_); }

    /// As many bytes as there are, up to `size`.
    std::size_t read(void* bytes, std::size_t size) {
        std::size_t done = 0;
        while (done < size) {
            const ssize_t got = ::pread(descriptor_, static_cast<char*>(bytes) + done, size - done,
                                        static_cast<off_t>(at_ + done));
            if (got < 0 && errno != EINTR) {
                throw std::system_error(errno, std::generic_category(), "reading");
            }
            if (got == 0) {
                break;
            }
            done += got > 0 ? static_cast<std::size_t>(got) : 0;
        }
        at_ += done;
        return done;
    }

  private:
    int descriptor_;
    std::uint64_t at_;
};

/// Unpacks zlib and gzip, several gzip members one after another included.
class Inflater {
  public:
    Inflater(const std::filesystem::path& file, std::uint64_t offset) : input_(file, offset) {
        constexpr int either_kind = 47;  // 15 bits of window + 32: zlib or gzip
        if (inflateInit2(&stream_, either_kind) != Z_OK) {
            throw std::runtime_error("zlib does not start");
        }
    }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
    ~Inflater() { inflateEnd(&stream_); }

    std::size_t read(std::byte* bytes, std::size_t size) {
        std::size_t done = 0;
        while (done < size) {
            if (stream_.avail_in == 0) {
                stream_.avail_in = static_cast<uInt>(input_.read(packed_.data(), packed_.size()));
                stream_.next_in = packed_.data();
            }
            if (ended_ && (stream_.avail_in == 0 || inflateReset(&stream_) != Z_OK)) {
                break;
            }
            ended_ = false;
            const auto room = static_cast<uInt>(std::min<std::size_t>(size - done, 1U << 30U));
            stream_.next_out = reinterpret_cast<Bytef*>(bytes + done);
            stream_.avail_out = room;
            const bool at_end = stream_.avail_in == 0;
            const int status = inflate(&stream_, Z_NO_FLUSH);
            done += room - stream_.avail_out;
            if (status == Z_STREAM_END) {
                ended_ = true;
            } else if (status == Z_BUF_ERROR && at_end) {
                break;
            } else if (status != Z_OK && status != Z_BUF_ERROR) {
                throw std::runtime_error("its packed voxels are damaged");
            }
        }
        return done;
    }

  private:
    InputFile input_;
    z_stream stream_{};
    std::vector<Bytef> packed_ = std::vector<Bytef>(std::size_t{1} << 18U);
    bool ended_ = false;
};

/// A reader that fails, naming the file, where `source` throws or ends early.
template <class Source>
ReadBytes checked(std::shared_ptr<Source> source, const Reading& reading) {
    return [source = std::move(source), &reading](std::span<std::byte> bytes) {
        std::size_t got = 0;
        try {
            got = source->read(bytes.data(), bytes.size());
        } catch (const std::exception& error) {
            reading.fail(error.what());
        }
        if (got != bytes.size()) {
            reading.fail("is truncated: its voxels end too early");
        }
    };
}

}  // namespace

void Reading::fail(const std::string& message) const {
    throw Error(ErrorCode::file, file.string(), message);
}

void Reading::progress(double fraction) const {
    if (options.progress && !options.progress(std::clamp(fraction, 0.0, 1.0))) {
        throw Error(ErrorCode::usage, file.string(), "cancelled");
    }
}

std::uint64_t size_of(const std::filesystem::path& file, const Reading& reading) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        reading.fail(file == reading.file
                         ? "is not a file"
                         : "its voxels are to be in '" + file.string() + "', which is not a file");
    }
    const std::uint64_t size = std::filesystem::file_size(file, error);
    if (error) {
        reading.fail(error.message());
    }
    return size;
}

ReadBytes open_payload(const Payload& payload, std::uint64_t due, const Reading& reading) {
    constexpr std::uint64_t best_compression = 1100;  // zlib's own limit is 1032
    const std::uint64_t size = size_of(payload.file, reading);
    const std::uint64_t there = size - std::min(size, payload.offset);
    const std::string needs = "needs " + std::to_string(due) + " bytes of voxels";
    try {
        if (payload.packing == Packing::none) {
            if (there < due) {
                reading.fail("is truncated or lies about its size: " + needs + ", holds " +
                             std::to_string(there));
            }
            return checked(std::make_shared<InputFile>(payload.file, payload.offset), reading);
        }
        if (due / best_compression > there + 1) {
            reading.fail("is truncated or lies about its size: " + needs + ", which " +
                         std::to_string(there) + " packed bytes cannot hold");
        }
        return checked(std::make_shared<Inflater>(payload.file, payload.offset), reading);
    } catch (const std::system_error& error) {
        reading.fail(error.what());
    }
}

ReadBytes read_from_memory(std::span<const std::byte> bytes, const Reading& reading) {
    return [bytes, &reading](std::span<std::byte> out) mutable {
        if (out.size() > bytes.size()) {
            reading.fail("is truncated: its voxels end too early");
        }
        std::memcpy(out.data(), bytes.data(), out.size());
        bytes = bytes.subspan(out.size());
    };
}

ReadBytes read_slice_by_slice(std::function<std::vector<std::byte>(std::size_t)> make_slice) {
    struct State {
        std::vector<std::byte> slice;
        std::size_t at = 0;
        std::size_t next = 0;
    };
    return [make_slice = std::move(make_slice), state = State{}](std::span<std::byte> out) mutable {
        while (!out.empty()) {
            if (state.at == state.slice.size()) {
                state.slice = make_slice(state.next++);
                state.at = 0;
            }
            const std::size_t size = std::min(out.size(), state.slice.size() - state.at);
            std::memcpy(out.data(), state.slice.data() + state.at, size);
            state.at += size;
            out = out.subspan(size);
        }
    };
}

namespace {

template <class T>
std::vector<std::byte> encode_as(std::span<const double> numbers, const Reading& reading) {
    std::vector<std::byte> bytes(numbers.size() * sizeof(T));
    std::byte* out = bytes.data();
    for (const double number : numbers) {
        if constexpr (std::is_integral_v<T>) {
            // One beyond the largest is a power of two, which double has.
            constexpr auto half = std::numeric_limits<T>::max() / 2 + 1;
            constexpr double end = 2.0 * static_cast<double>(half);
            if (!(number >= static_cast<double>(std::numeric_limits<T>::min()) && number < end)) {
                reading.fail("voxels: " + std::to_string(number) +
                             " is no number of the type that they have");
            }
        }
        const T value = static_cast<T>(number);
        std::memcpy(out, &value, sizeof value);
        out += sizeof value;
    }
    return bytes;
}

}  // namespace

std::vector<std::byte> encode(std::span<const double> numbers, FileScalar type, const Reading& reading) {
    switch (type) {
        case FileScalar::u8:
            return encode_as<std::uint8_t>(numbers, reading);
        case FileScalar::i8:
            return encode_as<std::int8_t>(numbers, reading);
        case FileScalar::u16:
            return encode_as<std::uint16_t>(numbers, reading);
        case FileScalar::i16:
            return encode_as<std::int16_t>(numbers, reading);
        case FileScalar::u32:
            return encode_as<std::uint32_t>(numbers, reading);
        case FileScalar::i32:
            return encode_as<std::int32_t>(numbers, reading);
        case FileScalar::u64:
            return encode_as<std::uint64_t>(numbers, reading);
        case FileScalar::i64:
            return encode_as<std::int64_t>(numbers, reading);
        case FileScalar::f32:
            return encode_as<float>(numbers, reading);
        case FileScalar::f64:
            return encode_as<double>(numbers, reading);
    }
    return {};
}

}  // namespace viscera::io
