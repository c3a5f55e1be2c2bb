#include "effects/volume/gpu_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/size_text.h"

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

std::vector<std::byte> all_of(const Volume& volume, const VoxelBox& box) {
    const glm::ivec3 dims = volume.grid.dims;
    const std::size_t voxel = static_cast<std::size_t>(volume.channels) * bytes_of(volume.type);
    const std::size_t run = static_cast<std::size_t>(box.size.x) * voxel;
    std::vector<std::byte> result(run * static_cast<std::size_t>(box.size.y) *
                                  static_cast<std::size_t>(box.size.z));
    std::byte* to = result.data();
    for (int z = box.first.z; z < box.first.z + box.size.z; ++z) {
        for (int y = box.first.y; y < box.first.y + box.size.y; ++y) {
            const std::size_t row =
                static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y) + static_cast<std::size_t>(y);
            const std::size_t first =
                row * static_cast<std::size_t>(dims.x) + static_cast<std::size_t>(box.first.x);
            std::memcpy(to, volume.voxels.data() + first * voxel, run);
            to += run;
        }
    }
    return result;
}

gl::TextureFormat format_of(ScalarType type, int channel) {
    if (channel == all_channels) {
        return type == ScalarType::f32   ? gl::texture_format(PixelFormat::rgba32f)
               : type == ScalarType::i16 ? gl::rgba16_snorm_format
                                         : gl::rgba16_format;
    }
    return type == ScalarType::f32 ? gl::texture_format(PixelFormat::r32f) : gl::r16_format;
}

bool fits_3d(const glm::ivec3& dims, const TextureLimits& limits) {
    return std::max({dims.x, dims.y, dims.z}) <= limits.side_3d;
}

/// The least number of voxels made one along each axis with which a volume fits.
int fitting_reduction(const glm::ivec3& dims, Storage storage, const TextureLimits& limits) {
    for (int factor = 2;; ++factor) {
        const glm::ivec3 reduced = (dims - 1) / factor + 1;
        const bool as_3d = storage != Storage::atlas && fits_3d(reduced, limits);
        const bool as_atlas =
            storage != Storage::texture_3d && lay_out(reduced, limits.side_2d, limits.layers).has_value();
        if (as_3d || as_atlas || reduced == glm::ivec3(1)) {
            return factor;
        }
    }
}

std::string too_large(const glm::ivec3& dims, Storage storage, const TextureLimits& limits) {
    std::string text = "a volume of " + size_text(dims) + " voxels cannot be had:";
    if (storage != Storage::atlas) {
        text += " a 3-D texture has at most " + std::to_string(limits.side_3d) + " voxels a side";
    }
    if (storage != Storage::texture_3d) {
        text += std::string(storage == Storage::atlas ? "" : ", and") + " an atlas at most " +
                std::to_string(limits.layers) + " layers of " + std::to_string(limits.side_2d) +
                " texels a side, two of them spent on each slice's border";
    }
    return text;
}

/// A slice with rows and columns of its edge repeated around it; along a ring (axis 0 or 1) those of the
/// other end.
std::vector<std::byte> bordered(const std::vector<std::byte>& slice, const glm::ivec2& size,
                                const glm::ivec2& before, const glm::ivec2& behind, std::size_t bytes,
                                int ring) {
    std::vector<std::byte> result;
    const glm::ivec2 whole = size + before + behind;
    result.reserve(static_cast<std::size_t>(whole.x) * static_cast<std::size_t>(whole.y) * bytes);
    for (int y = -before.y; y < size.y + behind.y; ++y) {
        const int from = ring == 1 ? (y + size.y) % size.y : std::clamp(y, 0, size.y - 1);
        const auto row = static_cast<std::size_t>(from) * static_cast<std::size_t>(size.x) * bytes;
        const auto first = slice.begin() + static_cast<std::ptrdiff_t>(row);
        const auto texel = static_cast<std::ptrdiff_t>(bytes);
        const auto end = first + size.x * texel;
        if (before.x > 0) {
            const auto beside = ring == 0 ? end - texel : first;
            result.insert(result.end(), beside, beside + texel);
        }
        result.insert(result.end(), first, end);
        if (behind.x > 0) {
            const auto beside = ring == 0 ? first : end - texel;
            result.insert(result.end(), beside, beside + texel);
        }
    }
    return result;
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
    if (channel == all_channels) {
        return all_of(volume, box);
    }
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
        return is_number(stored) ? stored : fill;
    });
}

