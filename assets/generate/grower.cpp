#include "assets/generate/grower.h"

#include <algorithm>
#include <cmath>

#include "assets/generate/noise.h"

namespace viscera::assets {
namespace {

constexpr double shortest_mm = 8.0;

glm::dvec3 tangent_at(const std::vector<glm::dvec3>& points, std::size_t i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, points.size() - 1);
    return glm::normalize(points[after] - points[before]);
}

glm::dvec3 turned(const glm::dvec3& direction, const glm::dvec3& axis, double angle_rad) {
    return direction * std::cos(angle_rad) + glm::cross(axis, direction) * std::sin(angle_rad);
}

glm::dvec3 flattened(const glm::dvec3& direction, const glm::dvec3& normal) {
    return glm::normalize(direction - normal * glm::dot(direction, normal));
}

}  // namespace

int Grower::add(Course course) {
    courses_.push_back(std::move(course));
    return static_cast<int>(courses_.size()) - 1;
}

std::size_t Grower::clear_points(int parent, std::size_t parent_point,
                                 const std::vector<glm::dvec3>& points) const {
    for (std::size_t i = 1; i < points.size(); ++i) {
        const double along_mm = static_cast<double>(i) * step_mm;
        for (std::size_t c = 0; c < courses_.size(); ++c) {
            const Course& other = courses_[c];
            // Near its root a branch is as close to its parent, and to its twin, as the angle makes it.
            const bool kin = static_cast<int>(c) == parent ||
                             (other.parent == parent && other.parent_point == parent_point);
            const double needed_mm = kin ? std::min(clearance_mm, 0.35 * along_mm) : clearance_mm;
            for (const glm::dvec3& q : other.points) {
                if (glm::distance(q, points[i]) < needed_mm) {
                    return i;
                }
            }
        }
    }
    return points.size();
}

int Grower::add_if_clear(const std::string& name, int parent, std::size_t parent_point,
                         std::vector<glm::dvec3> points, double tip_weight) {
    std::size_t clear = clear_points(parent, parent_point, points);
    if (clear < points.size()) {
        clear = clear > 2 ? clear - 2 : 0;  // stop short of the other vessel, not at it
    }
    if (static_cast<double>(clear) * step_mm < shortest_mm) {
        return -1;
    }
    points.resize(clear);
    return add({.name = name,
                .parent = parent,
                .parent_point = parent_point,
                .points = std::move(points),
                .tip_weight = tip_weight});
}

int Grower::along(const std::string& name, int parent, std::size_t parent_point,
                  const std::vector<glm::dvec2>& way, double tip_weight, double tortuosity_mm) {
    const glm::dvec3 root = course(parent).points[parent_point];
    std::vector<glm::dvec3> corners{root};
    for (std::size_t i = 1; i < way.size(); ++i) {
        corners.push_back(heart_.point(way[i].x, way[i].y));
    }
    std::vector<glm::dvec3> points = resample(spline(corners, 24), step_mm);
    const auto seed = static_cast<std::uint32_t>(random_.bits());
    const std::vector<glm::dvec3> straight = points;
    for (std::size_t i = 1; i < points.size(); ++i) {
        const double along_mm = static_cast<double>(i) * step_mm;
        const double wave = fractal_noise({along_mm / 17.0, 0.5, 0.5}, 2, seed) * tortuosity_mm;
        const glm::dvec3 normal = heart_.normal(straight[i]);
        const glm::dvec3 sideways = glm::cross(normal, tangent_at(straight, i));
        const double onset = std::min(1.0, along_mm / 10.0);
        points[i] = heart_.onto_surface(straight[i] + onset * wave * sideways, onset * 0.4);
        points[i] = glm::mix(straight[i], points[i], onset);
    }
    return add_if_clear(name, parent, parent_point, resample(points, step_mm), tip_weight);
}

