#include "effects/volume/ray_frame.h"

#include <algorithm>

namespace viscera::volume {
namespace {

/// Distance in front of the eye that the projection maps to a normalised depth.
double eye_depth(const glm::dmat4& projection, bool orthographic, double ndc_z) {
    return orthographic ? (projection[3][2] - ndc_z) / projection[2][2]
                        : projection[3][2] / (ndc_z + projection[2][2]);
}

}  // namespace

RayFrame make_ray_frame(const View& view, const glm::dmat4& texture_to_world) {
    const glm::dmat4 to_eye = view.view * texture_to_world;
    const glm::dmat4 from_eye = glm::inverse(to_eye);
    const glm::dmat3 world_from_eye = glm::transpose(glm::dmat3(view.view));
    const glm::dvec3 centre = to_eye * glm::dvec4(0.5, 0.5, 0.5, 1.0);
    const double radius = 0.5 * (glm::length(glm::dvec3(to_eye[0])) + glm::length(glm::dvec3(to_eye[1])) +
                                 glm::length(glm::dvec3(to_eye[2])));
    const double near = eye_depth(view.projection, view.orthographic, -1.0);
    const double far = eye_depth(view.projection, view.orthographic, 1.0);
    // An eye inside the volume, or in front of it, still needs a plane that it can see.
    const double plane = std::max({-centre.z, near, view.orthographic ? -1e300 : 0.25 * radius});

    const glm::dmat4 unproject = glm::inverse(view.projection);
    const glm::dvec4 clip = view.projection * glm::dvec4(0.0, 0.0, -plane, 1.0);
    const double ndc_z = clip.z / clip.w;
    const auto at = [&](double x, double y) {
        const glm::dvec4 p = unproject * glm::dvec4(x, y, ndc_z, 1.0);
        return glm::dvec3(p) / p.w;
    };
    const glm::dvec3 middle = at(0.0, 0.0);
    const std::array<glm::dvec3, 3> eye{middle, at(1.0, 0.0) - middle, at(0.0, 1.0) - middle};

    RayFrame frame;
    for (std::size_t i = 0; i < 3; ++i) {
        frame.point[i] = from_eye * glm::dvec4(eye[i], i == 0 ? 1.0 : 0.0);
        glm::dvec3 direction = eye[i];
        if (view.orthographic) {
            direction = i == 0 ? glm::dvec3(0.0, 0.0, -1.0) : glm::dvec3(0.0);
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

}  // namespace viscera::volume
