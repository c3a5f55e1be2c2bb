#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/mesh_data.h"

namespace viscera::tissue {

/// A point of a mesh that was looked for.
struct FoundPoint {
    std::uint32_t triangle = 0;
    glm::dvec3 position_mm{0.0};  ///< in the world
    glm::dvec2 uv{0.0};
    double distance = 0.0;  ///< from what was asked for [mm], or along a way as a share of it
};

/// The point of a mesh, placed by `to_world`, that is nearest to a place in the world. None: it has no
/// triangle with an extent.
[[nodiscard]] std::optional<FoundPoint> nearest_point(const MeshData& mesh, const glm::dmat4& to_world,
                                                      const glm::dvec3& place_mm);

/// A point's UV within the texture. Whole textures are taken off to its sides; what lies on its right or
/// upper border belongs to the last texel there.
[[nodiscard]] glm::vec2 within_texture(const glm::dvec2& uv);

/// The triangles of a placed mesh in boxes, for quick answers to where a straight way meets them.
class TriangleTree {
  public:
    TriangleTree() = default;
    TriangleTree(const MeshData& mesh, const glm::dmat4& to_world);

    /// The first point of the way from `from` to `to` [mm] on a triangle, of either side.
    [[nodiscard]] std::optional<FoundPoint> first_hit(const glm::dvec3& from, const glm::dvec3& to) const;
    /// As nearest_point().
    [[nodiscard]] std::optional<FoundPoint> nearest(const glm::dvec3& place_mm) const;

  private:
    struct Triangle {
        glm::dvec3 p{0.0};
        glm::dvec3 e1{0.0};
        glm::dvec3 e2{0.0};
        glm::dvec2 uv{0.0};
        glm::dvec2 d1{0.0};
        glm::dvec2 d2{0.0};
        std::uint32_t index = 0;
    };
    /// A leaf holds `count` triangles from `first`; an inner node's children are the next node and `first`.
    struct Node {
        glm::dvec3 low{0.0};
        glm::dvec3 high{0.0};
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };
    void build(std::size_t first, std::size_t count);

    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace viscera::tissue
