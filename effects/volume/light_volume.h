#pragma once

#include <functional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/core/volume.h"

namespace viscera::volume {

/// Shadow and ambient occlusion from a coarse grid of the volume's extinction.
struct LightVolumeParams {
    double shadow = 0.0;
    double ambient_occlusion = 0.0;
    int resolution = 48;
    double radius_mm = 20.0;

    void visit(ParamVisitor& v);
    [[nodiscard]] bool used() const { return shadow > 0.0 || ambient_occlusion > 0.0; }
};

/// Mean extinction over the cells of a coarse grid in the volume's box; x fastest.
struct ExtinctionGrid {
    glm::ivec3 dims{1};
    glm::dmat4 texture_to_world{1.0};
    std::vector<float> per_mm;

    /// Linear between cell centres, constant beyond the outermost.
    [[nodiscard]] double at(const glm::dvec3& texture) const;
};

/// Extinction of a voxel [1/mm].
using VoxelExtinction = std::function<double(const glm::ivec3& voxel)>;
/// That of the values of a channel; not finite ones count as 0. The volume must outlive it.
[[nodiscard]] VoxelExtinction of_values(const Volume& volume, int channel,
                                        std::function<double(double value)> extinction);

/// `resolution`: cells along the longest side of the box; never more than there are voxels (`dims`). Each
/// cell averages at most 4 x 4 x 4 of its voxels, evenly chosen.
[[nodiscard]] ExtinctionGrid extinction_grid(const glm::ivec3& dims, const glm::dmat4& texture_to_world,
                                             int resolution, const VoxelExtinction& extinction);

/// The same for a volume of any shape, over the unit box around it: grid.box_to_world() with the placement.
/// Each cell averages 2 x 2 x 2 places, each of the voxel that it lies in; beside the volume there is
/// nothing.
[[nodiscard]] ExtinctionGrid extinction_in_box(const VolumeGrid& voxels, const glm::dmat4& box_to_world,
                                               int resolution, const VoxelExtinction& extinction);

/// Share of light that reaches a place (texture coordinates) from the world direction `towards`, of length 1,
/// from no farther than `reach_mm`: exp of minus the extinction summed in steps of one cell at most, by
/// midpoints. The length of one cell next to the place is left out, so that surfaces do not darken
/// themselves.
[[nodiscard]] double transmittance(const ExtinctionGrid& grid, const glm::dvec3& texture,
                                   const glm::dvec3& towards, double reach_mm);

/// Where the light comes from: a direction towards it, or its place [mm] (w 1).
[[nodiscard]] std::vector<glm::vec2> light_volume(const ExtinctionGrid& grid, const LightVolumeParams& params,
                                                  const glm::dvec4& light);

}  // namespace viscera::volume
