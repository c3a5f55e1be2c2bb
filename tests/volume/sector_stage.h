#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "engine/core/volume.h"
#include "tests/volume/volume_stage.h"

// What tests of cylindrical and spherical volumes share.

namespace viscera::test {

struct NamedShape {
    const char* name;
    VolumeShape shape;
};
/// Sectors of every sort about a radius of 50 mm: full rings that wrap or do not, more and less than half a
/// circle, with and without an inner radius, whole and cut spheres.
[[nodiscard]] std::vector<NamedShape> some_shapes();

/// Volume of one f32 channel with samples value(frame) [mm] in a frame that is turned and moved.
[[nodiscard]] Volume sector_volume(const VolumeShape& shape, const glm::ivec3& dims,
                                   const std::function<double(const glm::dvec3& frame)>& value);
/// Voxels of a small one: few across the beams, more along them.
[[nodiscard]] glm::ivec3 small_dims(const VolumeShape& shape);
/// Winding bright tubes in the dark, 0 to 200, across seam and axis.
[[nodiscard]] Volume sector_vessels(const VolumeShape& shape, const glm::ivec3& dims);
/// Values in [0, 1), the same for one seed.
[[nodiscard]] Volume sector_noise(const VolumeShape& shape, const glm::ivec3& dims, unsigned seed);
/// Where the frame's middle of such a volume lies in the world.
[[nodiscard]] glm::dvec3 sector_centre(const VolumeGrid& grid);

/// Ray casting whose picture is (length of all stretches of the ray [mm], their number, 0, 1).
[[nodiscard]] ShaderTexts chords_shown();

}  // namespace viscera::test
