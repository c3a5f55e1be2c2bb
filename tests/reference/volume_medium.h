#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/transfer_function.h"

namespace viscera::reference {

/// What a value of the field emits and absorbs: radiance per mm is extinction * colour.
struct Emission {
    double extinction = 0.0;  ///< [1/mm]
    glm::dvec3 colour{0.0};
};

/// Emission over value, smooth between its knots. Segment i lies between knots i - 1 and i; segments 0 and
/// knots().size() reach to infinity. At a knot the segment to its right holds.
class Medium {
  public:
    using Law = std::function<Emission(double value)>;

    /// Colour and opacity A0 linear between points, constant beyond the ends; extinction
    /// -log1p(-min(A0, 1 - 2^-24)) / reference_length_mm. Points ascending, values finite; of several points
    /// at one value the first holds on its left and the last on its right. No points: transparent. The
    /// gradient axis is left out (LatticeOptions::shade can apply it). Besides the points' values, knots lie
    /// at opacities 1 - 2^-k, k = 1..24, where the logarithm would be too steep for one smooth stretch.
    explicit Medium(const TransferFunction& function);
    /// Any law, smooth between `knots` (ascending).
    Medium(std::vector<double> knots, Law law);
    /// Attenuation max(0, slope value + intercept) [1/mm] without light of its own.
    static Medium attenuation(double slope, double intercept);

    [[nodiscard]] const std::vector<double>& knots() const { return knots_; }
    /// Number of knots <= value; NaN: 0.
    [[nodiscard]] std::size_t segment_of(double value) const;
    /// The law of one segment, continued beyond its ends. A law given as a function is asked as it is.
    [[nodiscard]] Emission at(double value, std::size_t segment) const;
    /// NaN: transparent.
    [[nodiscard]] Emission at(double value) const;
    /// True where the segments first to last have no extinction at all.
    [[nodiscard]] bool transparent(std::size_t first, std::size_t last) const;

  private:
    struct Segment {
        double origin = 0.0;  ///< a value of the segment
        double opacity = 0.0;
        double opacity_slope = 0.0;
        glm::dvec3 colour{0.0};
        glm::dvec3 colour_slope{0.0};
        bool clear = false;
    };
    std::vector<double> knots_;
    std::vector<Segment> segments_;  ///< of a transfer function
    Law law_;                        ///< otherwise
    double reference_length_mm_ = 1.0;
};

/// mu = mu_water (1 + HU / 1000), never negative: attenuation of CT numbers [1/mm].
[[nodiscard]] Medium ct_attenuation(double mu_water_per_mm);

/// Factor on the opacity by gradient magnitude [value per mm]: linear between points, constant beyond the
/// ends, 1 without points. The opacity per reference length becomes factor * A0.
[[nodiscard]] double gradient_factor(const TransferFunction& function, double gradient_per_mm);

}  // namespace viscera::reference
