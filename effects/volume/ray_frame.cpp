#include "effects/volume/ray_frame.h"

#include <algorithm>
#include <limits>

namespace viscera::volume {
namespace {

/// Distance in front of the eye that the projection maps to a normalised depth.
double eye_depth(const glm::dmat4& projection, bool orthographic, double ndc_z) {
    const double rise = orthographic ? projection[2][2] : ndc_z + projection[2][2];
    // A far plane that rounds to infinity is infinitely far.
    return rise == 0.0 ? std::numeric_limits<double>::infinity()
                       : (projection[3][2] - (orthographic ? ndc_z : 0.0)) / rise;
}

}  // namespace

RayFrame make_ray_frame(const View& view, const glm::dmat4& local_to_world, const glm::dvec3& low,
                        const glm::dvec3& high) {
    const glm::dmat4 to_eye = view.view * local_to_world;
    const glm::dmat4 from_eye = glm::inverse(to_eye);
    const glm::dmat3 world_from_eye = glm::transpose(glm::dmat3(view.view));
    const glm::dvec3 centre = to_eye * glm::dvec4(0.5 * (low + high), 1.0);
    const glm::dvec3 size = high - low;
    const double radius =
        0.5 * (glm::length(glm::dvec3(to_eye[0])) * size.x + glm::length(glm::dvec3(to_eye[1])) * size.y +
               glm::length(glm::dvec3(to_eye[2])) * size.z);
    const double near = eye_depth(view.projection, view.orthographic, -1.0);
    const double far = eye_depth(view.projection, view.orthographic, 1.0);
    // An eye inside the volume, or in front of it, still needs a plane that it can see.
    const double plane = std::max({-centre.z, near, view.orthographic ? -1e300 : 0.25 * radius});

    // Not by the inverse of the projection: a near plane next to the eye leaves it no digits.
    const glm::dmat4& p = view.projection;
    const double w = view.orthographic ? 1.0 : plane;
    const glm::dmat2 across = glm::inverse(glm::dmat2(p[0][0], p[0][1], p[1][0], p[1][1]));
    const auto at = [&](double x, double y) {
        const glm::dvec2 rest = glm::dvec2(x, y) * w + plane * glm::dvec2(p[2]) - glm::dvec2(p[3]);
        return glm::dvec3(across * rest, -plane);
    };
    const glm::dvec3 middle = at(0.0, 0.0);
    const std::array<glm::dvec3, 3> eye{middle, at(1.0, 0.0) - middle, at(0.0, 1.0) - middle};

    RayFrame frame;
    for (std::size_t i = 0; i < 3; ++i) {
        frame.point[i] = from_eye * glm::dvec4(eye[i], i == 0 ? 1.0 : 0.0);
        glm::dvec3 direction = eye[i];
        if (view.orthographic) {
            // Slanting for an eye of two.
            direction = i == 0 ? glm::dvec3(across * glm::dvec2(p[2]), -1.0) : glm::dvec3(0.0);
        }
        frame.direction[i] = from_eye * glm::dvec4(direction, 0.0);
        frame.world_direction[i] = world_from_eye * direction;
    }
    const double share = view.orthographic ? 1.0 : 1.0 / plane;
    frame.near_far = glm::dvec2(near - plane, far - plane) * share;
    const double scale = view.projection[2][2];
    const double offset = view.projection[3][2];
    if (view.orthographic) {
        frame.depth_to_share = glm::dvec4((offset - 1.0) / scale - plane, -2.0 / scale, 0.0, 1.0);
    } else {
        // Perspective: share = (t of the plane - t) / (t - t of infinity).
        const double infinity = 0.5 * (1.0 + scale);
        frame.depth_to_share = glm::dvec4(infinity - 0.5 * offset / plane, 1.0, 1.0, -infinity);
    }
    return frame;
}

Ways ways_of(const RayFrame& frame) {
    const glm::vec3 turn = glm::abs(frame.direction[1]) + glm::abs(frame.direction[2]);
    const glm::vec3 slack = 1e-5F * (glm::abs(frame.direction[0]) + turn);
    glm::bvec3 up;
    glm::bvec3 down;
    for (int axis = 0; axis < 3; ++axis) {
        // Where there is no telling, both.
        up[axis] = !(frame.direction[0][axis] + turn[axis] < -slack[axis]);
        down[axis] = !(frame.direction[0][axis] - turn[axis] > slack[axis]);
    }
    Ways ways;
    for (std::size_t way = 0; way < ways.size(); ++way) {
        const glm::bvec3 rises = up_along(way);
        bool goes = true;
        for (int axis = 0; axis < 3; ++axis) {
            goes = goes && (rises[axis] ? up[axis] : down[axis]);
        }
        ways[way] = goes;
    }
    return ways;
}

}  // namespace viscera::volume