TextureLimits TextureLimits::query(const gl::Functions& gl) {
    TextureLimits limits;
    gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limits.side_3d);
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &limits.side_2d);
    gl.GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &limits.layers);
    return limits;
}

std::optional<AtlasLayout> choose_storage(const glm::ivec3& dims, Storage storage,
                                          const TextureLimits& limits, std::string_view where) {
    if (storage != Storage::atlas && fits_3d(dims, limits)) {
        return std::nullopt;
    }
    if (storage != Storage::texture_3d) {
        if (const auto atlas = lay_out(dims, limits.side_2d, limits.layers)) {
            return atlas;
        }
    }
    throw Error(ErrorCode::limit, std::string(where),
                too_large(dims, storage, limits) + "; volume.reduce = " +
                    std::to_string(fitting_reduction(dims, storage, limits)) + " would fit");
}

GpuVolume::GpuVolume(const gl::Functions& gl, const Source& source, int channel, Storage storage)
    : channel_(channel), storage_(storage), texture_(make_texture(gl, source.volume())) {
    update(source);
}

gl::Texture GpuVolume::make_texture(const gl::Functions& gl, const Volume& volume) {
    const glm::ivec3 dims = volume.grid.dims;
    const auto atlas = choose_storage(dims, storage_, TextureLimits::query(gl), volume.source);
    const gl::TextureFormat format = format_of(volume.type, channel_);
    gl::Texture texture =
        atlas ? gl::Texture::make_2d_array(gl, {atlas->page().x, atlas->page().y, atlas->layers}, format,
                                           volume.source)
              : gl::Texture::make_3d(gl, extent(dims), format, volume.source);
    dims_ = dims;
    type_ = volume.type;
    map_ = texel_map(type_);
    atlas_ = atlas;
    return texture;
}

void GpuVolume::upload(const Volume& volume, const VoxelBox& changed, double empty) {
    VoxelBox box = changed;
    if (!atlas_) {
        texture_.upload_region(extent(box.first), extent(box.size), texels(volume, channel_, box, empty));
        return;
    }
    // Each end of a ring borders on the other.
    const int ring = volume.grid.shape.wrap_axis();
    if (ring >= 0) {
        box.first[ring] = 0;
        box.size[ring] = dims_[ring];
    }
    // What touches a face goes on into the border.
    const glm::ivec2 before(box.first.x == 0 ? AtlasLayout::border : 0,
                            box.first.y == 0 ? AtlasLayout::border : 0);
    const glm::ivec2 behind(box.first.x + box.size.x == dims_.x ? AtlasLayout::border : 0,
                            box.first.y + box.size.y == dims_.y ? AtlasLayout::border : 0);
    const glm::ivec2 size = glm::ivec2(box.size) + before + behind;
    for (int z = box.first.z; z < box.first.z + box.size.z; ++z) {
        const glm::ivec3 place =
            atlas_->place_of(z) + glm::ivec3(box.first.x - before.x, box.first.y - before.y, 0);
        const VoxelBox slice{{box.first.x, box.first.y, z}, {box.size.x, box.size.y, 1}};
        texture_.upload_region(extent(place), {size.x, size.y, 1},
                               bordered(texels(volume, channel_, slice, empty), glm::ivec2(box.size), before,
                                        behind, texture_.format().bytes_per_pixel, ring));
    }
}

void GpuVolume::update(const Source& source) {
    if (version_ == source.version()) {
        return;
    }
    const Volume& volume = source.volume();
    bool everything = true;
    std::vector<VoxelBox> boxes = source.changes_since(version_, everything);
    if (everything) {
        if (dims_ != volume.grid.dims || type_ != volume.type) {
            texture_ = make_texture(texture_.gl(), volume);
        }
        boxes = {{glm::ivec3(0), dims_}};
    }
    for (const VoxelBox& box : boxes) {
        upload(volume, box, source.filler());
    }
    version_ = source.version();
}

void GpuVolume::set(const gl::Program& program, std::string_view size, std::string_view tiles) const {
    if (atlas_) {
        program.set(size, atlas_->dims);
        program.set(tiles, atlas_->tiles);
    }
}

std::shared_ptr<GpuVolume> load_gpu_volume(Assets& assets, const gl::Functions& gl, const Source& source,
                                           int channel, Storage storage) {
    return assets.shared<GpuVolume>(Hash().add(source.key).add(channel).add(storage).value(), [&] {
        return std::make_shared<GpuVolume>(gl, source, channel, storage);
    });
}

}  // namespace viscera::volume
