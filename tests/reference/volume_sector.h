#pragma once

#include <functional>
#include <vector>

#include "engine/core/volume.h"
#include "tests/reference/volume_ray.h"

// Sectors of cylinders and spheres in double precision. Nothing of how the shader finds its intervals: all
// places where a ray meets any of the surfaces are put in order, and what lies between two of them is in or
// out as its middle is.

namespace viscera::reference {

/// Part of a shape's coordinates.
struct SectorRange {
    glm::dvec3 low{0.0};
    glm::dvec3 high{0.0};
};
[[nodiscard]] SectorRange whole(const VolumeShape& shape);
/// Whether a place of the shape's frame lies in the range.
[[nodiscard]] bool inside(const VolumeShape& shape, const SectorRange& range, const glm::dvec3& frame);

/// Stretches of a line of the shape's frame, of any length of direction, in its own parameter; in order.
/// Those that touch are one.
[[nodiscard]] std::vector<Interval> intersect(const VolumeShape& shape, const SectorRange& range,
                                              const glm::dvec3& origin, const glm::dvec3& direction);
/// The same of a ray of the world. frame_to_world: with the placement. [mm]
[[nodiscard]] std::vector<Interval> intersect(const VolumeShape& shape, const SectorRange& range,
                                              const glm::dmat4& frame_to_world, const Ray& ray);

/// Trilinear value of one f32 channel at a place of the frame, between samples as the grid's shape has them;
/// beyond the ends the outermost go on.
[[nodiscard]] double sector_value(const Volume& volume, const glm::dvec3& frame);

/// Integral of a smooth function over a stretch by `parts` pieces of 8 Gauss points.
[[nodiscard]] double integral(const Interval& interval, int parts, const std::function<double(double)>& f);

}  // namespace viscera::reference
