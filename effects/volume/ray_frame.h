#pragma once

#include <array>
#include <bitset>

#include <glm/glm.hpp>

#include "engine/core/camera.h"

namespace viscera::volume {

/// The rays of a picture in single precision, as glsl/volume/ray.glsl has them: a point on a plane through
/// the volume for each pixel and the direction from the eye, both in local coordinates. Element 0 belongs
/// to the picture's centre, 1 and 2 are added per NDC x and y.
struct RayFrame {
    std::array<glm::vec3, 3> point{};
    std::array<glm::vec3, 3> direction{};
    std::array<glm::vec3, 3> world_direction{};
    glm::vec2 near_far{0.0F};
    /// Window depth d as near_far has the planes, without the digits that 1 + d/far would cancel: with
    /// t = 1 - d, share = (x - y t) / (z t + w).
    glm::vec4 depth_to_share{0.0F};
};

/// `local_to_world`: of the volume, not singular; `low`, `high`: the box around it in local coordinates.
/// Computed in double precision about the volume, so that neither a far eye nor a far volume costs digits.
[[nodiscard]] RayFrame make_ray_frame(const View& view, const glm::dmat4& local_to_world,
                                      const glm::dvec3& low = glm::dvec3(0.0),
                                      const glm::dvec3& high = glm::dvec3(1.0));

/// Which of the eight ways rays go: element x + 2 y + 4 z is of those that go up along the axes that are 1 in
/// it.
using Ways = std::bitset<8>;
/// Along which axes rays of a way go up.
[[nodiscard]] inline glm::bvec3 up_along(std::size_t way) {
    return {way % 2 != 0, way / 2 % 2 != 0, way / 4 != 0};
}
/// Every way that a ray of the picture may go, whichever way its direction is rounded.
[[nodiscard]] Ways ways_of(const RayFrame& frame);

}  // namespace viscera::volume
