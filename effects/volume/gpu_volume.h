#pragma once

#include "effects/volume/atlas.h"
#include "effects/volume/classification.h"
#include "effects/volume/source.h"
#include "engine/gl/program.h"
#include "engine/gl/texture.h"

namespace viscera::volume {

/// How a stored number comes back from a texture fetch: the `value` of this map is the stored number.
/// Integers are uploaded as 16 bits, 8-bit ones as 257 n: filtering 8-bit textures is quantised to 8 bits on
/// some devices.
[[nodiscard]] TexelMap texel_map(ScalarType type);

/// Instead of a channel: all four of a u16 volume (effects/volume/colours.h), of an f32 one (its
/// coefficients), or of an i16 one, which come back as stored / 32767 (effects/volume/gradients.h).
inline constexpr int all_channels = -1;

/// The texels of one channel of a box as the texture wants them: 16-bit, or floats with `empty` (stored) for
/// what is not finite. all_channels: as they are.
[[nodiscard]] std::vector<std::byte> texels(const Volume& volume, int channel, const VoxelBox& box,
                                            double empty);

/// What textures of a device can hold.
struct TextureLimits {
    int side_3d = 0;  ///< of a 3-D texture [texels]
    int side_2d = 0;  ///< of a layer of an array
    int layers = 0;

    [[nodiscard]] static TextureLimits query(const gl::Functions& gl);
};

/// How a volume is stored on a device: none is a 3-D texture. Throws Error(limit) naming `where`, which says
/// what is needed, what there is, and what `reduce` would fit.
[[nodiscard]] std::optional<AtlasLayout> choose_storage(const glm::ivec3& dims, Storage storage,
                                                        const TextureLimits& limits, std::string_view where);

/// One channel of a volume, or all of them, on the GPU, as glsl/volume/storage.glsl reads it.
class GpuVolume {
  public:
    /// Throws Error(limit) as choose_storage(), or when memory is short.
    GpuVolume(const gl::Functions& gl, const Source& source, int channel,
              Storage storage = Storage::texture_3d);

    /// Uploads what has changed since the last call.
    void update(const Source& source);
    /// For the sampler u_volume.
    [[nodiscard]] const gl::Texture& texture() const { return texture_; }
    /// Whether programs need STORAGE_ATLAS.
    [[nodiscard]] bool is_atlas() const { return atlas_.has_value(); }
    /// Sets what else storage.glsl needs; for other samplers under other names.
    void set(const gl::Program& program, std::string_view size = "u_volume_size",
             std::string_view tiles = "u_atlas_tiles") const;
    [[nodiscard]] const TexelMap& map() const { return map_; }

  private:
    [[nodiscard]] gl::Texture make_texture(const gl::Functions& gl, const Volume& volume);
    void upload(const Volume& volume, const VoxelBox& changed, double empty);

    int channel_;
    Storage storage_;
    glm::ivec3 dims_{0};
    ScalarType type_ = ScalarType::u8;
    TexelMap map_;
    std::optional<AtlasLayout> atlas_;
    gl::Texture texture_;
    std::uint64_t version_ = 0;
};

/// Shared by all passes that show the channel; made on first use, as it was then.
[[nodiscard]] std::shared_ptr<GpuVolume> load_gpu_volume(Assets& assets, const gl::Functions& gl,
                                                         const Source& source, int channel, Storage storage);

}  // namespace viscera::volume
