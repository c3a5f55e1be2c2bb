#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/fovea.h"
#include "effects/volume/limits.h"
#include "effects/volume/reconstruction.h"
#include "effects/volume/space.h"
#include "engine/core/log.h"
#include "engine/core/params.h"

namespace viscera::volume {

/// How a slab of the ray is integrated. `gauss`: two points, fourth order on smooth fields. `preintegrated`:
/// the value runs straight through the same two points and the transfer function is integrated exactly along
/// it, so that narrow peaks are not missed. `cell`: slabs end where the voxels' cells do, two points in each:
/// exact for line integrals of the linear filter.
enum class Scheme { midpoint, gauss, preintegrated, cell };
[[nodiscard]] std::span<const std::string_view> choice_names(Scheme scheme);

/// Where in its slab a ray begins: moves the lattice by a part of a slab, which turns wood grain into noise.
enum class Jitter { none, hash, blue_noise };
[[nodiscard]] std::span<const std::string_view> choice_names(Jitter jitter);

struct SamplingParams {
    double step = 0.5;
    Scheme scheme = Scheme::gauss;
    double termination = 1.0 / 512.0;
    double tolerance = 0.0;
    bool skip = true;
    Limits limits = Limits::analytic;
    Jitter jitter = Jitter::none;
    int seed = 0;
    std::optional<FoveaParams> fovea;
    ReconstructionParams reconstruction;

    void visit(ParamVisitor& v);
};

/// Slabs of one volume under one placement.
struct Lattice {
    double slab_mm = 1.0;  ///< length of a slab in the world
    double slab_voxels =
        0.5;  ///< the most voxels that a slab crosses along any axis, in any direction,
              ///< away from the fovea, too; curvilinear: not known, since it grows towards the axis
    double slab_local = 0.5;  ///< the most that a slab can be long in local coordinates
    int slab_limit = 1;       ///< slabs of a ray, or cells it crosses, are fewer
};

/// No ray turns its loops more often. llvmpipe stops loops after 65,535 turns in all without a word (the
/// software renderer's limit, counted over all loops of an invocation); leaping takes up to one more turn a
/// slab.
inline constexpr int most_slabs = 30000;

/// space: invertible. A step that would take more than most_slabs is made longer, with a fault in the log.
/// step_factor: of the frame's quality.
[[nodiscard]] Lattice make_lattice(const SamplingParams& params, const Space& space, Log& log,
                                   double step_factor = 1.0);

/// How far from its middle a slab's samples can lie, as a share of its length.
[[nodiscard]] double reach_share(const SamplingParams& params);
/// How far beyond its own brick a slab's samples can lie [voxels], without the filter's support; Cartesian.
[[nodiscard]] double reach(const SamplingParams& params, const Lattice& lattice);

/// How far a scheme goes beyond the values that it samples, as a share of their range.
[[nodiscard]] float overshoot(const SamplingParams& params);

/// Defines of the shader for scheme, jitter, termination and long slabs.
void add_defines(const SamplingParams& params, std::vector<std::string>& defines);

/// Void-and-cluster dither array (Ulichney, "The void-and-cluster method for dither array generation", 1993):
/// the numbers 0 to size^2 - 1, each once, so placed that every threshold leaves evenly spread points. size:
/// a power of two, 4 to 64.
[[nodiscard]] std::vector<std::uint16_t> blue_noise(int size, std::uint32_t seed);

}  // namespace viscera::volume
