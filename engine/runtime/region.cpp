#include "engine/runtime/region.h"

#include <algorithm>
#include <array>

namespace viscera {
namespace {

/// Whether all corners lie beyond one plane of the view, and with them what is between. The sides are linear
/// in clip coordinates, so this holds behind the eye, too.
bool out_of_sight(const std::array<glm::dvec4, 8>& corners) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            if (std::ranges::all_of(corners, [&](const glm::dvec4& c) { return side * c[axis] > c.w; })) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

PixelRect project_bounds(const Bounds& bounds, const glm::dmat4& view_projection, glm::ivec2 size) {
    const PixelRect all{0, 0, size.x, size.y};
    if (bounds.empty()) {
        return {};
    }
    std::array<glm::dvec4, 8> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 p((i & 1) != 0 ? bounds.max.x : bounds.min.x,
                           (i & 2) != 0 ? bounds.max.y : bounds.min.y,
                           (i & 4) != 0 ? bounds.max.z : bounds.min.z);
        corners[i] = view_projection * glm::dvec4(p, 1.0);
    }
    if (out_of_sight(corners)) {
        return {};
    }
    glm::dvec2 low(1e30);
    glm::dvec2 high(-1e30);
    for (const glm::dvec4& clip : corners) {
        if (!(clip.w > 0.0) || clip.z < -clip.w) {
            return all;  // in front of the near plane: its projection says nothing
        }
        const glm::dvec2 ndc = glm::dvec2(clip) / clip.w;
        low = glm::min(low, ndc);
        high = glm::max(high, ndc);
    }
    const glm::dvec2 pixels(size);
    const auto left = glm::ivec2(glm::floor((glm::clamp(low, -1.0, 1.0) * 0.5 + 0.5) * pixels)) - 1;
    const auto right = glm::ivec2(glm::ceil((glm::clamp(high, -1.0, 1.0) * 0.5 + 0.5) * pixels)) + 1;
    const glm::ivec2 first = glm::max(left, 0);
    const glm::ivec2 last = glm::min(right, size);
    return {first.x, first.y, last.x - first.x, last.y - first.y};
}

}  // namespace viscera
