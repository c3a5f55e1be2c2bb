#include "effects/volume/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 4> scheme_names{"midpoint", "gauss", "preintegrated", "cell"};
constexpr std::array<std::string_view, 3> jitter_names{"none", "hash", "blue_noise"};
constexpr double gauss_point = 0.28867513459481287;  // 1 / (2 sqrt 3)

/// What a matrix makes of a vector of length 1 at most, from above; `bound`: the root of all elements
/// squared.
double longest_local(const glm::dmat3& m, double bound) {
    // The trace of a power of M^T M bounds that of its largest eigenvalue, the more closely the higher it is.
    glm::dmat3 power = glm::transpose(m / bound) * (m / bound);
    double exponent = 2.0;
    double scale = 1.0;
    for (int i = 0; i < 4; ++i) {
        const double size = power[0][0] + power[1][1] + power[2][2];
        power = (power / size) * (power / size);
        scale *= std::pow(size, 1.0 / exponent);
        exponent *= 2.0;
    }
    return bound * scale * std::pow(power[0][0] + power[1][1] + power[2][2], 1.0 / exponent);
}

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
             .doc = "Slabs are 4, 16 or 64 times as long where the transfer function changes so little that "
                    "colour and opacity err by no more than this; 0: nowhere.",
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
    v.field({.name = "fovea",
             .doc = "Longer steps away from where one looks; of no effect on cell and isosurface, which heed "
                    "no step."},
            fovea);
    v.field({.name = "seed", .doc = "Another jitter.", .min = 0, .max = 1e9}, seed);
    reconstruction.visit(v);
}

Lattice make_lattice(const SamplingParams& params, const Space& space, Log& log, double step_factor) {
    const glm::ivec3& dims = space.dims;
    const glm::dmat4 box = space.box_to_world();
    double diagonal = 0.0;
    for (int a = 0; a < 3; ++a) {
        diagonal += glm::length(glm::dvec3(box[a]));
    }
    // Two samples a slab everywhere but at midpoints, so that a step costs the same whatever the scheme.
    const double samples = params.scheme == Scheme::midpoint ? 1.0 : 2.0;
    Lattice lattice{.slab_mm = params.step * step_factor * voxel_spacing_mm(space) * samples};
    if (lattice.slab_mm * most_slabs < diagonal) {
        log.fault("volume.step", "the step would take more than " + std::to_string(most_slabs) +
                                     " slabs through the volume; it is made longer");
        lattice.slab_mm = diagonal / most_slabs;
    }
    // No ray is longer than the volume's sides together: whatever the step, a float holds the slab.
    lattice.slab_mm = std::min(lattice.slab_mm, diagonal);
    const double longest_mm =
        std::min(lattice.slab_mm * (params.fovea ? params.fovea->step_factor : 1.0), diagonal);
    // The local direction of a world direction is at most as long as the inverse's largest row says, and all
    // of it as the rows together.
    const glm::dmat3 to_local = glm::inverse(glm::dmat3(space.local_to_world));
    double longest = 0.0;
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3 row(to_local[0][a], to_local[1][a], to_local[2][a]);
        longest += glm::dot(row, row);
        const auto all = static_cast<double>(dims[a]);
        const double voxels = std::min(all, longest_mm * glm::length(row) * all);
        lattice.slab_voxels = std::max(a == 0 ? 0.0 : lattice.slab_voxels, voxels);
    }
    lattice.slab_local = longest_mm * longest_local(to_local, std::sqrt(longest));
    const int cells = dims.x + dims.y + dims.z + 8;
    lattice.slab_limit = params.scheme == Scheme::cell ? std::min(2 * cells, most_slabs) : most_slabs;
    return lattice;
}

double reach_share(const SamplingParams& params) {
    const double jitter = params.jitter == Jitter::none ? 0.0 : 0.5;
    switch (params.scheme) {
        case Scheme::midpoint:
            return jitter;
        case Scheme::gauss:
            return gauss_point + jitter;
        case Scheme::preintegrated:
        case Scheme::cell:
            return 0.5 + jitter;
    }
    return 0.0;
}

double reach(const SamplingParams& params, const Lattice& lattice) {
    return params.scheme == Scheme::cell ? 0.5 : reach_share(params) * lattice.slab_voxels;
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
    if (params.fovea && params.scheme != Scheme::cell) {
        defines.emplace_back("FOVEA");
    }
}

}  // namespace viscera::volume
