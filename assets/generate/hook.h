#pragma once

#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// A monopolar hook as it comes through a trocar at the patient's left: a bent wire of 0.9 mm radius with its
/// heel in the origin, and an insulated shaft of 2.5 mm radius and 190 mm length. One outward surface
/// with normals and one chart (u around, v along), open at both ends by a pinhole of 0.04 mm.
[[nodiscard]] MeshData make_hook();

}  // namespace viscera::assets
