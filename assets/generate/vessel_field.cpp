#include "assets/generate/vessel_field.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace viscera::assets {
namespace {

/// Width of the rounding between two branches, relative to the thinner one.
constexpr double rounding = 0.6;

/// Polynomial smooth minimum, equal to the minimum where |a - b| >= width.
double smooth_min(double a, double b, double width) {
    const double h = std::max(0.0, width - std::abs(a - b)) / width;
    return std::min(a, b) - 0.25 * width * h * h;
}

}  // namespace

std::uint64_t grid_key(const glm::ivec3& p) {
    constexpr int bias = 1 << 20;
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + bias); };
    return (part(p.x) << 42U) | (part(p.y) << 21U) | part(p.z);
}

VesselField::VesselField(const VesselTree& tree, double cube_mm) : cube_mm_(cube_mm) {
    for (std::size_t b = 0; b < tree.branches.size(); ++b) {
        const Branch& branch = tree.branches[b];
        for (std::size_t i = 1; i < branch.nodes.size(); ++i) {
            const CentrelineGraph::Node& from = tree.graph.nodes[branch.nodes[i - 1]];
            const CentrelineGraph::Node& to = tree.graph.nodes[branch.nodes[i]];
            const double radius_a = i == 1 ? branch.start_radius_mm : from.radius_mm;
            enter({from.position_mm, to.position_mm, radius_a, to.radius_mm, b});
        }
    }
    std::sort(cubes_.begin(), cubes_.end(), [](const glm::ivec3& a, const glm::ivec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    });
}

void VesselField::enter(const Cone& cone) {
    const double margin = std::max(cone.radius_a, cone.radius_b) + reach_mm;
    const glm::ivec3 low(glm::floor((glm::min(cone.a, cone.b) - margin) / cube_mm_));
    const glm::ivec3 high(glm::floor((glm::max(cone.a, cone.b) + margin) / cube_mm_));
    const double half_diagonal = 0.5 * std::sqrt(3.0) * cube_mm_;
    for (int x = low.x; x <= high.x; ++x) {
        for (int y = low.y; y <= high.y; ++y) {
            for (int z = low.z; z <= high.z; ++z) {
                const glm::ivec3 cube(x, y, z);
                if (cone_distance(cone, (glm::dvec3(cube) + 0.5) * cube_mm_) > reach_mm + half_diagonal) {
                    continue;
                }
                std::vector<Cone>& cones = cones_in_[grid_key(cube)];
                if (cones.empty()) {
                    cubes_.push_back(cube);
                }
                cones.push_back(cone);
            }
        }
    }
}

double VesselField::cone_distance(const Cone& cone, const glm::dvec3& p) {
    const glm::dvec3 axis = cone.b - cone.a;
    const double length = glm::length(axis);
    const double drop = (cone.radius_a - cone.radius_b) / length;
    if (std::abs(drop) >= 1.0) {  // one sphere holds the other
        const bool first = cone.radius_a > cone.radius_b;
        return glm::distance(p, first ? cone.a : cone.b) - std::max(cone.radius_a, cone.radius_b);
    }
    // In the plane of p and the axis: the tangent line of both circles leans by asin(drop).
    const glm::dvec3 from_a = p - cone.a;
    const double along = glm::dot(from_a, axis) / length;
    const double across = std::sqrt(std::max(0.0, glm::dot(from_a, from_a) - along * along));
    const double lean = std::sqrt(1.0 - drop * drop);
    const double foot = along * lean - across * drop;
    if (foot < 0.0) {
        return glm::length(from_a) - cone.radius_a;
    }
    if (foot > length * lean) {
        return glm::distance(p, cone.b) - cone.radius_b;
    }
    return along * drop + across * lean - cone.radius_a;
}

double VesselField::distance(const glm::dvec3& p) const {
    const auto found = cones_in_.find(grid_key(glm::ivec3(glm::floor(p / cube_mm_))));
    if (found == cones_in_.end()) {
        return reach_mm;
    }
    double whole = reach_mm;
    double whole_radius = 0.0;
    double branch_distance = reach_mm;
    double branch_radius = 0.0;
    const auto join = [&] {
        const double width = rounding * std::min(whole_radius, branch_radius);
        const double joined =
            width > 0.0 ? smooth_min(whole, branch_distance, width) : std::min(whole, branch_distance);
        whole_radius = branch_distance < whole ? branch_radius : whole_radius;
        whole = joined;
    };
    std::size_t branch = 0;
    for (const Cone& cone : found->second) {
        if (cone.branch != branch) {
            join();
            branch = cone.branch;
            branch_distance = reach_mm;
            branch_radius = 0.0;
        }
        const double d = cone_distance(cone, p);
        if (d < branch_distance) {
            branch_distance = d;
            branch_radius = std::min(cone.radius_a, cone.radius_b);
        }
    }
    join();
    return std::min(whole, reach_mm);
}

glm::dvec3 VesselField::gradient(const glm::dvec3& p) const {
    constexpr double h = 0.01;  // [mm], wide enough to round the kinks between cones
    glm::dvec3 g(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = h;
        g[axis] = distance(p + step) - distance(p - step);
    }
    const double length = glm::length(g);
    return length > 0.0 ? g / length : glm::dvec3(0.0, 0.0, 1.0);
}

glm::dvec3 VesselField::onto_wall(glm::dvec3 p) const {
    for (int step = 0; step < 4; ++step) {
        const double d = distance(p);
        if (std::abs(d) < 1e-6) {
            break;
        }
        p -= d * gradient(p);
    }
    return p;
}

}  // namespace viscera::assets
