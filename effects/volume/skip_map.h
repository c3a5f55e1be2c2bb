#pragma once

#include <array>
#include <optional>

#include "effects/volume/brick_distances.h"
#include "effects/volume/bricks.h"
#include "effects/volume/classification.h"
#include "effects/volume/ray_frame.h"
#include "effects/volume/source.h"
#include "effects/volume/space.h"
#include "engine/gl/texture.h"

namespace viscera::volume {

/// The bricks of a volume, summarised once and shared by all that show it.
struct Bricks {
    BrickGrid grid;
    std::uint64_t version = 0;  ///< of the source that they were made from
};
/// `border`: voxels around a brick that its range includes; `rows`: instead of that for curvilinear volumes.
[[nodiscard]] std::shared_ptr<Bricks> load_bricks(Assets& assets, const Source& source, int channel, int size,
                                                  int border, const BrickRows& rows = {});
/// Borders for slabs whose samples lie at most `reach` (local) from their middles, and a filter that needs
/// voxels up to `support` away. space: curvilinear.
[[nodiscard]] BrickRows brick_rows(const Space& space, int size, double reach, double support);

/// Where slabs may be 4, 16 or 64 times as long.
inline constexpr int slab_levels = 3;

/// Where the transfer function hardly changes: a brick is smooth when `variation` grows by at most
/// `most[i]` between its least and greatest stored number, enough for slabs of 4^(i + 1).
struct SmoothRule {
    std::vector<float>
        variation;       ///< of colour and opacity, summed from the first entry; empty: no brick is smooth
    double scale = 0.0;  ///< entry = scale * stored + offset
    double offset = 0.0;
    std::array<float, slab_levels> most{};  ///< not growing
    std::array<int, slab_levels> reach{};   ///< half a long slab [bricks]: thinner places do not count
};
/// Sums, over 4096 entries from `low` to `high` (stored), how much the picture can change when a value is
/// taken for another: extinction times the longest way through the volume, and the largest change of a
/// colour. A slab of several bricks takes the value in its middle for all of them, which differ by what each
/// of them varies: each may vary by its share of the tolerance only. `slab_bricks`: length of one slab.
[[nodiscard]] SmoothRule make_smooth_rule(const ExtinctionKnots& knots, double low, double high,
                                          double way_mm, double tolerance, double slab_bricks);

/// What must be seen of one summary of the volume, such as a channel's.
struct BrickLayer {
    const BrickGrid* bricks = nullptr;
    std::span<const StoredRange> visible;
};

/// Which bricks show something under one transfer function and crop, as the march reads it: see
/// glsl/volume/skip.glsl.
class SkipMap {
  public:
    /// Finds it anew when `key` (of transfer function, crop and bricks) is another than the last. No OpenGL.
    /// Bricks show something where they do in every layer (at least one, of one size); the first is what
    /// `smooth` is about. `overshoot`: how far the filter can leave a brick's range, as find_occupied() has
    /// it.
    void update(std::span<const BrickLayer> layers, const VoxelBox& crop, const SmoothRule& smooth,
                std::uint64_t key, float overshoot = 0.0F);
    /// Share of bricks that show something.
    [[nodiscard]] double occupancy() const { return occupancy_; }
    /// Box around all bricks that show something; nothing outside it does.
    [[nodiscard]] const VoxelBox& occupied_box() const { return box_; }
    /// Whether there are bricks in which long slabs do.
    [[nodiscard]] bool any_smooth() const { return any_smooth_; }
    /// A texture of unsigned bytes: kind_step * kind (0 empty, 1 occupied, 1 + i: slabs of 4^i do) + how many
    /// bricks are of that kind. Rays of Cartesian volumes are straight: CubesAhead, in a box of twice the
    /// bricks along each axis, whose half along an axis is the lower one for rays that go down along it. Only
    /// the blocks for `ways` are sure to hold anything: cubes that no ray asks for are not looked for. Rays
    /// of curvilinear volumes may turn back: distance_to_others().
    [[nodiscard]] const gl::Texture& texture(const gl::Functions& gl, const Ways& ways);
    /// One of those blocks.
    [[nodiscard]] std::span<const std::uint8_t> cubes(std::size_t way) {
        return ahead_.texels(up_along(way));
    }

  private:
    int find_smooth(const BrickGrid& bricks, const SmoothRule& rule, float overshoot);

    std::uint64_t key_ = 0;
    glm::ivec3 dims_{0};
    double occupancy_ = 1.0;
    VoxelBox box_;  ///< [bricks]
    bool any_smooth_ = false;
    std::vector<std::uint8_t> occupied_;
    std::vector<std::uint8_t> layer_;
    std::vector<std::uint8_t> kind_;
    std::vector<std::uint8_t> smooth_;
    std::vector<std::uint8_t> opened_;
    std::vector<std::uint8_t> distance_;
    std::vector<std::uint8_t> texels_;
    bool curved_ = false;
    DistanceScratch scratch_;
    CubesAhead ahead_;
    std::optional<gl::Texture> texture_;
    std::uint64_t uploaded_ = 0;
    Ways held_;  ///< blocks of the texture that have been uploaded
};

}  // namespace viscera::volume
