#include "effects/volume/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 4> scheme_names{"midpoint", "gauss", "preintegrated", "cell"};
constexpr std::array<std::string_view, 3> jitter_names{"none", "hash", "blue_noise"};
constexpr double gauss_point = 0.28867513459481287;  // 1 / (2 sqrt 3)

}  // namespace

std::span<const std::string_view> choice_names(Scheme) {
    return scheme_names;
}
std::span<const std::string_view> choice_names(Jitter) {
    return jitter_names;
}

void SamplingParams::visit(ParamVisitor& v) {
    v.field({.name = "step",
             .doc = "Mean distance of samples in units of the smallest voxel spacing.",
             .unit = "voxel",
             .min = 0.0,
             .min_excluded = true},
            step);
    v.field({.name = "scheme",
             .doc = "How a slab of the ray is integrated; cell heeds no step, it goes from voxel to voxel."},
            scheme);
    v.field({.name = "termination",
             .doc = "A ray stops when less than this of what lies behind could still be seen, which bounds "
                    "the error; 0: "
                    "never.",
             .min = 0.0,
             .max = 1.0},
            termination);
    v.field({.name = "tolerance",
             .doc = "Slabs are four times as long where the transfer function changes so little that colour "
                    "and opacity err "
                    "by no more than this; 0: nowhere.",
             .min = 0.0,
             .max = 1.0},
            tolerance);
    v.field({.name = "skip", .doc = "Leaps over bricks that cannot show anything; the picture is the same."},
            skip);
    v.field(
        {.name = "limits",
         .doc = "Where rays begin and end: at the box's planes; two_pass: as volume.entry and volume.exit "
                "have drawn it; mesh: the same, within the box."},
        limits);
    v.field(
        {.name = "jitter", .doc = "Moves each ray's samples by a part of a slab, the same in every frame."},
        jitter);
    v.field({.name = "seed", .doc = "Another jitter.", .min = 0, .max = 1e9}, seed);
    reconstruction.visit(v);
}

Lattice make_lattice(const SamplingParams& params, const glm::dmat4& texture_to_world, const glm::ivec3& dims,
                     Log& log, double step_factor) {
    double spacing = 1e300;
    double diagonal = 0.0;
    for (int a = 0; a < 3; ++a) {
        const double length = glm::length(glm::dvec3(texture_to_world[a]));
        spacing = std::min(spacing, length / static_cast<double>(dims[a]));
        diagonal += length;
    }
    // Two samples a slab everywhere but at midpoints, so that a step costs the same whatever the scheme.
    const double samples = params.scheme == Scheme::midpoint ? 1.0 : 2.0;
    Lattice lattice{.slab_mm = params.step * step_factor * spacing * samples};
    if (lattice.slab_mm * most_slabs < diagonal) {
        log.fault("volume.step", "the step would take more than " + std::to_string(most_slabs) +
                                     " slabs through the volume; it is made longer");
        lattice.slab_mm = diagonal / most_slabs;
    }
    // No ray is longer than the volume's sides together: whatever the step, a float holds the slab.
    lattice.slab_mm = std::min(lattice.slab_mm, diagonal);
    // The texture direction of a world direction is at most as long as the inverse's largest row says.
    const glm::dmat3 to_texture = glm::inverse(glm::dmat3(texture_to_world));
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3 row(to_texture[0][a], to_texture[1][a], to_texture[2][a]);
        const auto all = static_cast<double>(dims[a]);
        const double voxels = std::min(all, lattice.slab_mm * glm::length(row) * all);
        lattice.slab_voxels = std::max(a == 0 ? 0.0 : lattice.slab_voxels, voxels);
    }
    const int cells = dims.x + dims.y + dims.z + 8;
    lattice.slab_limit = params.scheme == Scheme::cell ? std::min(2 * cells, most_slabs) : most_slabs;
    return lattice;
}

double reach(const SamplingParams& params, const Lattice& lattice) {
    switch (params.scheme) {
        case Scheme::midpoint:
            return params.jitter == Jitter::none ? 0.0 : 0.5 * lattice.slab_voxels;
        case Scheme::gauss:
            return (gauss_point + (params.jitter == Jitter::none ? 0.0 : 0.5)) * lattice.slab_voxels;
        case Scheme::preintegrated:
            return (params.jitter == Jitter::none ? 0.5 : 1.0) * lattice.slab_voxels;
        case Scheme::cell:
            return 0.5;
    }
    return 0.0;
}

float overshoot(const SamplingParams& params) {
    // A line through values at +-1 / (2 sqrt 3) goes on to +-1/2: (sqrt 3 - 1) / 2 of their difference on
    // each side.
    return params.scheme == Scheme::preintegrated ? 0.3661F : 0.0F;
}

void add_defines(const SamplingParams& params, std::vector<std::string>& defines) {
    defines.push_back("SCHEME " + std::to_string(static_cast<int>(params.scheme)));
    if (params.termination > 0.0) {
        defines.emplace_back("TERMINATE");
    }
    if (params.jitter != Jitter::none && params.scheme != Scheme::cell) {
        defines.push_back("JITTER " + std::to_string(static_cast<int>(params.jitter)));
    }
}

}  // namespace viscera::volume
