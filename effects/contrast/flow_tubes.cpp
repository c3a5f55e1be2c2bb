#include "effects/contrast/flow_tubes.h"

#include <algorithm>
#include <numbers>

#include "engine/core/finite.h"

namespace viscera::contrast {
namespace {

constexpr double smallest_length = 1.0e-6;

}  // namespace

std::vector<Tube> make_tubes(const CentrelineGraph& graph, double viscosity_pa_s, Log& log) {
    std::vector<Tube> tubes(graph.edges.size());
    std::vector<double> lengths(graph.edges.size(), 0.0);
    std::uint64_t broken = 0;
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        const auto [a, b] = graph.edges[e];
        tubes[e].valid = graph.joins(graph.edges[e]);
        if (tubes[e].valid) {
            lengths[e] = glm::distance(graph.nodes[a].position_mm, graph.nodes[b].position_mm);
        } else {
            ++broken;
        }
    }
    const double longest = lengths.empty() ? 0.0 : *std::ranges::max_element(lengths);
    const double shortest = longest > 0.0 ? smallest_length * longest : smallest_length;
    std::uint64_t closed = 0;
    std::uint64_t short_edges = 0;
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (!tubes[e].valid) {
            continue;
        }
        const double ra = graph.nodes[graph.edges[e].a].radius_mm;
        const double rb = graph.nodes[graph.edges[e].b].radius_mm;
        if (!(ra > 0.0) || !(rb > 0.0)) {
            ++closed;
            continue;
        }
        short_edges += lengths[e] < shortest ? 1 : 0;
        const double length = std::max(lengths[e], shortest);
        const double squares = ra * ra + ra * rb + rb * rb;
        const double r4 = 3.0 * ra * ra * rb * rb * (ra * rb / squares);
        // mm^4 / (Pa s mm) = mm^3 / (s Pa): lengths may stay in millimetres.
        tubes[e].conductance = std::numbers::pi * r4 / (8.0 * viscosity_pa_s * length);
        tubes[e].volume_mm3 = std::numbers::pi * length * squares / 3.0;
        if (!(tubes[e].conductance > 0.0) || !finite(tubes[e].conductance)) {
            tubes[e] = {.valid = true};  // beyond what a double can hold
            ++closed;
        }
    }
    if (broken > 0) {
        log.fault("contrast.graph_edge",
                  graph.name + ": has edges without two different, finite nodes; they are left out", broken);
    }
    if (closed > 0) {
        log.fault("contrast.graph_radius",
                  graph.name + ": has radii that are not > 0; such edges are closed and conduct nothing",
                  closed);
    }
    if (short_edges > 0) {
        log.fault("contrast.graph_length",
                  graph.name + ": has edges of no length; taken as 1e-6 of the longest", short_edges);
    }
    return tubes;
}

}  // namespace viscera::contrast
