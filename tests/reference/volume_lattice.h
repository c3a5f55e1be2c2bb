#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/volume_exact.h"

// Ray functions by samples on the lattice that shaders use, to compare a shader with sample for sample: the
// same definition in double precision, with the sampling error that both share.

namespace viscera::reference {

/// One sample's stretch of the ray.
struct Slab {
    double begin = 0.0;   ///< [mm]
    double end = 0.0;     ///< [mm]
    double sample = 0.0;  ///< where the field is taken: the middle [mm]

    [[nodiscard]] double length() const { return end - begin; }
};

/// Slabs of step_mm from the interval's begin: slab k is [k ds, (k+1) ds], sampled at (k + 0.5) ds. The last
/// one covers the rest [n ds, L] with its sample in the rest's middle; a rest shorter than 1e-9 ds is left
/// out (its length goes to the slab before). step_mm > 0.
[[nodiscard]] std::vector<Slab> slabs(const Interval& interval, double step_mm);

/// How a slab's light is found. h is its length.
/// midpoint: kappa and c at the middle; alpha = 1 - exp(-kappa h), C = alpha c. Order 2.
/// preintegrated: values at the slab's ends, the field linear between them, C and alpha of that exactly.
/// fourth_order: two Gauss points m -+ h / (2 sqrt 3), extinction linear through them. Order 4.
enum class Scheme { midpoint, preintegrated, fourth_order };

struct LatticeOptions {
    Scheme scheme = Scheme::midpoint;
    /// The march stops after the slab with which alpha exceeds this; 1: never.
    double stop_alpha = 1.0;
    /// Samples below this are dropped (midpoint and fourth_order; preintegrated takes no notice).
    std::optional<double> iso;
    /// Changes a sample's emission: lighting, a gradient axis. Not asked by preintegrated.
    std::function<Emission(const Emission&, double value, const glm::dvec3& texture, const Ray&)> shade;
};

/// Emission and absorption, front to back.
[[nodiscard]] Light composite_on_lattice(const Field& field, const Ray& ray, const Interval& interval,
                                         double step_mm, const Medium& medium,
                                         const LatticeOptions& options = {});
/// Light of one slab by itself.
[[nodiscard]] Light preintegrated_slab(double front_value, double back_value, double length_mm,
                                       const Medium& medium, const Quality& quality = {});
[[nodiscard]] Light fourth_order_slab(const Emission& first, const Emission& second, double length_mm);

/// exp(-sum mu ds): midpoint, or two Gauss points for fourth_order; preintegrated as in composite.
[[nodiscard]] double xray_on_lattice(const Field& field, const Ray& ray, const Interval& interval,
                                     double step_mm, const Medium& mu, Scheme scheme = Scheme::midpoint);

/// Extremes and mean of the samples that are >= iso (no iso: of all); none if there is no such sample. The
/// mean weighs each sample with its slab's length.
[[nodiscard]] std::optional<double> maximum_on_lattice(const Field& field, const Ray& ray,
                                                       const Interval& interval, double step_mm,
                                                       std::optional<double> iso = {});
[[nodiscard]] std::optional<double> minimum_on_lattice(const Field& field, const Ray& ray,
                                                       const Interval& interval, double step_mm,
                                                       std::optional<double> iso = {});
[[nodiscard]] std::optional<double> mean_on_lattice(const Field& field, const Ray& ray,
                                                    const Interval& interval, double step_mm,
                                                    std::optional<double> iso = {});

/// The first two neighbouring samples of which one is < iso and the other >= iso, then the root between them
/// by bisection to 1e-14 of the step. Misses what two crossings within one step hide, as a shader does.
/// The interval's own begin and end are not sampled.
[[nodiscard]] std::optional<Crossing> crossing_on_lattice(const Field& field, const Ray& ray,
                                                          const Interval& interval, double step_mm,
                                                          double iso);

/// Accumulation with one opacity: per slab a = alpha * opacity / samples (the last slab's a in proportion to
/// its length), C += (1 - A) a (v + brightness) contrast, A += (1 - A) a. Samples with a channel outside its
/// threshold are dropped.
struct Accumulate {
    double opacity = 1.0;
    double samples = 1.0;  ///< sampling rate: samples per ray, > 0
    double brightness = 0.0;
    double contrast = 1.0;
    glm::dvec4 low{-1e300};  ///< per channel, ends included
    glm::dvec4 high{1e300};
    double stop_alpha = 1.0;
    /// What a place looks like: changes the colour and, per slab, the opacity. Called with the world's mm.
    std::function<void(glm::dvec3& colour, double& opacity, const glm::dvec3& world_mm)> look;
};
/// One field per channel, all with the same box. 1 channel v: colour (v, v, v), alpha v. 2 (v, a): colour
/// (v, v, v), alpha a. 3 (r, g, b): alpha (r + g + b) / 3. 4: RGBA. alpha is clamped to [0, 1].
[[nodiscard]] glm::dvec4 accumulate(std::span<const Field> channels, const Ray& ray, const Interval& interval,
                                    double step_mm, const Accumulate& rule);

/// Composition with one density for everything that is seen: samples v >= iso give the transfer
/// function's colour c(v * scale) and, where its opacity is not 0, a = 1 - (1 - density)^(ds / reference);
/// C += (1 - A) a c; A += (1 - A) a; last, C *= brightness.
struct Density {
    double density = 0.05;  ///< [0, 1) per reference length
    double reference_length_mm = 0.001;
    double scale = 1.0;
    double iso = -1e300;
    double brightness = 1.0;
    double stop_alpha = 1.0;
};
[[nodiscard]] glm::dvec4 density(const Field& field, const Ray& ray, const Interval& interval, double step_mm,
                                 const TransferFunction& function, const Density& rule);

}  // namespace viscera::reference
