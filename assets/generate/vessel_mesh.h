#pragma once

#include "assets/generate/vessel_tree.h"
#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// Triangle mesh of a tree's wall, with outward unit normals: the zero surface of its VesselField on a grid
/// of the given spacing [mm], vertices spread evenly and brought back onto the wall.
[[nodiscard]] MeshData mesh_vessels(const VesselTree& tree, double spacing_mm);

/// What a closed surface is checked by.
struct SurfaceCheck {
    std::size_t components = 0;
    std::size_t bad_edges = 0;   ///< edges not used exactly once in each direction
    std::size_t degenerate = 0;  ///< triangles with a height below 1e-3 of their longest edge
    std::ptrdiff_t euler = 0;    ///< V - E + F
    double volume_mm3 = 0.0;     ///< positive when triangles face outward

    /// One closed, outward surface without handles.
    [[nodiscard]] bool sound() const {
        return components == 1 && bad_edges == 0 && degenerate == 0 && euler == 2 && volume_mm3 > 0.0;
    }
};
[[nodiscard]] SurfaceCheck check_surface(const MeshData& mesh);

}  // namespace viscera::assets
