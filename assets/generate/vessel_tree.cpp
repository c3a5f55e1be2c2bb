#include "assets/generate/vessel_tree.h"

#include <algorithm>
#include <cmath>

namespace viscera::assets {
namespace {

double cubed(double x) {
    return x * x * x;
}

/// For each course one radius per point, up to a common factor; the one at a branching is the parent's.
/// The radius at a course's own root is that of its second point.
std::vector<std::vector<double>> relative_radii(const std::vector<Course>& courses, double taper_per_mm) {
    std::vector<std::vector<double>> radii(courses.size());
    std::vector<std::vector<double>> cubes_leaving(courses.size());
    for (std::size_t c = 0; c < courses.size(); ++c) {
        radii[c].assign(courses[c].points.size(), courses[c].pipe_radius_mm);
        cubes_leaving[c].assign(courses[c].points.size(), 0.0);
    }
    for (std::size_t c = courses.size(); c-- > 0;) {
        const Course& course = courses[c];
        if (course.pipe_radius_mm > 0.0) {
            continue;
        }
        const std::size_t last = course.points.size() - 1;
        const double forked = cubes_leaving[c][last];
        double radius = forked > 0.0 ? std::cbrt(forked) : course.tip_weight;
        for (std::size_t i = last; i > 0; --i) {
            radii[c][i] = radius;
            if (cubes_leaving[c][i - 1] > 0.0) {
                radius = std::cbrt(cubed(radius) + cubes_leaving[c][i - 1]);
            } else if (i > 1) {
                radius *= 1.0 + taper_per_mm * glm::distance(course.points[i - 1], course.points[i]);
            }
        }
        radii[c][0] = radii[c][1];
        if (course.parent >= 0) {
            cubes_leaving[static_cast<std::size_t>(course.parent)][course.parent_point] += cubed(radii[c][1]);
        }
    }
    return radii;
}

}  // namespace

VesselTree join_courses(const std::vector<Course>& courses, const Calibre& calibre) {
    const std::vector<std::vector<double>> relative = relative_radii(courses, calibre.taper_per_mm);
    double scale = 0.0;
    VesselTree tree;
    CentrelineGraph& graph = tree.graph;
    for (std::size_t c = 0; c < courses.size(); ++c) {
        const Course& course = courses[c];
        const bool pipe = course.pipe_radius_mm > 0.0;
        const bool first_vessel = !pipe && scale == 0.0;
        if (first_vessel) {
            scale = calibre.root_radius_mm / relative[c][0];
        }
        const auto radius_mm = [&](std::size_t i) { return relative[c][i] * (pipe ? 1.0 : scale); };
        Branch branch{.name = course.name, .nodes = {}, .start_radius_mm = radius_mm(0)};
        if (course.parent < 0) {
            branch.nodes.push_back(static_cast<std::uint32_t>(graph.nodes.size()));
            graph.nodes.push_back({.position_mm = course.points[0], .radius_mm = radius_mm(0)});
        } else {
            const Branch& parent = tree.branches[static_cast<std::size_t>(course.parent)];
            branch.nodes.push_back(parent.nodes[course.parent_point]);
        }
        if (first_vessel) {  // the mouth of the catheter is as wide as the vessel
            graph.nodes[branch.nodes[0]].radius_mm = radius_mm(0);
        }
        for (std::size_t i = 1; i < course.points.size(); ++i) {
            const auto node = static_cast<std::uint32_t>(graph.nodes.size());
            graph.nodes.push_back({.position_mm = course.points[i], .radius_mm = radius_mm(i)});
            graph.edges.push_back({.a = branch.nodes.back(), .b = node});
            branch.nodes.push_back(node);
        }
        tree.branches.push_back(std::move(branch));
    }
    return tree;
}

double polyline_length(const std::vector<glm::dvec3>& polyline) {
    double length = 0.0;
    for (std::size_t i = 1; i < polyline.size(); ++i) {
        length += glm::distance(polyline[i - 1], polyline[i]);
    }
    return length;
}

std::vector<glm::dvec3> resample(const std::vector<glm::dvec3>& polyline, double step_mm) {
    const double length = polyline_length(polyline);
    const auto spans = static_cast<std::size_t>(std::max(1.0, std::round(length / step_mm)));
    const double step = length / static_cast<double>(spans);
    std::vector<glm::dvec3> points{polyline.front()};
    double walked = 0.0;
    for (std::size_t i = 1; i < polyline.size(); ++i) {
        const double piece = glm::distance(polyline[i - 1], polyline[i]);
        while (points.size() < spans && static_cast<double>(points.size()) * step <= walked + piece) {
            const double t = (static_cast<double>(points.size()) * step - walked) / piece;
            points.push_back(glm::mix(polyline[i - 1], polyline[i], t));
        }
        walked += piece;
    }
    points.push_back(polyline.back());
    return points;
}

std::vector<glm::dvec3> spline(const std::vector<glm::dvec3>& points, int per_span) {
    std::vector<glm::dvec3> curve{points.front()};
    const auto at = [&](std::ptrdiff_t i) {
        const auto last = static_cast<std::ptrdiff_t>(points.size()) - 1;
        if (i < 0) {
            return 2.0 * points[0] - points[1];
        }
        return i > last ? 2.0 * points.back() - points[points.size() - 2]
                        : points[static_cast<std::size_t>(i)];
    };
    for (std::ptrdiff_t i = 0; i + 1 < static_cast<std::ptrdiff_t>(points.size()); ++i) {
        const glm::dvec3 a = at(i - 1);
        const glm::dvec3 b = at(i);
        const glm::dvec3 c = at(i + 1);
        const glm::dvec3 d = at(i + 2);
        for (int k = 1; k <= per_span; ++k) {
            const double t = static_cast<double>(k) / per_span;
            curve.push_back(0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * (t * t) +
                                   (3.0 * (b - c) + d - a) * (t * t * t)));
        }
    }
    return curve;
}

}  // namespace viscera::assets
