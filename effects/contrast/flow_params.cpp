#include "effects/contrast/flow_params.h"

namespace viscera::contrast {

void FlowTerminal::visit(ParamVisitor& v) {
    v.field({.name = "node", .doc = "Index of the centreline's node.", .min = 0, .required = true}, node);
    v.field({.name = "pressure_mmhg", .doc = "Pressure held at the node.", .unit = "mmHg", .required = true},
            pressure_mmhg);
}

void FlowParams::visit(ParamVisitor& v) {
    v.field({.name = "viscosity_pa_s",
             .doc = "Dynamic viscosity of blood.",
             .unit = "Pa s",
             .min = 0,
             .min_excluded = true},
            viscosity_pa_s);
    v.field({.name = "inlets", .doc = "Nodes that feed the network; none: the widest vessel end."}, inlets);
    v.field({.name = "outlets", .doc = "Nodes that drain it; none: every other vessel end."}, outlets);
    v.field(
        {.name = "inlet_pressure_mmhg", .doc = "Pressure of the inlet chosen by default.", .unit = "mmHg"},
        inlet_pressure_mmhg);
    v.field({.name = "outlet_pressure_mmhg", .doc = "Pressure of outlets chosen by default.", .unit = "mmHg"},
            outlet_pressure_mmhg);
    v.field(
        {.name = "injection_speed_mm_s",
         .doc = "Mean speed of blood at the injection, to which the flow is scaled; 0 keeps the pressures.",
         .unit = "mm/s",
         .min = 0},
        injection_speed_mm_s);
}

}  // namespace viscera::contrast
