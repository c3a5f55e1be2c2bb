#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/contrast/flow_network.h"
#include "engine/core/log.h"
#include "engine/core/mesh_data.h"

namespace viscera::contrast {

/// Arrival time [s] of each mesh vertex, taken from the centreline: one value per position, `unreached_s`
/// where no contrast comes.
///
/// The vessel that a vertex belongs to is that of the edge with the least `d - r`: d the distance from the
/// vertex to the edge's segment, r the radius interpolated at the foot of the perpendicular. So it is the
/// distance to the vessel's wall, negative within it, that counts, and a thin vessel beside a wide one does
/// not capture the wide one's wall. Radii are noisy along a vessel, so the foot then slides to the joined
/// edge as long as that makes d itself smaller. tau is linear along the edge between the times of its nodes.
///
/// Vertices at edges that carry no contrast are counted under "contrast.unreached_vertices".
/// network must be the result of solve_flow() for this graph.
[[nodiscard]] std::vector<float> vertex_arrival(const CentrelineGraph& graph, const FlowNetwork& network,
                                                std::span<const glm::vec3> positions_mm, Log& log);

}  // namespace viscera::contrast
