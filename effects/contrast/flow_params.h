#pragma once

#include <vector>

#include "engine/core/params.h"

namespace viscera::contrast {

/// A node of the centreline held at a pressure.
struct FlowTerminal {
    int node = 0;
    double pressure_mmhg = 0.0;

    void visit(ParamVisitor& v);
};

/// How blood is driven through a centreline.
struct FlowParams {
    double viscosity_pa_s = 0.0035;
    std::vector<FlowTerminal> inlets{};  ///< empty: the widest vessel end, at inlet_pressure_mmhg
    std::vector<FlowTerminal>
        outlets{};  ///< empty: every vessel end that is no inlet, at outlet_pressure_mmhg
    double inlet_pressure_mmhg = 100.0;
    double outlet_pressure_mmhg = 20.0;
    /// Mean speed at the injection. Pressures are rarely known, and only their ratios shape the picture: the
    /// whole flow is scaled so that blood leaves the injection's cross-section at this speed. 0: the
    /// pressures are meant as they stand.
    double injection_speed_mm_s = 250.0;

    void visit(ParamVisitor& v);
};

}  // namespace viscera::contrast
