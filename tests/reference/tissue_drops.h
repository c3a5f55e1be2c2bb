#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/tissue_film.h"

namespace viscera::reference {

struct Drop {
    glm::dvec2 uv{0.0};
    double volume_mm3 = 0.0;
    double age_s = 0.0;
};

struct DropParams {
    double mobility_per_mm_s = 2600.0;
    double strength = 1.0;  ///< of gravity, in units of the standard one
    double aspect = 0.35;
    double trail_mm = 0.0;
    double life_s = 20.0;
    double smallest_mm3 = 0.0;
    bool open_edges = true;
};

/// What one step does with a drop.
struct DropStep {
    Drop drop;                 ///< volume 0: it has ended
    double left_mm3 = 0.0;     ///< stays behind
    bool fell = false;         ///< off an open border, with all that it held
    bool across_seam = false;  ///< it has gone on in another chart
};

/// A drop on a surface, by the gravity map (direction in UV, share of gravity, UV per mm) of each texel. The
/// film below is thinner than drops are high.
class DropWay {
  public:
    DropWay(const TissueSurface& surface, std::vector<glm::dvec4> gravity, const DropParams& params)
        : surface_(surface), gravity_(std::move(gravity)), params_(params) {}

    [[nodiscard]] DropStep step(const Drop& drop, double dt_s) const;
    [[nodiscard]] double radius_mm(double volume_mm3) const;

  private:
    enum class Where { nowhere, here, across };
    struct Place {
        glm::dvec2 px{0.0};
        Where where = Where::nowhere;
    };
    [[nodiscard]] Place place(const glm::dvec2& px) const;
    [[nodiscard]] glm::dvec2 jump(const glm::ivec2& gutter) const;
    [[nodiscard]] glm::dvec4 gravity(const glm::dvec2& px) const;

    const TissueSurface& surface_;
    std::vector<glm::dvec4> gravity_;
    DropParams params_;
};

}  // namespace viscera::reference