int Grower::twig(const std::string& name, int parent, std::size_t parent_point, double angle_deg,
                 double length_mm, double tip_weight) {
    std::vector<glm::dvec3> points{course(parent).points[parent_point]};
    glm::dvec3 home = tangent_at(course(parent).points, parent_point);
    glm::dvec3 heading =
        turned(flattened(home, heart_.normal(points[0])), heart_.normal(points[0]), glm::radians(angle_deg));
    const auto seed = static_cast<std::uint32_t>(random_.bits());
    const int steps = static_cast<int>(length_mm / step_mm);
    for (int i = 1; i <= steps; ++i) {
        const glm::dvec3 normal = heart_.normal(points.back());
        const double sway = gradient_noise({i * step_mm / 9.0, 0.3, 0.7}, seed);
        home = flattened(home, normal);
        heading = flattened(heading, normal);
        heading = glm::normalize(turned(heading, normal, 0.16 * sway) + 0.028 * home);
        points.push_back(heart_.onto_surface(points.back() + step_mm * heading, 0.3));
    }
    return add_if_clear(name, parent, parent_point, std::move(points), tip_weight);
}

int Grower::septal(const std::string& name, int parent, std::size_t parent_point, double length_mm,
                   double tip_weight) {
    std::vector<glm::dvec3> points{course(parent).points[parent_point]};
    const glm::dvec3 inward = -heart_.normal(points[0]);
    const glm::dvec3 onward = tangent_at(course(parent).points, parent_point);
    const glm::dvec3 across = glm::cross(inward, onward);
    const auto seed = static_cast<std::uint32_t>(random_.bits());
    const int steps = static_cast<int>(length_mm / step_mm);
    for (int i = 1; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        const double sway = gradient_noise({i * step_mm / 11.0, 0.6, 0.2}, seed);
        const glm::dvec3 heading = inward + onward * (0.45 + 0.5 * t) + across * (0.25 * sway);
        points.push_back(points.back() + step_mm * glm::normalize(heading));
    }
    return add_if_clear(name, parent, parent_point, std::move(points), tip_weight);
}

std::size_t Grower::free_point(int index, double fraction) const {
    const std::size_t last = course(index).points.size() - 1;
    const auto margin = static_cast<std::size_t>(std::ceil(4.0 / step_mm));
    auto point = static_cast<std::size_t>(std::lround(fraction * static_cast<double>(last)));
    point = std::clamp<std::size_t>(point, std::min(margin, last), last);
    const auto taken = [&](std::size_t i) {
        return std::any_of(courses_.begin(), courses_.end(), [&](const Course& other) {
            return other.parent == index && other.parent_point + margin > i &&
                   i + margin > other.parent_point;
        });
    };
    while (point < last && taken(point)) {
        ++point;
    }
    return point;
}

std::vector<int> Grower::twigs_along(int parent, int count, double tip_weight) {
    std::vector<int> rooted;
    double side = random_.uniform() < 0.5 ? -1.0 : 1.0;
    for (int i = 0; i < count; ++i) {
        const double fraction = (i + random_.uniform(0.55, 1.05)) / (count + 0.9);
        const double left_mm = (1.0 - fraction) * polyline_length(course(parent).points);
        const std::size_t point = free_point(parent, fraction);
        // The tip itself stays the vessel's own end.
        if (point + 4 >= course(parent).points.size()) {
            continue;
        }
        const std::string name = course(parent).name + "." + std::to_string(i + 1);
        for (int attempt = 0; attempt < 6; ++attempt) {
            const double angle_deg = side * random_.uniform(38.0, 62.0);
            const double length_mm = std::clamp(left_mm * random_.uniform(0.55, 0.95), 14.0, 40.0);
            side = -side;
            const int rooted_at = twig(name, parent, point, angle_deg, length_mm, tip_weight);
            if (rooted_at >= 0) {
                rooted.push_back(rooted_at);
                break;
            }
        }
    }
    return rooted;
}

}  // namespace viscera::assets
