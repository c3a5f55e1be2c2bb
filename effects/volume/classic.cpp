#include "effects/volume/classic.h"

#include <algorithm>

#include "engine/core/error.h"

namespace viscera::volume {

void AccumulateParams::visit(ParamVisitor& v) {
    v.field({.name = "opacity", .doc = "Factor on the opacity.", .min = 0.0}, opacity);
    v.field({.name = "samples",
             .doc = "Samples along the box's diagonal that the opacity is shared among.",
             .min = 1.0},
            samples);
    v.field({.name = "brightness", .doc = "Added to the value."}, brightness);
    v.field({.name = "contrast", .doc = "Factor on the value with brightness."}, contrast);
    v.field({.name = "threshold",
             .doc = "Least and greatest value that is shown, as shares of the volume's range.",
             .min = 0.0,
             .max = 1.0},
            threshold);
    v.field(
        {.name = "channels",
         .doc = "Takes the volume's colours as they are, one entry for each of its 2 to 4 channels: grey and "
                "opacity; red, green and blue, whose mean is the opacity; or these and opacity."},
        channels);
}

void AccumulateParams::Channel::visit(ParamVisitor& v) {
    v.field(
        {.name = "threshold",
         .doc = "Least and greatest value that is shown, as shares of the range of all channels; what leaves "
                "that of any channel is dropped.",
         .min = 0.0,
         .max = 1.0},
        threshold);
}

void AccumulateParams::validate() const {
    if (channels.size() == 1 || channels.size() > 4) {
        throw Error(ErrorCode::scene, "/accumulate/channels",
                    "colours have 2, 3 or 4 channels; volume.channel names a single one");
    }
}

void DensityParams::visit(ParamVisitor& v) {
    v.field({.name = "density",
             .doc = "Opacity of everything that is seen, per reference length.",
             .min = 0.0,
             .max = 1.0},
            density);
    v.field({.name = "reference_length_mm",
             .doc = "Length that the density is given for.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            reference_length_mm);
    v.field({.name = "scale",
             .doc = "Factor on values before the transfer function.",
             .min = 0.0,
             .min_excluded = true},
            scale);
    v.field({.name = "iso", .doc = "Values below it are dropped."}, iso);
    v.field({.name = "brightness", .doc = "Factor on the colours.", .min = 0.0}, brightness);
}

TransferFunction accumulate_function(const AccumulateParams& params, double low, double high,
                                     double diagonal_mm) {
    TransferFunction function{.reference_length_mm = diagonal_mm / params.samples};
    const auto at = [&](double share, bool seen) {
        const double grey = std::clamp((share + params.brightness) * params.contrast, 0.0, 1.0);
        const double opacity = std::clamp(share * params.opacity / params.samples, 0.0, 1.0);
        function.points.push_back({low + share * (high - low), glm::dvec3(grey), seen ? opacity : 0.0});
    };
    if (params.threshold.x > params.threshold.y) {
        at(0.0, false);
        return function;
    }
    // Where colour or opacity reaches its end, the ramp has a knot.
    std::vector<double> shares{params.threshold.x, params.threshold.y};
    for (const double grey : {0.0, 1.0}) {
        shares.push_back(params.contrast != 0.0 ? grey / params.contrast - params.brightness : 0.0);
    }
    shares.push_back(params.opacity > 0.0 ? params.samples / params.opacity : 1.0);
    std::ranges::sort(shares);
    if (params.threshold.x > 0.0) {
        at(params.threshold.x, false);
    }
    for (const double share : shares) {
        if (share >= params.threshold.x && share <= params.threshold.y) {
            at(share, true);
        }
    }
    if (params.threshold.y < 1.0) {
        at(params.threshold.y, false);
    }
    return function;
}

TransferFunction density_function(const TransferFunction& function, const DensityParams& params) {
    TransferFunction result = function;
    result.points.clear();
    result.reference_length_mm = params.reference_length_mm;
    const double least = params.iso.value_or(-1e300);
    const auto add = [&](double value, const glm::dvec3& colour, bool seen) {
        result.points.push_back(
            {value, glm::min(colour * params.brightness, glm::dvec3(1.0)), seen ? params.density : 0.0});
    };
    /// A stretch of the function's values in which something or nothing is seen.
    const auto stretch = [&](double from, double to, bool seen) {
        from = std::max(from, least * params.scale);
        if (from < to) {
            add(from / params.scale, glm::dvec3(evaluate(function, from)), seen);
            // The left side's colour at a step.
            const auto right = std::ranges::lower_bound(function.points, to, {}, &TransferPoint::value);
            add(to / params.scale,
                right == function.points.end() ? glm::dvec3(evaluate(function, to)) : right->colour, seen);
        }
    };
    const std::vector<TransferPoint>& points = function.points;
    const double first = points.front().value;
    const double last = points.back().value;
    if (params.iso) {
        add(least, glm::dvec3(evaluate(function, least * params.scale)), false);
    }
    stretch(first - 1.0, first, points.front().opacity > 0.0);
    for (std::size_t i = 1; i < points.size(); ++i) {
        stretch(points[i - 1].value, points[i].value, points[i - 1].opacity > 0.0 || points[i].opacity > 0.0);
    }
    stretch(std::max(last, least * params.scale), std::max(last, least * params.scale) + 1.0,
            points.back().opacity > 0.0);
    return result;
}

}  // namespace viscera::volume
