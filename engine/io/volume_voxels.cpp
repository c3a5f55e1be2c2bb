#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/size_text.h"
#include "engine/io/volume_head.h"

namespace viscera::io {

namespace {

constexpr std::uint64_t slab_bytes = std::uint64_t{8} << 20U;

/// Bytes of the machine's memory that are free to use; no limit where the system does not tell.
std::uint64_t available_memory() {
    std::ifstream stream("/proc/meminfo");
    std::string key;
    std::uint64_t kibibytes = 0;
    while (stream >> key) {
        if (key == "MemAvailable:" && stream >> kibibytes) {
            return kibibytes * 1024;
        }
        stream.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    return std::numeric_limits<std::uint64_t>::max();
}

ScalarType kept_type(FileScalar type) {
    switch (type) {
        case FileScalar::u8:
            return ScalarType::u8;
        case FileScalar::i8:
            return ScalarType::i8;
        case FileScalar::u16:
            return ScalarType::u16;
        case FileScalar::i16:
            return ScalarType::i16;
        default:
            return ScalarType::f32;
    }
}

void swap_bytes(std::span<std::byte> bytes, std::size_t width) {
    for (std::size_t at = 0; at + width <= bytes.size(); at += width) {
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + width));
    }
}

/// Numbers of another type to f32; gives the largest difference among those that stay finite.
template <class T>
double narrow(const std::byte* in, std::span<std::byte> out) {
    double worst = 0.0;
    for (std::size_t at = 0; at < out.size(); at += sizeof(float), in += sizeof(T)) {
        T wide{};
        std::memcpy(&wide, in, sizeof wide);
        const auto value = static_cast<float>(wide);
        // 64-bit integers need more digits than double has.
        const auto error = static_cast<double>(std::abs(static_cast<long double>(wide) - value));
        worst = std::isfinite(error) ? std::max(worst, error) : worst;
        std::memcpy(out.data() + at, &value, sizeof value);
    }
    return worst;
}

double narrow(FileScalar type, const std::byte* in, std::span<std::byte> out) {
    switch (type) {
        case FileScalar::u32:
            return narrow<std::uint32_t>(in, out);
        case FileScalar::i32:
            return narrow<std::int32_t>(in, out);
        case FileScalar::u64:
            return narrow<std::uint64_t>(in, out);
        case FileScalar::i64:
            return narrow<std::int64_t>(in, out);
        default:
            return narrow<double>(in, out);
    }
}

/// Brings the bytes of a file into the form that a Volume has.
class Converter {
  public:
    Converter(const VolumeHead& head, const ReadBytes& read)
        : type_(head.type), swap_(head.big_endian), read_(read) {}

    void fill(std::span<std::byte> out) {
        const std::size_t width = bytes_of(type_);
        const std::size_t kept = viscera::bytes_of(kept_type(type_));
        const bool same = type_ <= FileScalar::i16 || type_ == FileScalar::f32;
        if (!same) {
            wide_.resize(out.size() / kept * width);
        }
        const std::span<std::byte> target = same ? out : std::span(wide_);
        read_(target);
        if (swap_ && width > 1) {
            swap_bytes(target, width);
        }
        if (!same) {
            narrowing_error_ = std::max(narrowing_error_, narrow(type_, wide_.data(), out));
        }
    }
    [[nodiscard]] double narrowing_error() const { return narrowing_error_; }

