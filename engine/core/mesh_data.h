#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/finite.h"

namespace viscera {

/// Axis-aligned box in the mesh's own frame. Default: empty (min > max).
struct Bounds {
    glm::vec3 min{std::numeric_limits<float>::max()};
    glm::vec3 max{std::numeric_limits<float>::lowest()};
    [[nodiscard]] bool empty() const { return min.x > max.x; }
    void extend(const glm::vec3& p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
};

/// One named float per vertex, as point data of VTP or a custom glTF attribute (`_NAME`) gives it.
struct VertexScalars {
    std::string name;
    std::vector<float> values;  ///< one per vertex
};

/// A triangle mesh as loaders leave it: every index is in range, every position finite.
struct MeshData {
    std::string name;
    std::vector<glm::vec3> positions;    ///< [mm]
    std::vector<glm::vec3> normals;      ///< unit length, one per vertex, or empty
    std::vector<glm::vec2> uvs;          ///< one per vertex, or empty; v from the bottom of a picture
    std::vector<std::uint32_t> indices;  ///< 3 per triangle
    std::vector<VertexScalars> scalars;

    [[nodiscard]] std::size_t triangle_count() const { return indices.size() / 3; }
    [[nodiscard]] Bounds bounds() const {
        Bounds box;
        for (const glm::vec3& p : positions) {
            box.extend(p);
        }
        return box;
    }
};

/// A vessel centreline: nodes joined by edges. Each edge is one straight segment.
struct CentrelineGraph {
    struct Node {
        glm::dvec3 position_mm{0.0};
        double radius_mm = 0.0;
    };
    struct Edge {
        std::uint32_t a = 0;  ///< node index
        std::uint32_t b = 0;  ///< node index
    };
    std::vector<Node> nodes;
    std::vector<Edge> edges;
    /// Whether an edge joins two different nodes of the graph whose places and radii are finite.
    [[nodiscard]] bool joins(const Edge& edge) const {
        const auto sound = [&](std::uint32_t node) {
            return node < nodes.size() && finite(nodes[node].position_mm) && finite(nodes[node].radius_mm);
        };
        return edge.a != edge.b && sound(edge.a) && sound(edge.b);
    }
    std::string name = "centreline";  ///< for the log: its file
};

}  // namespace viscera
