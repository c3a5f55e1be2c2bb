#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/camera.h"
#include "tests/reference/buffer.h"
#include "tests/reference/volume_field.h"

namespace viscera::reference {

/// origin + s direction, s in mm of the world.
struct Ray {
    glm::dvec3 origin_mm{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};  ///< of length 1

    [[nodiscard]] glm::dvec3 at(double s_mm) const { return origin_mm + s_mm * direction; }
};

/// Stretch of a ray [mm].
struct Interval {
    double begin = 0.0;
    double end = 0.0;

    [[nodiscard]] double length() const { return end - begin; }
};

/// What of a ray is marched.
struct Limits {
    glm::dvec3 crop_min{0.0};  ///< box in texture coordinates
    glm::dvec3 crop_max{1.0};
    /// World half-spaces (n, d): what has dot(n, p) + d >= 0 stays. n need not be of length 1.
    std::vector<glm::dvec4> clip_planes;
    double near_mm = 0.0;                                     ///< least s: 0 starts at the eye
    double far_mm = std::numeric_limits<double>::infinity();  ///< greatest s: depth of what is opaque
};

/// Where the ray lies in the cropped box of `texture_to_world` (model matrix included), in all half-spaces
/// and in [near, far]. None when that is empty or of length 0. A ray in a face of the box is inside.
[[nodiscard]] std::optional<Interval> intersect(const Ray& ray, const glm::dmat4& texture_to_world,
                                                const Limits& limits = {});
/// The same of a field's whole box; empty where the ray passes by.
[[nodiscard]] inline Interval across(const Ray& ray, const Field& field) {
    return intersect(ray, field.texture_to_world()).value_or(Interval{});
}

/// Ray through a place of the picture, uv in [0, 1] from the bottom left: from the eye (orthographic: from
/// the plane through the eye that faces forward). Any invertible projection, off-axis ones and mirrored ones
/// too.
[[nodiscard]] Ray ray_through(const View& view, const glm::dvec2& uv);
/// Ray through the centre of pixel (x, y); row 0 at the bottom, as glReadPixels gives it.
[[nodiscard]] Ray pixel_ray(const View& view, int x, int y, int width, int height);

/// What one ray shows, RGBA.
using RayColour = std::function<glm::dvec4(const Ray&)>;
/// Picture of 4 channels. Rows are shared out among `threads` threads; each pixel depends on its ray only,
/// so the picture does not depend on them. `colour` is called from several threads at once. An exception
/// from it is rethrown here.
[[nodiscard]] Buffer render(const View& view, int width, int height, const RayColour& colour,
                            int threads = 2);
/// The same for the rays that meet the field's box, with their stretch; others give `background`.
using StretchColour = std::function<glm::dvec4(const Ray&, const Interval&)>;
[[nodiscard]] Buffer render(const View& view, int width, int height, const Field& field, const Limits& limits,
                            const StretchColour& colour, const glm::dvec4& background = glm::dvec4(0.0),
                            int threads = 2);

}  // namespace viscera::reference
