#pragma once

#include <span>
#include <vector>

#include "effects/contrast/flow_params.h"
#include "effects/contrast/flow_tubes.h"

namespace viscera::contrast {

/// Nodes whose pressure is held.
struct Terminals {
    std::vector<std::size_t> inlets;
    std::vector<std::size_t> outlets;
    std::vector<double> pressure_pa;  ///< per node; NaN where free
};

/// As the parameters name them; without inlets the widest free end is one, without outlets all other free
/// ends are. Throws Error(scene) as solve_flow() says.
[[nodiscard]] Terminals find_terminals(const CentrelineGraph& graph, std::span<const Tube> tubes,
                                       const FlowParams& params);

}  // namespace viscera::contrast
