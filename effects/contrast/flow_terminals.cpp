#include "effects/contrast/flow_terminals.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "engine/core/error.h"

namespace viscera::contrast {
namespace {

constexpr double pascal_per_mmhg = 133.322387415;

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
                            std::to_string(terminals.pressure_pa.size()) + " nodes");
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

}  // namespace

Terminals find_terminals(const CentrelineGraph& graph, std::span<const Tube> tubes,
                         const FlowParams& params) {
    Terminals terminals;
    terminals.pressure_pa.assign(graph.nodes.size(), std::numeric_limits<double>::quiet_NaN());
    hold_given(terminals, terminals.inlets, params.inlets, "/vessel/flow/inlets");
    hold_given(terminals, terminals.outlets, params.outlets, "/vessel/flow/outlets");

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

}  // namespace viscera::contrast
