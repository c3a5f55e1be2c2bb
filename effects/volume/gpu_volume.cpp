#include "effects/volume/gpu_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/core/error.h"

namespace viscera::volume {
namespace {

constexpr double unorm16 = 65535.0;

template <class T>
int to_unorm16(T stored) {
    if constexpr (std::is_signed_v<T>) {
        const int shifted = static_cast<int>(stored) - static_cast<int>(std::numeric_limits<T>::min());
        return sizeof(T) == 1 ? shifted * 257 : shifted;
    } else {
        return sizeof(T) == 1 ? static_cast<int>(stored) * 257 : static_cast<int>(stored);
    }
}

template <class Out, class T, class Convert>
std::vector<std::byte> converted(const Volume& volume, int channel, const VoxelBox& box, Convert convert) {
    const glm::ivec3 dims = volume.grid.dims;
    const auto channels = static_cast<std::size_t>(volume.channels);
    std::vector<std::byte> result(static_cast<std::size_t>(box.size.x) *
                                  static_cast<std::size_t>(box.size.y) *
                                  static_cast<std::size_t>(box.size.z) * sizeof(Out));
    std::byte* to = result.data();
    for (int z = 0; z < box.size.z; ++z) {
        for (int y = 0; y < box.size.y; ++y) {
            const std::size_t row =
                (static_cast<std::size_t>(box.first.z + z) * static_cast<std::size_t>(dims.y) +
                 static_cast<std::size_t>(box.first.y + y)) *
                    static_cast<std::size_t>(dims.x) +
                static_cast<std::size_t>(box.first.x);
            const std::byte* from =
                volume.voxels.data() + (row * channels + static_cast<std::size_t>(channel)) * sizeof(T);
            for (int x = 0; x < box.size.x; ++x) {
                T stored;
                std::memcpy(&stored, from, sizeof(T));
                const Out texel = convert(stored);
                std::memcpy(to, &texel, sizeof(Out));
                from += channels * sizeof(T);
                to += sizeof(Out);
            }
        }
    }
    return result;
}

template <class T>
std::vector<std::byte> as_unorm16(const Volume& volume, int channel, const VoxelBox& box) {
    return converted<std::uint16_t, T>(
        volume, channel, box, [](T stored) { return static_cast<std::uint16_t>(to_unorm16(stored)); });
}

gl::Extent extent(const glm::ivec3& v) {
    return {v.x, v.y, v.z};
}

gl::TextureFormat format_of(ScalarType type) {
    return type == ScalarType::f32 ? gl::texture_format(PixelFormat::r32f) : gl::r16_format;
}

}  // namespace

TexelMap texel_map(ScalarType type) {
    switch (type) {
        case ScalarType::u8:
            return {255.0, 0.0};
        case ScalarType::i8:
            return {255.0, -128.0};
        case ScalarType::u16:
            return {unorm16, 0.0};
        case ScalarType::i16:
            return {unorm16, -32768.0};
        case ScalarType::f32:
            return {1.0, 0.0};
    }
    return {};
}

std::vector<std::byte> texels(const Volume& volume, int channel, const VoxelBox& box, double empty) {
    switch (volume.type) {
        case ScalarType::u8:
            return as_unorm16<std::uint8_t>(volume, channel, box);
        case ScalarType::i8:
            return as_unorm16<std::int8_t>(volume, channel, box);
        case ScalarType::u16:
            return as_unorm16<std::uint16_t>(volume, channel, box);
        case ScalarType::i16:
            return as_unorm16<std::int16_t>(volume, channel, box);
        case ScalarType::f32:
            break;
    }
    return converted<float, float>(volume, channel, box, [fill = static_cast<float>(empty)](float stored) {
        return std::isfinite(stored) ? stored : fill;
    });
}

GpuVolume::GpuVolume(const gl::Functions& gl, const Source& source, int channel)
    : channel_(channel),
      map_(texel_map(source.volume().type)),
      texture_(gl::Texture::make_3d(gl, extent(source.volume().grid.dims), format_of(source.volume().type),
                                    source.volume().source)) {
    update(source);
}

void GpuVolume::update(const Source& source) {
    if (version_ == source.version()) {
        return;
    }
    const Volume& volume = source.volume();
    bool everything = true;
    std::vector<VoxelBox> boxes;
    if (source.live != nullptr && version_ != 0) {
        boxes = source.live->changes_since(version_, everything);
    }
    if (everything) {
        boxes = {{glm::ivec3(0), volume.grid.dims}};
    }
    const double lowest = source.statistics.min;
    const double empty = (lowest - volume.intercept) / volume.slope;
    for (const VoxelBox& box : boxes) {
        texture_.upload_region(extent(box.first), extent(box.size), texels(volume, channel_, box, empty));
    }
    version_ = source.version();
}

}  // namespace viscera::volume
