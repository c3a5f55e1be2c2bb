#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/contrast/flow_network.h"
#include "effects/contrast/tube_tree.h"
#include "engine/core/log.h"
#include "engine/core/mesh_data.h"

namespace viscera::contrast {

/// Where mesh vertices stand at the centreline: for each a foot, none for a position that is not finite or
/// where there is no edge.
struct VertexFeet {
    std::vector<std::optional<TubeFoot>> wall;  ///< on the vessel that the vertex belongs to
    std::vector<std::optional<TubeFoot>> axis;  ///< on the way that contrast takes past it
};

/// The vessel that a vertex belongs to is that of the edge with the least `d - r`: d the distance from the
/// vertex to the edge's segment, r the radius interpolated at the foot of the perpendicular. So it is the
/// distance to the vessel's wall, negative within it, that counts, and a thin vessel beside a wide one does
/// not capture the wide one's wall. Radii are noisy along a vessel, so the foot of the way then slides to the
/// joined edge as long as that makes d itself smaller. Where a branch leaves, that may be the branch's.
[[nodiscard]] VertexFeet vertex_feet(const CentrelineGraph& graph, std::span<const glm::vec3> positions_mm);

/// Says, under "contrast.centreline_apart", where more than half of the vertices lie farther from the
/// centreline than three radii: each vertex has a nearest edge, but then it tells nothing.
void report_apart(const CentrelineGraph& graph, const VertexFeet& feet, Log& log);

/// Arrival time [s] at each foot on the way, linear along the edge between the times of its nodes;
/// `unreached_s` where no contrast comes, counted under "contrast.unreached_vertices". network must be the
/// result of solve_flow() for this graph.
[[nodiscard]] std::vector<float> vertex_arrival(const CentrelineGraph& graph, const FlowNetwork& network,
                                                const VertexFeet& feet, Log& log);

/// The vessels that vertices belong to, one entry per vertex; 0 without a foot.
struct VertexTubes {
    /// xyz its direction, a unit vector, shorter at rounded ends and 0 at their tips; w the radius [mm].
    std::vector<glm::vec4> axis;
    std::vector<glm::vec3> offset_mm;  ///< from the axis to the vertex
};
[[nodiscard]] VertexTubes vertex_tubes(const CentrelineGraph& graph, const VertexFeet& feet,
                                       std::span<const glm::vec3> positions_mm);

/// Evens out arrival times over the mesh: in each round every vertex takes the mean of itself and the mean of
/// its neighbours. Centrelines are jagged, so feet jump by some millimetres on the inside of a bend, and the
/// front would be ragged there; two or three rounds make it whole. Vertices that are not reached neither give
/// nor take, and two vessels that only touch share no edge, so nothing leaks between them. Vertices at one
/// place are one: where texture or normals have a seam, the front has none. positions_mm: one per arrival
/// time; indices: 3 per triangle; triangles with an index out of range are passed over. rounds <= 0: nothing
/// happens.
void smooth_arrival(std::span<float> arrival_s, std::span<const glm::vec3> positions_mm,
                    std::span<const std::uint32_t> indices, int rounds);

}  // namespace viscera::contrast
