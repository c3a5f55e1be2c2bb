#pragma once

#include <cstddef>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/params.h"

namespace viscera::contrast {

struct BolusPoint {
    double time_s = 0.0;   ///< since the injection began
    double density = 0.0;  ///< in [0, 1]

    void visit(ParamVisitor& v);
};

/// What is injected, as the scene gives it.
struct BolusParams {
    double start_s = 0.0;     ///< scene time at which the injection begins
    double duration_s = 2.0;  ///< from the beginning of the injection to the beginning of the wash-out
    double rise_s = 0.3;
    double amplitude = 1.0;
    double washout_s = 0.6;  ///< time constant of the exponential decay
    std::vector<BolusPoint> table{};

    void visit(ParamVisitor& v);
};

/// Density range, lower <= upper, in [0, 1].
struct DensityRange {
    double lower = 0.0;
    double upper = 0.0;
};

/// A table of points brought to equal steps for the GPU: a texture of table_samples x 1 texels (r32f). Sample
/// i stands at first_s + i step_s. Read it with two texelFetch and a mix of its own, because hardware filter
/// weights have as few as 8 bits:
///
///     float u = (x - first_s) * inv_step;   // x: seconds since arrival
///     if (u < 0.0) density = 0.0;
///     u = min(u, float(table_samples - 1)); int i = min(int(u), table_samples - 2);
///     density = mix(sample[i], sample[i + 1], u - float(i));
///
/// Before the first point the density is 0; after the last, the last value stays.
struct BolusTable {
    double first_s = 0.0;
    double step_s = 1.0;
    std::vector<float> samples;  ///< table_samples values in [0, 1], or empty: no table
};
inline constexpr std::size_t table_samples = 1024;

/// Density as a function of the time since the contrast's first arrival, `x = t - start - tau`.
///
/// Without a table, with u = clamp(x / rise, 0, 1) and y = max(0, x - duration):
///
///     density(x) = amplitude * u u (3 - 2 u) * max(0, (exp(-y / washout) - cut) / (1 - cut))
///
/// cut = 2^-12 ends the tail exactly, 8.32 washout after the plateau, where the picture (a S(a), about 2 a^2)
/// is below what half a float can hold; only so can a frame after the wash-out be skipped. In GLSL, with the
/// members of Bolus::Uniforms:
///
///     float u = clamp(x * inv_rise, 0.0, 1.0);
///     float tail = max(0.0, exp(-max(0.0, x - duration) * inv_washout) * tail_scale - tail_offset);
///     float a = amplitude * (u * u * (3.0 - 2.0 * u)) * tail;
///
/// Form x = (t - start) - tau per VERTEX and interpolate x: near the front x is small, so the rounding of
/// the interpolation is small too, however late tau is.
class Bolus {
  public:
    /// Uniforms of the closed form, rounded once.
    struct Uniforms {
        float amplitude = 0.0F;
        float inv_rise = 0.0F;
        float duration = 0.0F;
        float inv_washout = 0.0F;
        float tail_scale = 0.0F;
        float tail_offset = 0.0F;
    };

    /// Points of a table are sorted by time; points that are not finite are dropped, densities outside [0, 1]
    /// clamped, and both counted under "contrast.bolus_table". Throws Error(scene) where rise or wash-out is
    /// not > 0, or a number is not finite.
    Bolus(const BolusParams& params, Log& log);

    /// Density in [0, 1]; NaN gives 0.
    [[nodiscard]] double density(double since_arrival_s) const;
    /// Bounds of the density over times since arrival in [first_s, last_s]. The lower bound is attained; the
    /// upper is attained wherever duration >= rise, and in a table.
    [[nodiscard]] DensityRange range(double first_s, double last_s) const;
    /// Whether the density is exactly 0 throughout [first_s, last_s]: for arrival times in [tau0, tau1] at
    /// time t, `zero_on(t - start - tau1, t - start - tau0)`. NaN counts as zero.
    [[nodiscard]] bool zero_on(double first_s, double last_s) const;

    [[nodiscard]] double start_s() const { return params_.start_s; }
    [[nodiscard]] const Uniforms& uniforms() const { return uniforms_; }
    [[nodiscard]] const BolusTable& table() const { return table_; }

  private:
    [[nodiscard]] double rise(double x) const;
    [[nodiscard]] double tail(double x) const;

    BolusParams params_;
    Uniforms uniforms_;
    BolusTable table_;
};

}  // namespace viscera::contrast
