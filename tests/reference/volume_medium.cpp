#include "tests/reference/volume_medium.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace viscera::reference {
namespace {

constexpr double full_opacity = 1.0 - 0x1p-24;

}  // namespace

Medium::Medium(const TransferFunction& function) : reference_length_mm_(function.reference_length_mm) {
    const std::vector<TransferPoint>& points = function.points;
    if (points.empty()) {
        segments_.push_back({.clear = true});
        return;
    }
    const auto constant = [](const TransferPoint& p) {
        return Segment{p.value, p.opacity, 0.0, p.colour, glm::dvec3(0.0), !(p.opacity > 0.0)};
    };
    segments_.push_back(constant(points.front()));
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const TransferPoint& a = points[i];
        const TransferPoint& b = points[i + 1];
        const double width = b.value - a.value;
        if (!(width > 0.0)) {
            continue;
        }
        const Segment segment{a.value,
                              a.opacity,
                              (b.opacity - a.opacity) / width,
                              a.colour,
                              (b.colour - a.colour) / width,
                              !(a.opacity > 0.0) && !(b.opacity > 0.0)};
        knots_.push_back(a.value);
        segments_.push_back(segment);
        // Full opacity is cut just below 1, which makes a kink of its own, and before that the logarithm
        // grows steep. Knots at opacities 1/2, 3/4, 7/8... keep it tame between each two of them.
        std::vector<double> grades;
        for (int k = 1; k <= 24; ++k) {
            const double share = (1.0 - std::ldexp(1.0, -k) - a.opacity) / (b.opacity - a.opacity);
            if (share > 0.0 && share < 1.0) {
                grades.push_back(a.value + share * width);
            }
        }
        std::ranges::sort(grades);
        for (const double grade : grades) {
            if (grade > knots_.back() && grade < b.value) {
                knots_.push_back(grade);
                segments_.push_back(segment);
            }
        }
    }
    knots_.push_back(points.back().value);
    segments_.push_back(constant(points.back()));
}

Medium::Medium(std::vector<double> knots, Law law) : knots_(std::move(knots)), law_(std::move(law)) {}

Medium Medium::attenuation(double slope, double intercept) {
    std::vector<double> knots;
    if (slope != 0.0) {
        knots.push_back(-intercept / slope);
    }
    return {std::move(knots), [slope, intercept](double value) {
                return Emission{std::max(0.0, slope * value + intercept), glm::dvec3(0.0)};
            }};
}

std::size_t Medium::segment_of(double value) const {
    if (std::isnan(value)) {
        return 0;
    }
    return static_cast<std::size_t>(std::ranges::upper_bound(knots_, value) - knots_.begin());
}

Emission Medium::at(double value, std::size_t segment) const {
    if (law_) {
        return law_(value);
    }
    const Segment& s = segments_[segment];
    if (s.clear) {
        return {};
    }
    const double offset = value - s.origin;
    const double opacity = std::clamp(s.opacity + s.opacity_slope * offset, 0.0, full_opacity);
    return {-std::log1p(-opacity) / reference_length_mm_, s.colour + s.colour_slope * offset};
}

Emission Medium::at(double value) const {
    return std::isnan(value) ? Emission{} : at(value, segment_of(value));
}

bool Medium::transparent(std::size_t first, std::size_t last) const {
    if (law_) {
        return false;
    }
    for (std::size_t i = first; i <= last; ++i) {
        if (!segments_[i].clear) {
            return false;
        }
    }
    return true;
}

Medium ct_attenuation(double mu_water_per_mm) {
    return Medium::attenuation(mu_water_per_mm / 1000.0, mu_water_per_mm);
}

double gradient_factor(const TransferFunction& function, double gradient_per_mm) {
    const std::vector<GradientPoint>& points = function.gradient;
    if (points.empty()) {
        return 1.0;
    }
    const auto above = std::ranges::upper_bound(points, gradient_per_mm, {}, &GradientPoint::gradient);
    if (above == points.begin()) {
        return points.front().factor;
    }
    if (above == points.end()) {
        return points.back().factor;
    }
    const GradientPoint& below = *std::prev(above);
    const double share = (gradient_per_mm - below.gradient) / (above->gradient - below.gradient);
    return below.factor + share * (above->factor - below.factor);
}

}  // namespace viscera::reference
