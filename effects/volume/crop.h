#pragma once

#include "effects/volume/ray_cast_params.h"

namespace viscera::volume {

/// What a crop leaves of a volume.
struct CropBox {
    glm::dvec3 low{0.0};  ///< texture coordinates
    glm::dvec3 high{1.0};
    VoxelBox voxels;  ///< all that it touches
};
/// `dims`: voxels per axis. Beyond the volume there is nothing to keep, so the box may be empty.
[[nodiscard]] CropBox crop_box(const CropParams& crop, const glm::ivec3& dims);

/// What drawn limits belong to (Prepare::subject()): the volume's place, and the crop where it is the faces
/// of its box that are drawn. `crop` null: a mesh is.
[[nodiscard]] std::uint64_t limits_subject(const glm::dmat4& local_to_world, const CropParams* crop,
                                           const glm::ivec3& dims);

}  // namespace viscera::volume
