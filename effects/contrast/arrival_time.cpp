#include "effects/contrast/arrival_time.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "effects/contrast/density.h"
#include "effects/contrast/tube_tree.h"
#include "engine/io/mesh.h"

namespace viscera::contrast {

std::vector<std::optional<TubeFoot>> vertex_feet(const CentrelineGraph& graph,
                                                 std::span<const glm::vec3> positions_mm) {
    std::vector<std::optional<TubeFoot>> feet(positions_mm.size());
    const TubeTree tree(graph);
    std::optional<std::size_t> guess;
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
        const glm::dvec3 point(positions_mm[i]);
        const std::optional<TubeFoot> wall = tree.nearest_wall(point, guess);
        if (wall) {
            guess = wall->edge;  // neighbours in the mesh are mostly neighbours in memory
            feet[i] = tree.slide(point, *wall);
        }
    }
    return feet;
}

void report_apart(const CentrelineGraph& graph, std::span<const std::optional<TubeFoot>> feet, Log& log) {
    constexpr double most_radii = 3.0;
    const auto apart = static_cast<std::size_t>(std::ranges::count_if(feet, [](const auto& foot) {
        return foot && foot->distance_mm > most_radii * (foot->distance_mm - foot->wall_mm);
    }));
    if (2 * apart > feet.size()) {
        log.fault("contrast.centreline_apart",
                  graph.name +
                      ": most of the vessel's vertices are more than three radii away from it; has "
                      "the mesh another unit or frame?",
                  apart);
    }
}

std::vector<float> vertex_arrival(const CentrelineGraph& graph, const FlowNetwork& network,
                                  std::span<const std::optional<TubeFoot>> feet, Log& log) {
    std::vector<float> arrival(feet.size(), unreached_s);
    std::uint64_t unreached = 0;
    for (std::size_t i = 0; i < feet.size(); ++i) {
        if (!feet[i] || !network.carries_contrast(graph, feet[i]->edge)) {
            ++unreached;
            continue;
        }
        const CentrelineGraph::Edge& edge = graph.edges[feet[i]->edge];
        arrival[i] = static_cast<float>(
            std::lerp(network.arrival_s[edge.a], network.arrival_s[edge.b], feet[i]->along));
    }
    if (unreached > 0) {
        log.fault(
            "contrast.unreached_vertices",
            graph.name +
                ": parts of the vessel mesh lie at edges of it that no contrast reaches; they stay clear",
            unreached);
    }
    return arrival;
}

std::vector<float> vertex_radius(const CentrelineGraph& graph,
                                 std::span<const std::optional<TubeFoot>> feet) {
    std::vector<float> radius(feet.size(), 0.0F);
    for (std::size_t i = 0; i < feet.size(); ++i) {
        if (feet[i]) {
            const CentrelineGraph::Edge& edge = graph.edges[feet[i]->edge];
            radius[i] = static_cast<float>(
                std::lerp(graph.nodes[edge.a].radius_mm, graph.nodes[edge.b].radius_mm, feet[i]->along));
        }
    }
    return radius;
}

void smooth_arrival(std::span<float> arrival_s, std::span<const glm::vec3> positions_mm,
                    std::span<const std::uint32_t> indices, int rounds) {
    if (rounds <= 0) {
        return;
    }
    const std::vector<std::uint32_t> place = io::first_at_same_place(positions_mm);
    std::vector<double> sum(arrival_s.size());
    std::vector<int> count(arrival_s.size());
    const auto reached = [&](std::uint32_t v) { return arrival_s[v] < unreached_s; };
    for (int round = 0; round < rounds; ++round) {
        std::ranges::fill(sum, 0.0);
        std::ranges::fill(count, 0);
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            if (std::max({indices[i], indices[i + 1], indices[i + 2]}) >= arrival_s.size()) {
                continue;
            }
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t a = place[indices[i + corner]];
                const std::uint32_t b = place[indices[i + (corner + 1) % 3]];
                if (reached(a) && reached(b)) {
                    sum[a] += static_cast<double>(arrival_s[b]);
                    sum[b] += static_cast<double>(arrival_s[a]);
                    ++count[a];
                    ++count[b];
                }
            }
        }
        for (std::size_t v = 0; v < arrival_s.size(); ++v) {
            if (place[v] != v) {
                arrival_s[v] = arrival_s[place[v]];  // the first of its place stands before it
            } else if (count[v] > 0) {
                arrival_s[v] =
                    static_cast<float>(0.5 * (static_cast<double>(arrival_s[v]) + sum[v] / count[v]));
            }
        }
    }
}

}  // namespace viscera::contrast
