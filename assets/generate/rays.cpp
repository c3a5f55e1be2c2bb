#include "assets/generate/rays.h"

#include <algorithm>
#include <cmath>

namespace viscera::assets {
namespace {

/// Of a ray in two dimensions or three.
template <class Vec>
Chord through_unit_ball(const Vec& o, const Vec& d) {
    const double dd = glm::dot(d, d);
    const double middle = -glm::dot(o, d) / dd;
    const double square = middle * middle - (glm::dot(o, o) - 1.0) / dd;
    if (square <= 0.0) {
        return {};
    }
    const double half = std::sqrt(square);
    return {middle - half, middle + half};
}

}  // namespace

Chord Ellipsoid::chord(const Ray& ray) const {
    const glm::dmat3 to_local = glm::transpose(axes);
    const glm::dvec3 o = to_local * (ray.origin - centre) / half_lengths;
    const glm::dvec3 d = to_local * ray.direction / half_lengths;
    return through_unit_ball(o, d);
}

Chord Drum::chord(const Ray& ray) const {
    const glm::dvec2 o((ray.origin.x - centre.x) / half_width_x, (ray.origin.y - centre.y) / half_width_y);
    const glm::dvec2 d(ray.direction.x / half_width_x, ray.direction.y / half_width_y);
    const Chord round = through_unit_ball(o, d);
    if (round.length() <= 0.0) {
        return {};
    }
    const double to_middle = centre.z - ray.origin.z;
    // Level rays make both ends infinite, with the right signs as long as they do not lie in a cap.
    const double a = (to_middle - half_height) / ray.direction.z;
    const double b = (to_middle + half_height) / ray.direction.z;
    return {std::max(round.enter, std::min(a, b)), std::min(round.leave, std::max(a, b))};
}

double length_outside(const Chord& body, std::span<const Chord> others) {
    if (body.length() <= 0.0) {
        return 0.0;
    }
    std::vector<Chord> covers;
    for (const Chord& other : others) {
        const Chord cut{std::max(body.enter, other.enter), std::min(body.leave, other.leave)};
        if (cut.length() > 0.0) {
            covers.push_back(cut);
        }
    }
    std::sort(covers.begin(), covers.end(), [](const Chord& a, const Chord& b) { return a.enter < b.enter; });
    double covered = 0.0;
    double reached = body.enter;
    for (const Chord& cover : covers) {
        covered += std::max(0.0, cover.leave - std::max(cover.enter, reached));
        reached = std::max(reached, cover.leave);
    }
    return body.length() - covered;
}

ConeBeam::ConeBeam(double primary_deg, double secondary_deg) {
    const double primary = glm::radians(primary_deg);
    const double secondary = glm::radians(secondary_deg);
    towards_detector_ = {std::sin(primary) * std::cos(secondary), -std::cos(primary) * std::cos(secondary),
                         std::sin(secondary)};
    right_ = glm::normalize(glm::cross(glm::dvec3(0.0, 0.0, 1.0), towards_detector_));
    up_ = glm::cross(towards_detector_, right_);
    source_ = -source_axis_distance_mm * towards_detector_;
}

Ray ConeBeam::ray_to(double column, double row) const {
    constexpr double pitch = detector_width_mm / pixels;
    const double x = (column + 0.5) * pitch - 0.5 * detector_width_mm;
    const double y = 0.5 * detector_width_mm - (row + 0.5) * pitch;
    return {source_, glm::normalize(source_image_distance_mm * towards_detector_ + x * right_ + y * up_)};
}

glm::dvec3 ConeBeam::project(const glm::dvec3& p) const {
    const glm::dvec3 from_source = p - source_;
    const double pixels_per_mm =
        source_image_distance_mm / glm::dot(from_source, towards_detector_) * pixels / detector_width_mm;
    constexpr double half = 0.5 * pixels - 0.5;
    return {half + glm::dot(from_source, right_) * pixels_per_mm,
            half - glm::dot(from_source, up_) * pixels_per_mm, pixels_per_mm};
}

}  // namespace viscera::assets
