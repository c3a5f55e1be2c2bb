#include "effects/contrast/arrival_time.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "effects/contrast/density.h"
#include "effects/contrast/tube_tree.h"
#include "engine/io/mesh.h"

namespace viscera::contrast {

VertexFeet vertex_feet(const CentrelineGraph& graph, std::span<const glm::vec3> positions_mm) {
    VertexFeet feet;
    feet.wall.resize(positions_mm.size());
    feet.axis.resize(positions_mm.size());
    const TubeTree tree(graph);
    std::optional<std::size_t> guess;
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
        const glm::dvec3 point(positions_mm[i]);
        feet.wall[i] = tree.nearest_wall(point, guess);
        if (feet.wall[i]) {
            guess = feet.wall[i]->edge;  // neighbours in the mesh are mostly neighbours in memory
            feet.axis[i] = tree.slide(point, *feet.wall[i]);
        }
    }
    return feet;
}

void report_apart(const CentrelineGraph& graph, const VertexFeet& feet, Log& log) {
    constexpr double most_radii = 3.0;
    const auto apart = static_cast<std::size_t>(std::ranges::count_if(feet.wall, [](const auto& foot) {
        return foot && foot->distance_mm > most_radii * (foot->distance_mm - foot->wall_mm);
    }));
    if (2 * apart > feet.wall.size()) {
        log.fault("contrast.centreline_apart",
                  graph.name +
                      ": most of the vessel's vertices are more than three radii away from it; has "
                      "the mesh another unit or frame?",
                  apart);
    }
}

std::vector<float> vertex_arrival(const CentrelineGraph& graph, const FlowNetwork& network,
                                  const VertexFeet& feet, Log& log) {
    std::vector<float> arrival(feet.axis.size(), unreached_s);
    std::uint64_t unreached = 0;
    for (std::size_t i = 0; i < arrival.size(); ++i) {
        const std::optional<TubeFoot>& foot = feet.axis[i];
        if (!foot || !network.carries_contrast(graph, foot->edge)) {
            ++unreached;
            continue;
        }
        const CentrelineGraph::Edge& edge = graph.edges[foot->edge];
        arrival[i] =
            static_cast<float>(std::lerp(network.arrival_s[edge.a], network.arrival_s[edge.b], foot->along));
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

VertexTubes vertex_tubes(const CentrelineGraph& graph, const VertexFeet& feet,
                         std::span<const glm::vec3> positions_mm) {
    VertexTubes tubes;
    tubes.axis.resize(positions_mm.size(), glm::vec4(0.0F));
    tubes.offset_mm.resize(positions_mm.size(), glm::vec3(0.0F));
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
        if (const std::optional<TubeFoot>& foot = feet.wall[i]) {
            const CentrelineGraph::Edge& edge = graph.edges[foot->edge];
            const CentrelineGraph::Node& a = graph.nodes[edge.a];
            const CentrelineGraph::Node& b = graph.nodes[edge.b];
            const glm::dvec3 along = b.position_mm - a.position_mm;
            const glm::dvec3 offset = glm::dvec3(positions_mm[i]) - (a.position_mm + foot->along * along);
            // Beyond the ends of its edge a wall is round as a ball, which has no axis.
            const double product = glm::length(along) * glm::length(offset);
            const double sine = product > 0.0 ? glm::length(glm::cross(along, offset)) / product : 0.0;
            tubes.axis[i] = glm::vec4(sine > 0.0 ? sine * glm::normalize(along) : glm::dvec3(0.0),
                                      std::lerp(a.radius_mm, b.radius_mm, foot->along));
            tubes.offset_mm[i] = offset;
        }
    }
    return tubes;
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
