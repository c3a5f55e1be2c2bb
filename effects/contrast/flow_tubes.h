#pragma once

#include <vector>

#include "engine/core/log.h"
#include "engine/core/mesh_data.h"

namespace viscera::contrast {

/// An edge of a centreline as a frustum that conducts flow.
struct Tube {
    double conductance = 0.0;  ///< [mm^3 / (s Pa)]; 0: closed
    double volume_mm3 = 0.0;
    bool valid = false;  ///< joins two nodes, open or closed
};

/// One tube per edge, by the formulas of solve_flow(), which lists the faults.
[[nodiscard]] std::vector<Tube> make_tubes(const CentrelineGraph& graph, double viscosity_pa_s, Log& log);

}  // namespace viscera::contrast
