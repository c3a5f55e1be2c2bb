#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "effects/contrast/flow_params.h"
#include "engine/core/log.h"
#include "engine/core/mesh_data.h"

namespace viscera::contrast {

/// Steady Poiseuille flow through a centreline, and when contrast arrives. All numbers are finite but for
/// arrival and transit, which are infinite where no contrast comes.
struct FlowNetwork {
    std::vector<double> pressure_pa;  ///< per node; 0 where no terminal is connected
    std::vector<double> flow_mm3_s;   ///< per edge, positive from a to b; exactly 0 where nothing flows
    std::vector<double> transit_s;    ///< per edge: volume / |flow|
    std::vector<double> arrival_s;    ///< per node, since the injection; infinite: never
    /// Whether contrast runs through an edge (its upstream node is reached and something flows).
    [[nodiscard]] bool carries_contrast(const CentrelineGraph& graph, std::size_t edge) const;
};

/// Solves a centreline as a network of tubes.
///
/// An edge is a frustum with radii ra, rb and length L. Poiseuille's law integrated along it (8 mu / (pi r^4)
/// per length) gives the conductance pi r4 / (8 mu L) with r4 = 3 ra^3 rb^3 / (ra^2 + ra rb + rb^2), which
/// is r^4 for a tube; its volume is pi L (ra^2 + ra rb + rb^2) / 3, and the transit time volume / |Q|, which
/// is pi r^2 L / Q for a tube. Pressures follow from a sparse LDLT solve with terminals held, and are refined
/// twice in flow, so that short wide edges keep their digits. Flows below 1e-12 of the largest are rounding
/// and count as none.
///
/// Contrast starts at tau = 0 at the injection: the node with flow that is nearest to `injection_mm`, or,
/// without it, all inlets. It is carried downstream: tau of a node is the mean of (tau + transit) over the
/// incoming edges that carry contrast, weighted by their flow.
///
/// Survivable, counted in the log: edges with an index out of range, a self-loop or a number that is not
/// finite
/// ("contrast.graph_edge"); radii that are not > 0: the edge is taken as closed and conducts nothing
/// ("contrast.graph_radius"); edges of (nearly) no length, taken as 1e-6 of the longest
/// ("contrast.graph_length"); no inlet or no outlet: no flow ("contrast.no_inlet", "contrast.no_outlet"); no
/// flow out of the injection ("contrast.no_flow"); nodes that no contrast reaches
/// ("contrast.unreached_nodes"). Throws Error(scene) where a terminal names a node that does not exist or is
/// named twice, a pressure is not finite, or viscosity is not > 0.
[[nodiscard]] FlowNetwork solve_flow(const CentrelineGraph& graph, const FlowParams& params,
                                     const std::optional<glm::dvec3>& injection_mm, Log& log);

}  // namespace viscera::contrast
