#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/params.h"
#include "engine/gl/sampler.h"

namespace viscera::volume {

/// How voxels become a field. linear, bspline and catmull_rom use the texture unit, whose weights have 8 bits
/// on most GPUs; those of *_fp32 have full precision. bspline and bspline_fp32 are tricubic B-splines,
/// catmull_rom and catmull_rom_fp32 Keys' tricubic with a = -1/2.
enum class ReconstructionFilter {
    automatic,  ///< linear, or nearest where the transfer function's preset asks for it
    nearest,
    linear,
    linear_fp32,
    bspline,
    bspline_fp32,
    catmull_rom,
    catmull_rom_fp32
};
[[nodiscard]] std::span<const std::string_view> choice_names(ReconstructionFilter filter);

/// automatic: central for nearest and linear filters, analytic for cubic ones.
enum class GradientKind { automatic, central, analytic, precomputed };
[[nodiscard]] std::span<const std::string_view> choice_names(GradientKind kind);

/// How a volume is reconstructed between its voxels: glsl/volume/sample.glsl.
struct ReconstructionParams {
    ReconstructionFilter filter = ReconstructionFilter::automatic;
    bool prefilter = true;
    GradientKind gradient = GradientKind::automatic;

    void visit(ParamVisitor& v);

    /// Whether the texture holds B-spline coefficients instead of voxels.
    [[nodiscard]] bool uses_coefficients() const;
    /// Whether the field is of a higher degree than three along a ray through a cell.
    [[nodiscard]] bool is_tricubic() const;
    /// Whether gradients are kept (effects/volume/gradients.h), which those of a trilinear filter can be.
    [[nodiscard]] bool keeps_gradients() const { return gradient == GradientKind::precomputed; }
    /// How the texture unit filters. `nearest_wanted`: by the transfer function's preset.
    [[nodiscard]] gl::Filter texture_filter(bool nearest_wanted = false) const;
    /// What a brick's range must include: the farthest voxel that counts lies less than this beyond the place
    /// that is sampled, plus half a voxel [voxels].
    [[nodiscard]] double support_voxels() const;
    /// For find_occupied().
    [[nodiscard]] float overshoot() const;
    /// For programs that include volume/sample.glsl.
    [[nodiscard]] std::vector<std::string> defines() const;
};

}  // namespace viscera::volume
