#pragma once

#include "effects/volume/classification.h"
#include "effects/volume/source.h"
#include "engine/gl/texture.h"

namespace viscera::volume {

/// How a stored number comes back from a texture fetch: the `value` of this map is the stored number.
/// Integers are uploaded as 16 bits, 8-bit ones as 257 n: filtering 8-bit textures is quantised to 8 bits on
/// some devices.
[[nodiscard]] TexelMap texel_map(ScalarType type);

/// The texels of one channel of a box as the texture wants them: 16-bit, or floats with `empty` (stored) for
/// what is not finite.
[[nodiscard]] std::vector<std::byte> texels(const Volume& volume, int channel, const VoxelBox& box,
                                            double empty);

/// One channel of a volume as a 3-D texture.
class GpuVolume {
  public:
    /// Throws Error(limit) that says what is needed, what there is, and what `reduce` would fit.
    GpuVolume(const gl::Functions& gl, const Source& source, int channel);

    /// Uploads what has changed since the last call.
    void update(const Source& source);
    [[nodiscard]] const gl::Texture& texture() const { return texture_; }
    [[nodiscard]] const TexelMap& map() const { return map_; }

  private:
    int channel_;
    TexelMap map_;
    gl::Texture texture_;
    std::uint64_t version_ = 0;
};

}  // namespace viscera::volume
