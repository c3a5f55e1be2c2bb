#include "effects/contrast/arrival_time.h"

#include <cmath>
#include <optional>

#include "effects/contrast/density.h"
#include "effects/contrast/tube_tree.h"

namespace viscera::contrast {

std::vector<float> vertex_arrival(const CentrelineGraph& graph, const FlowNetwork& network,
                                  std::span<const glm::vec3> positions_mm, Log& log) {
    std::vector<float> arrival(positions_mm.size(), unreached_s);
    const TubeTree tree(graph);
    std::uint64_t unreached = 0;
    std::optional<std::size_t> guess;
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
        const glm::dvec3 point(positions_mm[i]);
        const std::optional<TubeFoot> wall = tree.nearest_wall(point, guess);
        if (!wall) {
            ++unreached;
            continue;
        }
        guess = wall->edge;  // neighbours in the mesh are mostly neighbours in memory
        const TubeFoot foot = tree.slide(point, *wall);
        if (!network.carries_contrast(graph, foot.edge)) {
            ++unreached;
            continue;
        }
        const CentrelineGraph::Edge& edge = graph.edges[foot.edge];
        arrival[i] =
            static_cast<float>(std::lerp(network.arrival_s[edge.a], network.arrival_s[edge.b], foot.along));
    }
    if (unreached > 0) {
        log.fault(
            "contrast.unreached_vertices",
            "parts of the vessel mesh lie at centreline edges that no contrast reaches; they stay clear",
            unreached);
    }
    return arrival;
}

}  // namespace viscera::contrast
