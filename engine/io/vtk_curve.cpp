#include "engine/io/vtk_curve.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace viscera::io {
namespace {

constexpr double tolerance = 2.5e-4;
constexpr int most_halvings = 14;

/// Share of the end's value at t in [0, 1], for sharpness below 1; by the definition of VTK's node shapes.
double blend(double t, double midpoint, double sharpness) {
    double s = t < midpoint ? 0.5 * t / midpoint : 0.5 + 0.5 * (t - midpoint) / (1.0 - midpoint);
    if (sharpness < 0.01) {
        return s;
    }
    const double power = 1.0 + 10.0 * sharpness;
    s = s < 0.5 ? 0.5 * std::pow(2.0 * s, power) : 1.0 - 0.5 * std::pow(2.0 * (1.0 - s), power);
    // A cubic Hermite curve with one slope at both ends.
    const double hermite = s * s * (3.0 - 2.0 * s) + (1.0 - sharpness) * s * (s - 1.0) * (2.0 * s - 1.0);
    return std::clamp(hermite, 0.0, 1.0);
}

/// Ends of straight pieces along f over (t0, t1], given to `add`.
template <class F, class Add>
void flatten(const F& f, double t0, double t1, int halvings, const Add& add) {
    const glm::dvec3 a = f(t0);
    const glm::dvec3 b = f(t1);
    constexpr int probes = 9;
    bool straight = true;
    for (int i = 1; i < probes && straight; ++i) {
        const double share = static_cast<double>(i) / probes;
        const glm::dvec3 miss = glm::abs(f(std::lerp(t0, t1, share)) - (a * (1.0 - share) + b * share));
        straight = std::max({miss.x, miss.y, miss.z}) <= tolerance;
    }
    if (straight || halvings == 0) {
        add(t1, b);
        return;
    }
    const double middle = std::midpoint(t0, t1);
    flatten(f, t0, middle, halvings - 1, add);
    flatten(f, middle, t1, halvings - 1, add);
}

void sort_and_cut(std::vector<VtkNode>& nodes) {
    std::ranges::stable_sort(nodes, {}, &VtkNode::x);
    for (VtkNode& node : nodes) {
        node.value = glm::clamp(node.value, 0.0, 1.0);
    }
}

/// Knots strictly between a and b.
void add_between(const VtkNode& a, const VtkNode& b, ColourSpace space, std::vector<CurveKnot>& knots) {
    // Apart enough from the ends that the two halves have a width.
    const double midpoint = std::clamp(a.midpoint, 1e-5, 1.0 - 1e-5);
    const auto place = [&](double t) { return a.x * (1.0 - t) + b.x * t; };
    if (a.sharpness > 0.99) {
        knots.push_back({place(midpoint), a.value});
        knots.push_back({place(midpoint), b.value});
        return;
    }
    const bool even = a.sharpness < 0.01 && midpoint == 0.5;
    if (even && space == ColourSpace::rgb) {
        return;
    }
    const auto f = [&](double t) {
        return mix_colours(space, a.value, b.value, blend(t, midpoint, a.sharpness));
    };
    const auto add = [&](double t, const glm::dvec3& value) {
        if (t < 1.0) {
            knots.push_back({place(t), value});
        }
    };
    if (even) {
        flatten(f, 0.0, 1.0, most_halvings, add);
    } else {
        flatten(f, 0.0, midpoint, most_halvings, add);
        flatten(f, midpoint, 1.0, most_halvings, add);
    }
}

glm::dvec3 between(const CurveKnot& a, const CurveKnot& b, double x) {
    const double width = b.x - a.x;
    // The distance may be beyond the range of double.
    const double t = std::isfinite(width) ? (x - a.x) / width : (x / 2 - a.x / 2) / (b.x / 2 - a.x / 2);
    return a.value * (1.0 - t) + b.value * t;
}

glm::dvec3 left_of(std::span<const CurveKnot> curve, double x) {
    const auto at = std::ranges::lower_bound(curve, x, {}, &CurveKnot::x);
    if (at == curve.end()) {
        return curve.back().value;
    }
    return at == curve.begin() || at->x == x ? at->value : between(*std::prev(at), *at, x);
}

glm::dvec3 right_of(std::span<const CurveKnot> curve, double x) {
    const auto after = std::ranges::upper_bound(curve, x, {}, &CurveKnot::x);
    if (after == curve.begin()) {
        return after->value;
    }
    const CurveKnot& before = *std::prev(after);
    return after == curve.end() || before.x == x ? before.value : between(before, *after, x);
}

}  // namespace

std::vector<CurveKnot> straighten(std::vector<VtkNode> nodes, ColourSpace space) {
    sort_and_cut(nodes);
    std::vector<CurveKnot> knots;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        knots.push_back({nodes[i].x, nodes[i].value});
        if (i + 1 < nodes.size() && nodes[i].x < nodes[i + 1].x) {
            add_between(nodes[i], nodes[i + 1], space, knots);
        }
    }
    return knots;
}

std::vector<CurveKnot> straighten_steps(std::vector<VtkNode> nodes) {
    sort_and_cut(nodes);
    std::vector<CurveKnot> knots;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        knots.push_back({nodes[i].x, nodes[i].value});
        if (i + 1 < nodes.size()) {
            knots.push_back({nodes[i].x, nodes[i + 1].value});
        }
    }
    return knots;
}

std::vector<TransferPoint> merge(std::span<const CurveKnot> colour, std::span<const CurveKnot> opacity) {
    std::vector<double> places;
    for (const std::span<const CurveKnot> curve : {colour, opacity}) {
        std::ranges::transform(curve, std::back_inserter(places), &CurveKnot::x);
    }
    std::ranges::sort(places);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    std::vector<TransferPoint> points;
    for (const double x : places) {
        const TransferPoint left{x, left_of(colour, x), left_of(opacity, x).x};
        const TransferPoint right{x, right_of(colour, x), right_of(opacity, x).x};
        points.push_back(left);
        if (!(right == left)) {
            points.push_back(right);
        }
    }
    return points;
}

}  // namespace viscera::io
