#pragma once

#include "assets/generate/vessel_tree.h"

namespace viscera::assets {

/// A Y of three straight vessels in the xz plane, for tests and documents: a stem of 3 mm radius and 40 mm
/// length up the z axis to the origin, then two arms of 30 mm that share its flow (2.38 mm by Murray's law).
[[nodiscard]] VesselTree make_tube();

/// Density that falls from 1 at the inlet to 0 at the arms' tips, one value per vertex, named `_DENSITY`.
[[nodiscard]] VertexScalars tube_density(const VesselTree& tube, const MeshData& mesh);

}  // namespace viscera::assets
