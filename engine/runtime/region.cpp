#include "engine/runtime/region.h"

namespace viscera {

PixelRect project_bounds(const Bounds& bounds, const glm::dmat4& view_projection, glm::ivec2 size) {
    const PixelRect all{0, 0, size.x, size.y};
    if (bounds.empty()) {
        return {};
    }
    glm::dvec2 low(1e30);
    glm::dvec2 high(-1e30);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p((corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                           (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                           (corner & 4) != 0 ? bounds.max.z : bounds.min.z);
        const glm::dvec4 clip = view_projection * glm::dvec4(p, 1.0);
        if (!(clip.w > 0.0) || clip.z < -clip.w) {
            return all;  // in front of the near plane: its projection says nothing
        }
        const glm::dvec2 ndc = glm::dvec2(clip) / clip.w;
        low = glm::min(low, ndc);
        high = glm::max(high, ndc);
    }
    if (low.x > 1.0 || low.y > 1.0 || high.x < -1.0 || high.y < -1.0) {
        return {};
    }
    const glm::dvec2 pixels(size);
    const auto left = glm::ivec2(glm::floor((glm::clamp(low, -1.0, 1.0) * 0.5 + 0.5) * pixels)) - 1;
    const auto right = glm::ivec2(glm::ceil((glm::clamp(high, -1.0, 1.0) * 0.5 + 0.5) * pixels)) + 1;
    const glm::ivec2 first = glm::max(left, 0);
    const glm::ivec2 last = glm::min(right, size);
    return {first.x, first.y, last.x - first.x, last.y - first.y};
}

}  // namespace viscera
