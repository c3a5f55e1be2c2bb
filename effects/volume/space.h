#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/source.h"
#include "engine/gl/program.h"

namespace viscera::volume {

/// The local coordinates in which a volume's rays are cast. Cartesian: the texture's own. Curvilinear: those
/// of the shape's frame in units of its outer radius, turned so that the middle of the angles lies on x.
struct Space {
    VolumeShape shape{};  ///< curvilinear: in local units and directions
    glm::ivec3 dims{1};
    glm::dmat4 local_to_unplaced{1.0};  ///< local -> world without the placement, in which labels lie
    glm::dmat4 local_to_world{1.0};
    glm::dvec3 low{0.0};  ///< the box around the volume, local
    glm::dvec3 high{1.0};

    /// The unit box -> world, with the placement.
    [[nodiscard]] glm::dmat4 box_to_world() const;
    /// The box around what lies between texture coordinates, local.
    [[nodiscard]] FrameBox box_of(const glm::dvec3& texture_low, const glm::dvec3& texture_high) const;
    /// Curvilinear coordinates between texture coordinates, within the volume.
    struct Range {
        glm::dvec3 low{0.0};
        glm::dvec3 high{0.0};
    };
    [[nodiscard]] Range coordinates(const glm::dvec3& texture_low, const glm::dvec3& texture_high) const;
    /// Texture coordinate = scale * curvilinear coordinate + offset, per axis.
    struct SampleMap {
        glm::dvec3 scale{1.0};
        glm::dvec3 offset{0.0};
    };
    [[nodiscard]] SampleMap sample_map() const;
};
[[nodiscard]] Space make_space(const VolumeGrid& grid, const PlacementParams& placement);

/// Whether a grid has the same shape at the same place as another, whatever its number of voxels.
[[nodiscard]] bool same_shape(const VolumeGrid& a, const VolumeGrid& b);

/// Texture coordinates of a curvilinear volume -> those of another of the same shape.
[[nodiscard]] Space::SampleMap between(const glm::ivec3& from, const glm::ivec3& to, int wrap_axis);

/// Defines of programs that read volumes of a kind.
[[nodiscard]] std::vector<std::string> coordinate_defines(VolumeKind kind);
/// Sets what glsl/volume/place_*.glsl need.
void set_places(const gl::Program& program, const Space& space);
/// Sets what glsl/volume/coordinates_*.glsl need; crop in texture coordinates.
void set_coordinates(const gl::Program& program, const Space& space, const glm::dvec3& crop_low,
                     const glm::dvec3& crop_high);

/// How finely a volume is sampled: the least distance of voxels in the world [mm]. Curvilinear: along arcs at
/// the middle of the radii, since they shrink to nothing at the axis.
[[nodiscard]] double voxel_spacing_mm(const Space& space);

}  // namespace viscera::volume
