#include "effects/contrast/flow_network.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <string>

#include <Eigen/SparseCholesky>

#include "engine/core/error.h"

namespace viscera::contrast {
namespace {

constexpr double pascal_per_mmhg = 133.322387415;
constexpr double smallest_flow = 1.0e-12;
constexpr double smallest_length = 1.0e-6;
constexpr double never = std::numeric_limits<double>::infinity();

struct Tube {
    double conductance = 0.0;  // [mm^3 / (s Pa)]; 0: closed
    double volume_mm3 = 0.0;
    bool valid = false;  // joins two nodes, open or closed
};

bool finite(const CentrelineGraph::Node& node) {
    return std::isfinite(node.position_mm.x) && std::isfinite(node.position_mm.y) &&
           std::isfinite(node.position_mm.z) && std::isfinite(node.radius_mm);
}

std::vector<Tube> make_tubes(const CentrelineGraph& graph, double viscosity_pa_s, Log& log) {
    std::vector<Tube> tubes(graph.edges.size());
    std::vector<double> lengths(graph.edges.size(), 0.0);
    std::uint64_t broken = 0;
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        const auto [a, b] = graph.edges[e];
        tubes[e].valid = a < graph.nodes.size() && b < graph.nodes.size() && a != b &&
                         finite(graph.nodes[a]) && finite(graph.nodes[b]);
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
        if (!(tubes[e].conductance > 0.0) || !std::isfinite(tubes[e].conductance)) {
            tubes[e] = {.valid = true};  // beyond what a double can hold
            ++closed;
        }
    }
    if (broken > 0) {
        log.fault("contrast.graph_edge",
                  "centreline has edges without two different, finite nodes; they are left out", broken);
    }
    if (closed > 0) {
        log.fault("contrast.graph_radius",
                  "centreline has radii that are not > 0; such edges are closed and conduct nothing", closed);
    }
    if (short_edges > 0) {
        log.fault("contrast.graph_length", "centreline has edges of no length; taken as 1e-6 of the longest",
                  short_edges);
    }
    return tubes;
}

struct Terminals {
    std::vector<std::size_t> inlets;
    std::vector<std::size_t> outlets;
    std::vector<double> pressure_pa;  // per node; NaN where free
};

void hold(Terminals& terminals, std::vector<std::size_t>& list, std::size_t node, double pressure_mmhg) {
    terminals.pressure_pa[node] = pressure_mmhg * pascal_per_mmhg;
    list.push_back(node);
}

void hold_given(Terminals& terminals, std::vector<std::size_t>& list, const std::vector<FlowTerminal>& given,
                const std::string& where) {
    for (std::size_t i = 0; i < given.size(); ++i) {
        const std::string place = where + "/" + std::to_string(i);
        const FlowTerminal& terminal = given[i];
        if (terminal.node < 0 || static_cast<std::size_t>(terminal.node) >= terminals.pressure_pa.size()) {
            throw Error(ErrorCode::scene, place,
                        "node " + std::to_string(terminal.node) + " does not exist; the centreline has " +
                            std::to_string(terminals.pressure_pa.size()));
        }
        const auto node = static_cast<std::size_t>(terminal.node);
        if (!std::isfinite(terminal.pressure_mmhg)) {
            throw Error(ErrorCode::scene, place, "the pressure is not finite");
        }
        if (!std::isnan(terminals.pressure_pa[node])) {
            throw Error(ErrorCode::scene, place, "node " + std::to_string(terminal.node) + " is named twice");
        }
        hold(terminals, list, node, terminal.pressure_mmhg);
    }
}

Terminals find_terminals(const CentrelineGraph& graph, const std::vector<Tube>& tubes,
                         const FlowParams& params) {
    Terminals terminals;
    terminals.pressure_pa.assign(graph.nodes.size(), std::numeric_limits<double>::quiet_NaN());
    hold_given(terminals, terminals.inlets, params.inlets, "flow/inlets");
    hold_given(terminals, terminals.outlets, params.outlets, "flow/outlets");

    std::vector<int> degree(graph.nodes.size(), 0);
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (tubes[e].valid) {
            ++degree[graph.edges[e].a];
            ++degree[graph.edges[e].b];
        }
    }
    const auto is_free_end = [&](std::size_t node) {
        return degree[node] == 1 && std::isnan(terminals.pressure_pa[node]);
    };
    if (params.inlets.empty()) {
        std::optional<std::size_t> widest;
        for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
            if (is_free_end(n) && (!widest || graph.nodes[n].radius_mm > graph.nodes[*widest].radius_mm)) {
                widest = n;
            }
        }
        if (widest) {
            hold(terminals, terminals.inlets, *widest, params.inlet_pressure_mmhg);
        }
    }
    if (params.outlets.empty()) {
        for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
            if (is_free_end(n)) {
                hold(terminals, terminals.outlets, n, params.outlet_pressure_mmhg);
            }
        }
    }
    return terminals;
}

