#pragma once

#include <optional>

#include "effects/volume/bricks.h"
#include "effects/volume/source.h"
#include "engine/gl/texture.h"

namespace viscera::volume {

/// The bricks of a volume, summarised once and shared by all that show it.
struct Bricks {
    BrickGrid grid;
    std::uint64_t version = 0;  ///< of the source that they were made from
};
/// `border`: voxels around a brick that its range includes.
[[nodiscard]] std::shared_ptr<Bricks> load_bricks(Assets& assets, const Source& source, int channel, int size,
                                                  int border);

/// Which bricks show something under one transfer function and crop, as the march reads it: see
/// glsl/volume/skip.glsl.
class SkipMap {
  public:
    /// Finds it anew when `key` (of transfer function, crop and bricks) is another than the last. No OpenGL.
    void update(const BrickGrid& bricks, std::span<const StoredRange> visible, const VoxelBox& crop,
                std::uint64_t key);
    /// Share of bricks that show something.
    [[nodiscard]] double occupancy() const { return occupancy_; }
    /// The distances as a texture of unsigned bytes: magnitude, + 128 where occupied.
    [[nodiscard]] const gl::Texture& texture(const gl::Functions& gl);

  private:
    std::uint64_t key_ = 0;
    glm::ivec3 dims_{0};
    double occupancy_ = 1.0;
    std::vector<std::uint8_t> occupied_;
    std::vector<std::int8_t> distance_;
    DistanceScratch scratch_;
    std::optional<gl::Texture> texture_;
    std::uint64_t uploaded_ = 0;
};

}  // namespace viscera::volume
