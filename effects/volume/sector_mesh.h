#pragma once

#include "effects/volume/space.h"
#include "engine/core/mesh_data.h"

namespace viscera::volume {

/// A closed surface closely around the coordinates of a range of a curvilinear volume, in local coordinates,
/// facing outwards. What is curved outwards lies inside of its triangles, what is curved inwards outside: all
/// of the range is enclosed.
[[nodiscard]] MeshData sector_mesh(const Space& space, const Space::Range& range);

}  // namespace viscera::volume
