#include "effects/contrast/bolus.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace viscera::contrast {
namespace {

constexpr double cut = 1.0 / 4096.0;

// Piecewise linear through points sorted by time; 0 before the first, the last value after the last.
double interpolate(const std::vector<BolusPoint>& points, double time_s) {
    const auto after = std::ranges::upper_bound(points, time_s, {}, &BolusPoint::time_s);
    if (after == points.begin()) {
        return 0.0;
    }
    const BolusPoint& a = *(after - 1);
    if (after == points.end()) {
        return a.density;
    }
    return std::lerp(a.density, after->density, (time_s - a.time_s) / (after->time_s - a.time_s));
}

BolusTable sample_table(std::vector<BolusPoint> points, Log& log) {
    const std::size_t given = points.size();
    std::erase_if(points,
                  [](const BolusPoint& p) { return !std::isfinite(p.time_s) || !std::isfinite(p.density); });
    std::uint64_t faults = given - points.size();
    for (BolusPoint& p : points) {
        const double clamped = std::clamp(p.density, 0.0, 1.0);
        faults += clamped != p.density ? 1 : 0;
        p.density = clamped;
    }
    if (faults > 0) {
        log.fault("contrast.bolus_table",
                  "bolus table has points that are not finite (dropped) or lie outside [0, 1] (clamped)",
                  faults);
    }
    BolusTable table;
    if (points.empty()) {
        if (given > 0) {
            table.samples.assign(table_samples, 0.0F);
        }
        return table;
    }
    std::ranges::stable_sort(points, {}, &BolusPoint::time_s);
    table.first_s = points.front().time_s;
    const double length_s = points.back().time_s - table.first_s;
    table.step_s = length_s > 0.0 ? length_s / static_cast<double>(table_samples - 1) : 1.0;
    table.samples.resize(table_samples);
    for (std::size_t i = 0; i < table_samples; ++i) {
        table.samples[i] =
            static_cast<float>(interpolate(points, table.first_s + table.step_s * static_cast<double>(i)));
    }
    table.samples.back() = static_cast<float>(points.back().density);
    return table;
}

double sample(const BolusTable& table, double x) {
    const double position = (x - table.first_s) / table.step_s;
    if (!(position >= 0.0)) {
        return 0.0;
    }
    const double u = std::min(position, static_cast<double>(table_samples - 1));
    const std::size_t i = std::min(static_cast<std::size_t>(u), table_samples - 2);
    const double weight = u - static_cast<double>(i);
    return (1.0 - weight) * static_cast<double>(table.samples[i]) +
           weight * static_cast<double>(table.samples[i + 1]);
}

DensityRange table_range(const BolusTable& table, double first_s, double last_s) {
    const double a = sample(table, first_s);
    const double b = sample(table, last_s);
    DensityRange range{std::min(a, b), std::max(a, b)};
    const double from = (first_s - table.first_s) / table.step_s;
    const double to = (last_s - table.first_s) / table.step_s;
    const double last_index = static_cast<double>(table_samples - 1);
    if (!(to >= 0.0) || !(from <= last_index)) {
        return range;
    }
    const auto begin = static_cast<std::size_t>(std::ceil(std::clamp(from, 0.0, last_index)));
    const auto end = static_cast<std::size_t>(std::floor(std::clamp(to, 0.0, last_index)));
    for (std::size_t i = begin; i <= end; ++i) {
        range.lower = std::min(range.lower, static_cast<double>(table.samples[i]));
        range.upper = std::max(range.upper, static_cast<double>(table.samples[i]));
    }
    return range;
}

/// Finite for every positive value: infinity times 0 would be no number.
float inverse(double seconds) {
    constexpr double largest = 1e30;
    return static_cast<float>(std::min(1.0 / seconds, largest));
}

}  // namespace

void BolusPoint::visit(ParamVisitor& v) {
    v.field({.name = "time_s", .doc = "Time since the injection began.", .unit = "s", .required = true},
            time_s);
    v.field(
        {.name = "density", .doc = "Contrast density at that time.", .min = 0, .max = 1, .required = true},
        density);
}

void BolusParams::visit(ParamVisitor& v) {
    v.field({.name = "start_s", .doc = "Scene time at which the injection begins.", .unit = "s"}, start_s);
    v.field({.name = "duration_s",
             .doc = "From the beginning of the injection to the beginning of the wash-out.",
             .unit = "s",
             .min = 0},
            duration_s);
    v.field({.name = "rise_s",
             .doc = "Time in which the density rises from 0 to the plateau.",
             .unit = "s",
             .min = 0,
             .min_excluded = true},
            rise_s);
    v.field({.name = "amplitude", .doc = "Density of the plateau.", .min = 0, .max = 1}, amplitude);
    v.field({.name = "washout_s",
             .doc = "Time constant of the exponential decay after the plateau.",
             .unit = "s",
             .min = 0,
             .min_excluded = true},
            washout_s);
    v.field(
        {.name = "table",
         .doc = "Density over time, joined by straight lines; takes the place of rise, plateau and decay."},
        table);
}

Bolus::Bolus(const BolusParams& params, Log& log) : params_(params) {
    for (const double value :
         {params.start_s, params.duration_s, params.rise_s, params.amplitude, params.washout_s}) {
        if (!std::isfinite(value)) {
            throw Error(ErrorCode::scene, "bolus", "a number is not finite");
        }
    }
    if (!(params.rise_s > 0.0) || !(params.washout_s > 0.0)) {
        throw Error(ErrorCode::scene, "bolus", "rise_s and washout_s must be > 0");
    }
    params_.amplitude = std::clamp(params.amplitude, 0.0, 1.0);
    table_ = sample_table(params.table, log);
    uniforms_ = {.amplitude = static_cast<float>(params_.amplitude),
                 .inv_rise = inverse(params_.rise_s),
                 .duration = static_cast<float>(params_.duration_s),
                 .inv_washout = inverse(params_.washout_s),
                 .tail_scale = static_cast<float>(1.0 / (1.0 - cut)),
                 .tail_offset = static_cast<float>(cut / (1.0 - cut))};
}

double Bolus::rise(double x) const {
    const double u = std::clamp(x / params_.rise_s, 0.0, 1.0);
    return u * u * (3.0 - 2.0 * u);
}

double Bolus::tail(double x) const {
    const double y = std::max(0.0, x - params_.duration_s);
    return std::max(0.0, (std::exp(-y / params_.washout_s) - cut) / (1.0 - cut));
}

double Bolus::density(double since_arrival_s) const {
    if (std::isnan(since_arrival_s)) {
        return 0.0;
    }
    if (!table_.samples.empty()) {
        return sample(table_, since_arrival_s);
    }
    return params_.amplitude * rise(since_arrival_s) * tail(since_arrival_s);
}

DensityRange Bolus::range(double first_s, double last_s) const {
    if (!(first_s <= last_s)) {
        return {};
    }
    if (!table_.samples.empty()) {
        return table_range(table_, first_s, last_s);
    }
    // The curve rises, then falls: its least value lies at an end. rise grows and tail shrinks, so their
    // largest values bound the product.
    return {std::min(density(first_s), density(last_s)), params_.amplitude * rise(last_s) * tail(first_s)};
}

bool Bolus::zero_on(double first_s, double last_s) const {
    return range(first_s, last_s).upper <= 0.0;
}

}  // namespace viscera::contrast