// Nodes joined to a terminal through open edges; the others have no defined pressure.
std::vector<bool> connected_nodes(const CentrelineGraph& graph, const std::vector<Tube>& tubes,
                                  const Terminals& terminals) {
    std::vector<std::vector<std::size_t>> neighbours(graph.nodes.size());
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (tubes[e].conductance > 0.0) {
            neighbours[graph.edges[e].a].push_back(graph.edges[e].b);
            neighbours[graph.edges[e].b].push_back(graph.edges[e].a);
        }
    }
    std::vector<bool> seen(graph.nodes.size(), false);
    std::vector<std::size_t> stack;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        if (!std::isnan(terminals.pressure_pa[n])) {
            seen[n] = true;
            stack.push_back(n);
        }
    }
    while (!stack.empty()) {
        const std::size_t node = stack.back();
        stack.pop_back();
        for (const std::size_t next : neighbours[node]) {
            if (!seen[next]) {
                seen[next] = true;
                stack.push_back(next);
            }
        }
    }
    return seen;
}

// Fills pressures and flows with the terminals held.
void solve_pressures(const CentrelineGraph& graph, const std::vector<Tube>& tubes, const Terminals& terminals,
                     FlowNetwork& network) {
    const std::vector<bool> connected = connected_nodes(graph, tubes, terminals);
    double unit = 0.0;
    for (const Tube& tube : tubes) {
        unit = std::max(unit, tube.conductance);
    }
    std::vector<Eigen::Index> row(graph.nodes.size(), -1);
    Eigen::Index unknowns = 0;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        if (!std::isnan(terminals.pressure_pa[n])) {
            network.pressure_pa[n] = terminals.pressure_pa[n];
        } else if (connected[n]) {
            row[n] = unknowns++;
        }
    }
    std::vector<Eigen::Triplet<double>> triplets;
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (tubes[e].conductance > 0.0) {
            const double g = tubes[e].conductance / unit;
            const Eigen::Index a = row[graph.edges[e].a];
            const Eigen::Index b = row[graph.edges[e].b];
            if (a >= 0) {
                triplets.emplace_back(a, a, g);
            }
            if (b >= 0) {
                triplets.emplace_back(b, b, g);
            }
            if (a >= 0 && b >= 0) {
                triplets.emplace_back(a, b, -g);
                triplets.emplace_back(b, a, -g);
            }
        }
    }
    Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
    laplacian.setFromTriplets(triplets.begin(), triplets.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
    if (unknowns > 0) {
        solver.compute(laplacian);
    }
    // The first round finds the pressures from the flows that the terminals alone drive; the next two put
    // right what flows in and does not flow out. The drop of a short wide edge drowns in its pressures, but
    // the sum of its rounds does not.
    std::vector<double> correction = network.pressure_pa;
    for (int round = 0; round < 3; ++round) {
        Eigen::VectorXd surplus = Eigen::VectorXd::Zero(unknowns);
        if (round > 0) {
            std::ranges::fill(correction, 0.0);
        }
        for (std::size_t e = 0; e < tubes.size(); ++e) {
            if (tubes[e].conductance > 0.0) {
                const auto [a, b] = graph.edges[e];
                const double q = round > 0 ? network.flow_mm3_s[e]
                                           : tubes[e].conductance * (correction[a] - correction[b]);
                if (row[a] >= 0) {
                    surplus[row[a]] -= q / unit;
                }
                if (row[b] >= 0) {
                    surplus[row[b]] += q / unit;
                }
            }
        }
        if (unknowns > 0) {
            const Eigen::VectorXd solution = solver.solve(surplus);
            for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
                if (row[n] >= 0) {
                    correction[n] = solution[row[n]];
                    network.pressure_pa[n] += correction[n];
                }
            }
        }
        for (std::size_t e = 0; e < tubes.size(); ++e) {
            const auto [a, b] = graph.edges[e];
            if (tubes[e].conductance > 0.0) {
                network.flow_mm3_s[e] += tubes[e].conductance * (correction[a] - correction[b]);
            }
        }
    }
    double largest = 0.0;
    for (const double q : network.flow_mm3_s) {
        largest = std::max(largest, std::abs(q));
    }
    for (double& q : network.flow_mm3_s) {
        q = std::isfinite(q) && std::abs(q) > smallest_flow * largest ? q : 0.0;
    }
}

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
        log.fault("contrast.no_inlet", "centreline has no inlet: nothing flows");
        return network;
    }
    if (terminals.outlets.empty()) {
        log.fault("contrast.no_outlet", "centreline has no outlet: nothing flows");
        return network;
    }
    solve_pressures(graph, tubes, terminals, network);

    const std::vector<double> out = outflow(graph, network);
    const std::vector<std::size_t> sources = find_sources(graph, out, terminals.inlets, injection_mm);
    if (sources.empty()) {
        log.fault("contrast.no_flow", "nothing flows out of the injection: no part is reached");
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
        log.fault("contrast.unreached_nodes", "parts of the centreline are reached by no contrast",
                  unreached);
    }
    return network;
}

}  // namespace viscera::contrast
