#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/gray_image.h"

namespace viscera::assets {

/// One picture of the plume: from where it is seen, and where and how large it lies in the sprite.
struct SmokeView {
    std::string_view name;
    double angle_deg;      ///< between the line of sight and the plume's axis; 90: from the side
    glm::dvec2 base_uv;    ///< sprite UV (origin bottom-left) of the point where the smoke leaves the vessel
    double magnification;  ///< against the side view
};

/// The views that sprites are made for. A sprite is drawn in proportion to the plume's foreshortened length,
/// so slanted views are magnified by 1 / sin(angle), as far as the sprite has room. From the front the base
/// lies under the smoke.
inline constexpr std::array<SmokeView, 5> smoke_views{{{"smoke_side", 90.0, {0.55, 0.15}, 1.0},
                                                       {"smoke_67", 67.5, {0.55, 0.15}, 1.08},
                                                       {"smoke_45", 45.0, {0.55, 0.15}, 1.41},
                                                       {"smoke_22", 22.5, {0.55, 0.15}, 1.41},
                                                       {"smoke_front", 0.0, {0.55, 0.5}, 1.5}}};

/// A plume of contrast agent in still blood: one density field, of which every view is a projection, so that
/// neighbouring views blend. Lengths are in units of the sprite's edge; the plume starts at the origin and
/// points along +y.
class Smoke {
  public:
    explicit Smoke(std::uint32_t seed);

    /// Optical thickness through the field as opacity in [0, 1): 1 - exp(-integral); square, exactly 0 along
    /// the border.
    [[nodiscard]] GrayImage project(const SmokeView& view, int size) const;

  private:
    [[nodiscard]] float sample(const glm::dvec3& p) const;

    std::vector<float> density_;
};

}  // namespace viscera::assets
