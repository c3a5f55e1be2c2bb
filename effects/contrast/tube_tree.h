#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/mesh_data.h"

namespace viscera::contrast {

/// Where a point lies at a centreline.
struct TubeFoot {
    std::size_t edge = 0;
    double along = 0.0;        ///< 0 at the edge's node a, 1 at b
    double distance_mm = 0.0;  ///< to the axis
    double wall_mm = 0.0;      ///< to the wall: distance - radius, negative within
};

/// Bounding-volume tree over the edges of a centreline, to find the vessel that a point belongs to. Edges
/// with nodes out of range or not finite are left out. Keeps a reference to the graph.
class TubeTree {
  public:
    explicit TubeTree(const CentrelineGraph& graph);

    /// The edge whose wall is nearest (least wall_mm); none when there is no edge or the point is not finite.
    /// `guess`: an edge likely to be near, to start from.
    [[nodiscard]] std::optional<TubeFoot> nearest_wall(const glm::dvec3& point_mm,
                                                       std::optional<std::size_t> guess = {}) const;
    /// Slides from a foot over joined edges while the distance to the axis shrinks.
    [[nodiscard]] TubeFoot slide(const glm::dvec3& point_mm, TubeFoot from) const;

  private:
    struct Box {
        glm::dvec3 min{0.0};
        glm::dvec3 max{0.0};
        double radius_mm = 0.0;   // the largest within
        std::uint32_t first = 0;  // leaf: first of `count` edges in edges_; else index of the left child
        std::uint32_t count = 0;  // 0: inner node, its children at `first` and `first` + 1
    };

    [[nodiscard]] TubeFoot foot(const glm::dvec3& point_mm, std::size_t edge) const;
    void build(std::size_t box, std::uint32_t first, std::uint32_t count);

    const CentrelineGraph& graph_;
    std::vector<std::uint32_t> edges_;
    std::vector<std::vector<std::uint32_t>> edges_at_node_;
    std::vector<Box> boxes_;
};

}  // namespace viscera::contrast
