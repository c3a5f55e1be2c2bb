#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/volume_field.h"
#include "tests/reference/volume_medium.h"
#include "tests/reference/volume_profile.h"
#include "tests/reference/volume_ray.h"

// Ray functions by integration that has converged: the field along the ray is cut into polynomials
// (visit_pieces), those at the knots of the medium, and what is left is smooth. Nothing is sampled that could
// be missed: knots and iso values are found as roots.

namespace viscera::reference {

struct Quality {
    /// Error that composite and optical_depth keep below on rays of some ten cells; 1e-15 to 1e-3. It adds up
    /// along a ray: at 1e-11, 4e-12 was measured over 256^3 trilinear voxels and 2e-10 over tricubic ones.
    /// Time hardly depends on it: most pieces need one rule of five points whatever it is.
    double tolerance = 1e-11;
    /// composite stops where less than this is let through; 0 never stops.
    double stop_transmittance = 1e-14;
};

/// Emission and absorption along a ray: C = int kappa c exp(-tau) ds, T = exp(-tau).
struct Light {
    glm::dvec3 colour{0.0};  ///< C, premultiplied
    double transmittance = 1.0;

    [[nodiscard]] double alpha() const { return 1.0 - transmittance; }
    [[nodiscard]] glm::dvec4 rgba() const { return {colour, alpha()}; }
};

/// Adds a piece behind what is there. tau grows by int kappa ds over it.
void advance(Light& light, const Piece& piece, const Medium& medium, const Quality& quality = {});

/// Front to back from interval.begin.
[[nodiscard]] Light composite(const Field& field, const Ray& ray, const Interval& interval,
                              const Medium& medium, const Quality& quality = {});

/// int kappa ds. Where kappa is linear in the value between knots (Medium::attenuation) and the field is made
/// of voxels, the integral is exact: the rule of five points integrates degree 9.
[[nodiscard]] double optical_depth(const Field& field, const Ray& ray, const Interval& interval,
                                   const Medium& medium, const Quality& quality = {});
/// exp(-int mu ds).
[[nodiscard]] double xray(const Field& field, const Ray& ray, const Interval& interval, const Medium& mu,
                          const Quality& quality = {});

/// int f ds [value mm], exact for voxel fields.
[[nodiscard]] double line_integral(const Field& field, const Ray& ray, const Interval& interval);

/// Greatest value, interior extrema of each cell included. With an iso value: none unless it is reached.
[[nodiscard]] std::optional<double> maximum(const Field& field, const Ray& ray, const Interval& interval,
                                            std::optional<double> iso = {});
/// Least value of those >= iso (no iso: of all).
[[nodiscard]] std::optional<double> minimum(const Field& field, const Ray& ray, const Interval& interval,
                                            std::optional<double> iso = {});
/// Mean by length over where the value is >= iso (no iso: over all).
[[nodiscard]] std::optional<double> mean(const Field& field, const Ray& ray, const Interval& interval,
                                         std::optional<double> iso = {});

/// Where a ray passes through an iso-surface.
struct Crossing {
    double s_mm = 0.0;
    double iso = 0.0;
    glm::dvec3 texture{0.0};      ///< place in texture coordinates
    glm::dvec3 position_mm{0.0};  ///< place in the world
    glm::dvec3 gradient{0.0};     ///< of the filter, value per mm in the world
    glm::dvec3 normal{0.0};       ///< of length 1, towards lesser values; 0 where the gradient is 0
    bool rising = false;          ///< from below iso to iso or more, along the ray
};

/// The first place where the field passes between f < iso and f >= iso, in either direction. A ray that
/// begins at f >= iso has its first crossing where it leaves. A touch without passing is none, nor is the
/// end of the box.
[[nodiscard]] std::optional<Crossing> first_crossing(const Field& field, const Ray& ray,
                                                     const Interval& interval, double iso);
/// All crossings of all iso values, in order along the ray.
[[nodiscard]] std::vector<Crossing> crossings(const Field& field, const Ray& ray, const Interval& interval,
                                              std::span<const double> isos);
/// A crossing at a known place.
[[nodiscard]] Crossing crossing_at(const Field& field, const Ray& ray, double s_mm, double iso, bool rising);

}  // namespace viscera::reference
