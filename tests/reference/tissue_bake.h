#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace viscera::reference {

/// A surface as a bake sees it, in double precision.
struct BakedSurface {
    std::vector<glm::dvec3> positions;  ///< world [mm]
    std::vector<glm::dvec3> normals;    ///< world
    std::vector<glm::dvec2> uvs;
    std::vector<std::uint32_t> indices;
};

/// What is at one place of the texture.
struct BakedPoint {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0};
    glm::dvec3 du{0.0};  ///< of the position, per texel
    glm::dvec3 dv{0.0};
    double margin = 0.0;  ///< least of the three weights: 0 on an edge
    std::size_t triangle = 0;
};

/// At texture coordinates: the first triangle of the list that holds them, by looking at all of them.
[[nodiscard]] std::optional<BakedPoint> baked_point(const BakedSurface& surface, const glm::dvec2& uv,
                                                    const glm::dvec2& texels);
/// All triangles that hold them.
[[nodiscard]] std::vector<BakedPoint> baked_points(const BakedSurface& surface, const glm::dvec2& uv,
                                                   const glm::dvec2& texels);

}  // namespace viscera::reference
