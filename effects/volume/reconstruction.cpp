#include "effects/volume/reconstruction.h"

#include <array>

#include "effects/volume/bricks.h"

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 8> filter_names{"automatic",   "nearest",         "linear",
                                                       "linear_fp32", "bspline",         "bspline_fp32",
                                                       "catmull_rom", "catmull_rom_fp32"};
constexpr std::array<std::string_view, 8> filter_defines{"",
                                                         "FILTER_NEAREST",
                                                         "",
                                                         "FILTER_LINEAR_FP32",
                                                         "FILTER_BSPLINE",
                                                         "FILTER_BSPLINE_FP32",
                                                         "FILTER_CATMULL_ROM",
                                                         "FILTER_CATMULL_ROM_FP32"};
constexpr std::array<std::string_view, 4> gradient_names{"automatic", "central", "analytic", "precomputed"};

bool is_bspline(ReconstructionFilter filter) {
    return filter == ReconstructionFilter::bspline || filter == ReconstructionFilter::bspline_fp32;
}

bool is_catmull_rom(ReconstructionFilter filter) {
    return filter == ReconstructionFilter::catmull_rom || filter == ReconstructionFilter::catmull_rom_fp32;
}

bool is_cubic(ReconstructionFilter filter) {
    return is_bspline(filter) || is_catmull_rom(filter);
}

}  // namespace

std::span<const std::string_view> choice_names(ReconstructionFilter) {
    return filter_names;
}
std::span<const std::string_view> choice_names(GradientKind) {
    return gradient_names;
}

void ReconstructionParams::visit(ParamVisitor& v) {
    v.field(
        {.name = "filter",
         .doc = "How the volume is reconstructed between its voxels; fp32: with weights of full precision "
                "instead of the texture unit's; automatic: linear, or nearest where the transfer function's "
                "file asks for it."},
        filter);
    v.field({.name = "prefilter",
             .doc = "B-splines pass through the voxels (fourth order) instead of smoothing them."},
            prefilter);
    v.field(
        {.name = "gradient",
         .doc = "Central difference of one voxel to either side, or the filter's own derivative; "
                "automatic: central for nearest and linear; precomputed: central ones kept for all voxels, "
                "8 bytes each, for linear filters."},
        gradient);
}

bool ReconstructionParams::uses_coefficients() const {
    return prefilter && is_bspline(filter);
}

bool ReconstructionParams::is_tricubic() const {
    return is_cubic(filter);
}

gl::Filter ReconstructionParams::texture_filter(bool nearest_wanted) const {
    if (filter == ReconstructionFilter::automatic) {
        return nearest_wanted ? gl::Filter::nearest : gl::Filter::linear;
    }
    const bool by_texture_unit = filter == ReconstructionFilter::linear ||
                                 filter == ReconstructionFilter::bspline ||
                                 filter == ReconstructionFilter::catmull_rom;
    return by_texture_unit ? gl::Filter::linear : gl::Filter::nearest;
}

double ReconstructionParams::support_voxels() const {
    return is_cubic(filter) ? 1.5 : 0.5;
}

float ReconstructionParams::overshoot() const {
    return is_catmull_rom(filter) ? catmull_rom_overshoot : 0.0F;
}

std::vector<std::string> ReconstructionParams::defines() const {
    std::vector<std::string> result;
    if (const std::string_view define = filter_defines.at(static_cast<std::size_t>(filter));
        !define.empty()) {
        result.emplace_back(define);
    }
    if (gradient == GradientKind::central || keeps_gradients() ||
        (gradient == GradientKind::automatic && !is_cubic(filter))) {
        result.emplace_back("GRADIENT_CENTRAL");
    }
    if (keeps_gradients()) {
        result.emplace_back("GRADIENT_KEPT");
    }
    return result;
}

}  // namespace viscera::volume
