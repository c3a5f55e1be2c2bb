#include "effects/contrast/arrival_time.h"

#include <algorithm>
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

void smooth_arrival(std::span<float> arrival_s, std::span<const std::uint32_t> indices, int rounds) {
    std::vector<double> sum(arrival_s.size());
    std::vector<int> count(arrival_s.size());
    const auto reached = [&](std::uint32_t v) { return v < arrival_s.size() && arrival_s[v] < unreached_s; };
    for (int round = 0; round < rounds; ++round) {
        std::ranges::fill(sum, 0.0);
        std::ranges::fill(count, 0);
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t a = indices[i + corner];
                const std::uint32_t b = indices[i + (corner + 1) % 3];
                if (reached(a) && reached(b)) {
                    sum[a] += static_cast<double>(arrival_s[b]);
                    sum[b] += static_cast<double>(arrival_s[a]);
                    ++count[a];
                    ++count[b];
                }
            }
        }
        for (std::size_t v = 0; v < arrival_s.size(); ++v) {
            if (count[v] > 0) {
                arrival_s[v] =
                    static_cast<float>(0.5 * (static_cast<double>(arrival_s[v]) + sum[v] / count[v]));
            }
        }
    }
}

}  // namespace viscera::contrast
