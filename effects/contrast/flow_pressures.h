#pragma once

#include <span>
#include <vector>

#include "effects/contrast/flow_terminals.h"

namespace viscera::contrast {

/// What flows through tubes with the pressure of some nodes held.
struct TubeFlow {
    std::vector<double> pressure_pa;  ///< per node; 0 where no terminal is connected
    std::vector<double> flow_mm3_s;   ///< per edge, positive from a to b; exactly 0 where nothing flows
};

[[nodiscard]] TubeFlow solve_pressures(const CentrelineGraph& graph, std::span<const Tube> tubes,
                                       const Terminals& terminals);

}  // namespace viscera::contrast