  private:
    FileScalar type_;
    bool swap_;
    const ReadBytes& read_;
    std::vector<std::byte> wide_;
    double narrowing_error_ = 0.0;
};

std::uint64_t slice_bytes(const VolumeHead& head) {
    return static_cast<std::uint64_t>(head.volume.grid.dims.x) *
           static_cast<std::uint64_t>(head.volume.grid.dims.y) *
           static_cast<std::uint64_t>(head.volume.channels) * viscera::bytes_of(kept_type(head.type));
}

/// Bytes in memory of the volume, every `factor` voxels of an axis made one.
std::uint64_t kept_bytes(const VolumeHead& head, int factor) {
    const glm::i64vec3 dims =
        (glm::i64vec3(head.volume.grid.dims) + std::int64_t{factor - 1}) / std::int64_t{factor};
    return static_cast<std::uint64_t>(dims.x * dims.y * dims.z) *
           static_cast<std::uint64_t>(head.volume.channels) * viscera::bytes_of(kept_type(head.type));
}

/// Whether a volume must be in memory whole before it can be reduced: intervals of a curvilinear one do not
/// end with the slabs that are read.
bool needs_all(const VolumeHead& head) {
    return head.volume.grid.curvilinear();
}

/// Bytes in memory of what is read before it is reduced.
std::uint64_t working_bytes(const VolumeHead& head, int factor) {
    if (factor == 1) {
        return 0;
    }
    return needs_all(head) ? kept_bytes(head, 1) : slice_bytes(head) * static_cast<std::uint64_t>(factor);
}

/// The smallest factor with which the volume fits; 0 when none does.
int fitting_reduce(const VolumeHead& head, std::uint64_t beside, std::uint64_t available) {
    for (int factor = 2; factor <= 64; ++factor) {
        if (beside + working_bytes(head, factor) + kept_bytes(head, factor) <= available) {
            return factor;
        }
    }
    return 0;
}

std::string mebibytes(std::uint64_t bytes) {
    return std::to_string((bytes + (1U << 20U) - 1) >> 20U) + " MiB";
}

Volume read_whole(VolumeHead head, Converter& converter, const Reading& reading) {
    Volume volume = std::move(head.volume);
    volume.voxels.resize(kept_bytes({.volume = volume, .type = head.type}, 1));
    const std::span<std::byte> all(volume.voxels);
    for (std::size_t at = 0; at < all.size(); at += slab_bytes) {
        converter.fill(all.subspan(at, std::min<std::size_t>(slab_bytes, all.size() - at)));
        reading.progress(static_cast<double>(at) / static_cast<double>(all.size()));
    }
    return volume;
}

/// Averages slabs of whole slices as they come, so that the full volume is never in memory.
Volume read_reduced(const VolumeHead& head, Converter& converter, const Reading& reading) {
    const int factor = reading.options.reduce;
    const int slices = head.volume.grid.dims.z;
    const std::uint64_t group_bytes = slice_bytes(head) * static_cast<std::uint64_t>(factor);
    const auto groups = static_cast<int>(std::clamp<std::uint64_t>(slab_bytes / group_bytes, 1, 1024));
    Volume result;
    for (int z = 0; z < slices;) {
        Volume slab = head.volume;
        slab.grid.dims.z =
            static_cast<int>(std::min<std::int64_t>(std::int64_t{factor} * groups, slices - z));
        slab.voxels.resize(slice_bytes(head) * static_cast<std::size_t>(slab.grid.dims.z));
        converter.fill(slab.voxels);
        Volume part = reduced(slab, factor, reading.options.labels);
        if (z == 0) {
            result = std::move(part);
            result.voxels.reserve(kept_bytes(head, factor));
        } else {
            result.voxels.insert(result.voxels.end(), part.voxels.begin(), part.voxels.end());
            result.grid.dims.z += part.grid.dims.z;
        }
        z += slab.grid.dims.z;
        reading.progress(static_cast<double>(z) / slices);
    }
    return result;
}

/// Channels that lie one after another, each a volume, brought beside each other.
void interleave(Volume& volume, int channels) {
    const std::size_t width = viscera::bytes_of(volume.type);
    const auto count = static_cast<std::size_t>(channels);
    const std::size_t voxels = volume.voxels.size() / width / count;
    std::vector<std::byte> beside(volume.voxels.size());
    for (std::size_t c = 0; c < count; ++c) {
        for (std::size_t v = 0; v < voxels; ++v) {
            std::memcpy(beside.data() + (v * count + c) * width,
                        volume.voxels.data() + (c * voxels + v) * width, width);
        }
    }
    volume.voxels = std::move(beside);
    volume.grid.dims.z /= channels;
    volume.channels = channels;
}

Volume read_planar(VolumeHead head, Converter& converter, const Reading& reading) {
    const int channels = std::exchange(head.volume.channels, 1);
    head.volume.grid.dims.z *= channels;
    Volume volume = read_whole(std::move(head), converter, reading);
    interleave(volume, channels);
    return reduced(volume, reading.options.reduce, reading.options.labels);
}

Volume read_whole_and_reduce(VolumeHead head, Converter& converter, const Reading& reading) {
    const Volume volume = read_whole(std::move(head), converter, reading);
    return reduced(volume, reading.options.reduce, reading.options.labels);
}

}  // namespace

std::size_t bytes_of(FileScalar type) {
    constexpr std::array<std::size_t, 10> widths{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return widths.at(static_cast<std::size_t>(type));
}

std::uint64_t VolumeHead::voxel_bytes() const {
    return static_cast<std::uint64_t>(volume.channels) * bytes_of(type);
}

std::uint64_t VolumeHead::bytes(const Reading& reading) const {
    volume.grid.validate(reading.file.string());
    if (volume.channels < 1 || volume.channels > 4) {
        reading.fail("has " + std::to_string(volume.channels) + " channels; 1 to 4 are read");
    }
    return volume.grid.voxel_count() * voxel_bytes();
}

std::uint64_t memory_of(const Reading& reading) {
    const std::uint64_t limit = reading.options.memory_limit;
    return limit > 0 ? limit : available_memory();
}

void require_memory(const VolumeHead& head, std::uint64_t beside, const Reading& reading) {
    const std::uint64_t available = memory_of(reading);
    const int factor = std::max(1, reading.options.reduce);
    const std::uint64_t needed = kept_bytes(head, factor) + working_bytes(head, factor) + beside;
    if (needed <= available) {
        return;
    }
    const glm::ivec3 dims = head.volume.grid.dims;
    const int fitting = fitting_reduce(head, beside, available);
    throw Error(ErrorCode::limit, reading.file.string(),
                size_text(dims) + " voxels need " + mebibytes(needed) + " of memory, there are " +
                    mebibytes(available) +
                    (fitting > 0 ? "; reduce = " + std::to_string(fitting) + " would do"
                                 : "; no reduction makes it fit"));
}

Volume read_voxels(VolumeHead head, const ReadBytes& read, const Reading& reading) {
    if (reading.options.regrid) {
        head.volume.grid = reading.options.regrid(head.volume.grid);
    }
    static_cast<void>(head.bytes(reading));
    head.volume.type = kept_type(head.type);
    head.volume.source = reading.file.string();
    require_memory(head, head.planar ? kept_bytes(head, 1) : 0, reading);
    reading.progress(0.0);
    Converter converter(head, read);
    Volume volume = head.planar                  ? read_planar(std::move(head), converter, reading)
                    : needs_all(head)            ? read_whole_and_reduce(std::move(head), converter, reading)
                    : reading.options.reduce > 1 ? read_reduced(head, converter, reading)
                                                 : read_whole(std::move(head), converter, reading);
    volume.narrowing_error = converter.narrowing_error();
    reading.progress(1.0);
    return volume;
}

}  // namespace viscera::io
