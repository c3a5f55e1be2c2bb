#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/transfer_function.h"
#include "engine/io/colour_space.h"

namespace viscera::io {

/// A node of vtkPiecewiseFunction or vtkColorTransferFunction. Midpoint and sharpness shape what follows it:
/// half way at `midpoint` (share of the interval), straight at sharpness 0, a step at 1.
struct VtkNode {
    double x = 0.0;          ///< finite
    glm::dvec3 value{0.0};   ///< a colour, or an opacity in x; [0, 1]
    double midpoint = 0.5;   ///< [0, 1]
    double sharpness = 0.0;  ///< [0, 1]
};

/// A knot of a piecewise linear curve; two at one place make a step.
struct CurveKnot {
    double x = 0.0;
    glm::dvec3 value{0.0};
};

/// Most nodes that a curve of a file may have.
inline constexpr std::size_t most_vtk_nodes = 16384;

/// The curve that VTK would draw through the nodes, as straight pieces that miss it by less than 1e-3. Nodes
/// are sorted (stable); values are cut to [0, 1].
[[nodiscard]] std::vector<CurveKnot> straighten(std::vector<VtkNode> nodes,
                                                ColourSpace space = ColourSpace::rgb);

/// As `straighten`, each interval in the colour of its end (VTK's space "Step").
[[nodiscard]] std::vector<CurveKnot> straighten_steps(std::vector<VtkNode> nodes);

/// Colour and opacity over one set of knots. Both constant beyond their ends; neither may be empty.
[[nodiscard]] std::vector<TransferPoint> merge(std::span<const CurveKnot> colour,
                                               std::span<const CurveKnot> opacity);

}  // namespace viscera::io
