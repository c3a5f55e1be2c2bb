#include "effects/contrast/flow_network.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "effects/contrast/flow_pressures.h"
#include "engine/core/error.h"

namespace viscera::contrast {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

std::size_t upstream(const CentrelineGraph& graph, const FlowNetwork& network, std::size_t edge) {
    return network.flow_mm3_s[edge] > 0.0 ? graph.edges[edge].a : graph.edges[edge].b;
}

std::size_t downstream(const CentrelineGraph& graph, const FlowNetwork& network, std::size_t edge) {
    return network.flow_mm3_s[edge] > 0.0 ? graph.edges[edge].b : graph.edges[edge].a;
}

std::vector<double> outflow(const CentrelineGraph& graph, const FlowNetwork& network) {
    std::vector<double> out(graph.nodes.size(), 0.0);
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
        if (network.flow_mm3_s[e] != 0.0) {
            out[upstream(graph, network, e)] += std::abs(network.flow_mm3_s[e]);
        }
    }
    return out;
}

// Nodes at which contrast enters, each with flow out of it.
std::vector<std::size_t> find_sources(const CentrelineGraph& graph, const std::vector<double>& out,
                                      const std::vector<std::size_t>& inlets,
                                      const std::optional<glm::dvec3>& injection_mm) {
    std::vector<std::size_t> sources;
    if (!injection_mm) {
        std::ranges::copy_if(inlets, std::back_inserter(sources),
                             [&](std::size_t n) { return out[n] > 0.0; });
        return sources;
    }
    double nearest = never;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        const double distance = glm::distance(graph.nodes[n].position_mm, *injection_mm);
        if (out[n] > 0.0 && distance < nearest) {
            nearest = distance;
            sources.assign(1, n);
        }
    }
    return sources;
}

void scale_to_speed(const CentrelineGraph& graph, const std::vector<double>& out,
                    const std::vector<std::size_t>& sources, double speed_mm_s, FlowNetwork& network) {
    double flow = 0.0;
    double area_mm2 = 0.0;
    for (const std::size_t n : sources) {
        flow += out[n];
        area_mm2 += std::numbers::pi * graph.nodes[n].radius_mm * graph.nodes[n].radius_mm;
    }
    const double factor = speed_mm_s * area_mm2 / flow;
    for (double& q : network.flow_mm3_s) {
        q *= factor;
    }
}

// Carries arrival times downstream: a node is settled when every edge that flows into it is.
void carry_contrast(const CentrelineGraph& graph, const std::vector<std::size_t>& sources,
                    FlowNetwork& network) {
    std::vector<int> waiting(graph.nodes.size(), 0);
    std::vector<std::vector<std::size_t>> leaving(graph.nodes.size());
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
        if (network.flow_mm3_s[e] != 0.0) {
            leaving[upstream(graph, network, e)].push_back(e);
            ++waiting[downstream(graph, network, e)];
        }
    }
    std::vector<bool> is_source(graph.nodes.size(), false);
    for (const std::size_t n : sources) {
        is_source[n] = true;
    }
    std::vector<double> weight(graph.nodes.size(), 0.0);
    std::vector<double> sum(graph.nodes.size(), 0.0);
    std::queue<std::size_t> settled;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        if (waiting[n] == 0) {
            settled.push(n);
        }
    }
    while (!settled.empty()) {
        const std::size_t node = settled.front();
        settled.pop();
        if (is_source[node]) {
            network.arrival_s[node] = 0.0;
        } else if (weight[node] > 0.0) {
            network.arrival_s[node] = sum[node] / weight[node];
        }
        for (const std::size_t e : leaving[node]) {
            const std::size_t next = downstream(graph, network, e);
            if (std::isfinite(network.arrival_s[node])) {
                const double q = std::abs(network.flow_mm3_s[e]);
                sum[next] += q * (network.arrival_s[node] + network.transit_s[e]);
                weight[next] += q;
            }
            if (--waiting[next] == 0) {
                settled.push(next);
            }
        }
    }
}

}  // namespace

bool FlowNetwork::carries_contrast(const CentrelineGraph& graph, std::size_t edge) const {
    return flow_mm3_s[edge] != 0.0 && std::isfinite(arrival_s[upstream(graph, *this, edge)]);
}

FlowNetwork solve_flow(const CentrelineGraph& graph, const FlowParams& params,
                       const std::optional<glm::dvec3>& injection_mm, Log& log) {
    for (const double value : {params.viscosity_pa_s, params.inlet_pressure_mmhg, params.outlet_pressure_mmhg,
                               params.injection_speed_mm_s}) {
        if (!std::isfinite(value)) {
            throw Error(ErrorCode::scene, "flow", "a number is not finite");
        }
    }
    if (!(params.viscosity_pa_s > 0.0) || params.injection_speed_mm_s < 0.0) {
        throw Error(ErrorCode::scene, "flow", "viscosity must be > 0 and the injection's speed >= 0");
    }
    FlowNetwork network;
    network.pressure_pa.assign(graph.nodes.size(), 0.0);
    network.flow_mm3_s.assign(graph.edges.size(), 0.0);
    network.transit_s.assign(graph.edges.size(), never);
    network.arrival_s.assign(graph.nodes.size(), never);

    const std::vector<Tube> tubes = make_tubes(graph, params.viscosity_pa_s, log);
    const Terminals terminals = find_terminals(graph, tubes, params);
    if (terminals.inlets.empty()) {
        log.fault("contrast.no_inlet", graph.name + ": has no inlet: nothing flows");
        return network;
    }
    if (terminals.outlets.empty()) {
        log.fault("contrast.no_outlet", graph.name + ": has no outlet: nothing flows");
        return network;
    }
    TubeFlow flow = solve_pressures(graph, tubes, terminals);
    network.pressure_pa = std::move(flow.pressure_pa);
    network.flow_mm3_s = std::move(flow.flow_mm3_s);

    const std::vector<double> out = outflow(graph, network);
    const std::vector<std::size_t> sources = find_sources(graph, out, terminals.inlets, injection_mm);
    if (sources.empty()) {
        log.fault("contrast.no_flow",
                  graph.name + ": nothing flows out of the injection: no part is reached");
        return network;
    }
    if (params.injection_speed_mm_s > 0.0) {
        scale_to_speed(graph, out, sources, params.injection_speed_mm_s, network);
    }
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (network.flow_mm3_s[e] != 0.0) {
            network.transit_s[e] = tubes[e].volume_mm3 / std::abs(network.flow_mm3_s[e]);
        }
    }
    carry_contrast(graph, sources, network);
    const auto unreached = static_cast<std::uint64_t>(std::ranges::count(network.arrival_s, never));
    if (unreached > 0) {
        log.fault("contrast.unreached_nodes", graph.name + ": parts of it are reached by no contrast",
                  unreached);
    }
    return network;
}

}  // namespace viscera::contrast
