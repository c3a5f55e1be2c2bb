#pragma once

#include <span>
#include <string>
#include <string_view>

#include "effects/volume/placed_mesh.h"
#include "effects/volume/reconstruction.h"
#include "effects/volume/slice_plane.h"
#include "effects/volume/source.h"
#include "effects/volume/transfer_params.h"

namespace viscera::volume {

/// picture: the plane fills the picture. camera: the plane or a mesh as the scene's camera sees it.
enum class SliceView { picture, camera };
[[nodiscard]] std::span<const std::string_view> choice_names(SliceView view);

/// What is made of the values across a thick slice.
enum class SlabFunction { mean, mip, minip };
[[nodiscard]] std::span<const std::string_view> choice_names(SlabFunction function);

struct SlabParams {
    double thickness_mm = 0.0;
    SlabFunction function = SlabFunction::mean;
    double step = 0.5;

    void visit(ParamVisitor& v);
};

struct SliceParams {
    SourceParams volume;
    SliceView view = SliceView::picture;
    PlaneParams plane;
    PlacedMesh mesh;
    double height_mm = 0.0;
    SlabParams slab;
    TransferParams transfer_function;
    ReconstructionParams sampling;
    glm::dvec4 background{0.0, 0.0, 0.0, 1.0};

    void visit(ParamVisitor& v);
    /// Throws Error(scene).
    void validate() const;
};

inline constexpr int most_slab_samples = 1024;
/// Samples across a slab of a volume: `step` voxels apart at most along every axis, of which a mm across the
/// slab crosses so many voxels; 1 for a thin slice.
[[nodiscard]] int slab_samples(const SlabParams& slab, const glm::dvec3& voxels_per_mm);

}  // namespace viscera::volume
