#include "tests/reference/tissue_bake.h"

#include <algorithm>
#include <array>

namespace viscera::reference {

std::vector<BakedPoint> baked_points(const BakedSurface& surface, const glm::dvec2& uv,
                                     const glm::dvec2& texels) {
    constexpr double on_edge = 1e-12;
    std::vector<BakedPoint> found;
    for (std::size_t t = 0; t + 2 < surface.indices.size(); t += 3) {
        const std::array<std::uint32_t, 3> c{surface.indices[t], surface.indices[t + 1],
                                             surface.indices[t + 2]};
        // Solves uv = uv0 + b1 (uv1 - uv0) + b2 (uv2 - uv0).
        const glm::dmat2 edges(surface.uvs[c[1]] - surface.uvs[c[0]], surface.uvs[c[2]] - surface.uvs[c[0]]);
        if (glm::determinant(edges) == 0.0) {
            continue;
        }
        const glm::dmat2 inverse = glm::inverse(edges);
        const glm::dvec2 b = inverse * (uv - surface.uvs[c[0]]);
        const double margin = std::min({b.x, b.y, 1.0 - b.x - b.y});
        if (!(margin >= -on_edge)) {
            continue;
        }
        const glm::dvec3 p0 = surface.positions[c[0]];
        const glm::dmat2x3 sides(surface.positions[c[1]] - p0, surface.positions[c[2]] - p0);
        const glm::dmat2x3 jacobian = sides * inverse;
        BakedPoint point;
        point.position = p0 + sides * b;
        point.normal = glm::normalize((1.0 - b.x - b.y) * surface.normals[c[0]] +
                                      b.x * surface.normals[c[1]] + b.y * surface.normals[c[2]]);
        point.du = jacobian[0] / texels.x;
        point.dv = jacobian[1] / texels.y;
        point.margin = margin;
        point.triangle = t / 3;
        found.push_back(point);
    }
    return found;
}

std::optional<BakedPoint> baked_point(const BakedSurface& surface, const glm::dvec2& uv,
                                      const glm::dvec2& texels) {
    const std::vector<BakedPoint> found = baked_points(surface, uv, texels);
    return found.empty() ? std::nullopt : std::optional(found.front());
}

}  // namespace viscera::reference
