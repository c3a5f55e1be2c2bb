#include "engine/core/transfer_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/finite.h"

namespace viscera {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The number inside [low, high]; counts where that changed it.
[[nodiscard]] double cut(double value, double low, double high, std::size_t& faults) {
    const double inside = std::clamp(value, low, high);
    faults += inside == value ? 0 : 1;
    return inside;
}

void cut_coefficient(double& value, double standard, double high, std::size_t& faults) {
    if (!finite(value)) {
        value = standard;
        ++faults;
        return;
    }
    value = cut(value, 0.0, high, faults);
}

void normalise_points(std::vector<TransferPoint>& points, std::size_t& faults) {
    faults += std::erase_if(points, [](const TransferPoint& p) {
        return !(finite(p.value) && finite(p.colour) && finite(p.opacity));
    });
    for (TransferPoint& p : points) {
        for (int c = 0; c < 3; ++c) {
            p.colour[c] = cut(p.colour[c], 0.0, 1.0, faults);
        }
        p.opacity = cut(p.opacity, 0.0, 1.0, faults);
    }
    std::ranges::stable_sort(points, {}, &TransferPoint::value);
    if (points.empty()) {
        points.emplace_back();
    }
}

void normalise_gradient(std::vector<GradientPoint>& points, std::size_t& faults) {
    faults += std::erase_if(points,
                            [](const GradientPoint& p) { return !(finite(p.gradient) && finite(p.factor)); });
    for (GradientPoint& p : points) {
        p.gradient = cut(p.gradient, 0.0, infinity, faults);
        p.factor = cut(p.factor, 0.0, 1.0, faults);
    }
    std::ranges::stable_sort(points, {}, &GradientPoint::gradient);
}

/// Where `value` lies between two knots, in [0, 1); low <= value < high.
[[nodiscard]] double fraction(double low, double high, double value) {
    const double width = high - low;
    // Knots at the two ends of the range of double are further apart than any double.
    return finite(width) ? (value - low) / width : (value / 2 - low / 2) / (high / 2 - low / 2);
}

}  // namespace

void TransferPoint::visit(ParamVisitor& v) {
    v.field({.name = "value", .doc = "value of the volume, in its own unit", .required = true}, value);
    v.field({.name = "colour", .doc = "red, green, blue, linear", .min = 0.0, .max = 1.0}, colour);
    v.field({.name = "opacity", .doc = "opacity per reference length", .min = 0.0, .max = 1.0}, opacity);
}

void GradientPoint::visit(ParamVisitor& v) {
    v.field({.name = "gradient",
             .doc = "magnitude of the gradient, in the volume's unit per mm",
             .min = 0.0,
             .required = true},
            gradient);
    v.field({.name = "factor", .doc = "factor on the opacity", .min = 0.0, .max = 1.0}, factor);
}

void Lighting::visit(ParamVisitor& v) {
    v.field({.name = "ambient", .doc = "share of the colour that needs no light", .min = 0.0, .max = 1.0},
            ambient);
    v.field({.name = "diffuse", .doc = "share of the light scattered to all sides", .min = 0.0, .max = 1.0},
            diffuse);
    v.field({.name = "specular", .doc = "strength of the highlight", .min = 0.0, .max = 1.0}, specular);
    v.field({.name = "shininess", .doc = "Blinn-Phong exponent of the highlight", .min = 0.0, .max = 1000.0},
            shininess);
}

void WindowLevel::visit(ParamVisitor& v) {
    v.field({.name = "width", .doc = "values from black to white", .min = 0.0, .min_excluded = true}, width);
    v.field({.name = "level", .doc = "value shown as middle grey"}, level);
}

std::span<const std::string_view> choice_names(Technique) {
    static constexpr std::array<std::string_view, 6> names{"composite", "mip",        "minip",
                                                           "average",   "isosurface", "xray"};
    return names;
}

TransferFunction normalised(TransferFunction function, std::size_t& faults) {
    normalise_points(function.points, faults);
    normalise_gradient(function.gradient, faults);
    if (!(finite(function.reference_length_mm) && function.reference_length_mm > 0.0)) {
        function.reference_length_mm = 1.0;
        ++faults;
    }
    const Lighting standard;
    Lighting& lighting = function.lighting;
    cut_coefficient(lighting.ambient, standard.ambient, 1.0, faults);
    cut_coefficient(lighting.diffuse, standard.diffuse, 1.0, faults);
    cut_coefficient(lighting.specular, standard.specular, 1.0, faults);
    cut_coefficient(lighting.shininess, standard.shininess, 1000.0, faults);
    return function;
}

glm::dvec4 evaluate(const TransferFunction& function, double value) {
    const std::vector<TransferPoint>& points = function.points;
    if (points.empty() || std::isnan(value)) {
        return glm::dvec4(0.0);
    }
    const auto right = std::ranges::upper_bound(points, value, {}, &TransferPoint::value);
    if (right == points.begin()) {
        return {right->colour, right->opacity};
    }
    const TransferPoint& a = *std::prev(right);
    const glm::dvec4 left(a.colour, a.opacity);
    if (right == points.end()) {
        return left;
    }
    const double t = fraction(a.value, right->value, value);
    return left * (1.0 - t) + glm::dvec4(right->colour, right->opacity) * t;
}

double extinction(double opacity, double reference_length_mm) {
    constexpr double most = 1.0 - 0x1p-24;
    constexpr double most_extinction = 1e30;  // times any length that is seen, a float still holds it
    return opacity > 0.0
               ? std::min(-std::log1p(-std::min(opacity, most)) / reference_length_mm, most_extinction)
               : 0.0;
}

TransferFunction make_window(const WindowLevel& window) {
    const double half = std::max(window.width, 0.0) / 2.0;
    TransferFunction function;
    function.points = {{window.level - half, glm::dvec3(0.0), 0.0},
                       {window.level + half, glm::dvec3(1.0), 1.0}};
    return function;
}

std::vector<ValueRange> visible_ranges(const TransferFunction& function) {
    const std::vector<TransferPoint>& points = function.points;
    std::vector<ValueRange> ranges;
    const auto add = [&](double low, double high) {
        if (!ranges.empty() && ranges.back().high >= low) {
            ranges.back().high = high;
        } else {
            ranges.push_back({low, high});
        }
    };
    if (points.empty()) {
        return ranges;
    }
    if (points.front().opacity > 0.0) {
        add(-infinity, points.front().value);
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
        const TransferPoint& a = points[i - 1];
        const TransferPoint& b = points[i];
        if (a.value < b.value && (a.opacity > 0.0 || b.opacity > 0.0)) {
            add(a.value, b.value);
        }
    }
    if (points.back().opacity > 0.0) {
        add(points.back().value, infinity);
    }
    return ranges;
}

}  // namespace viscera
