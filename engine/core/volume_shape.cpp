#include "engine/core/volume_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/core/error.h"

namespace viscera {

namespace {

using std::numbers::pi;
constexpr double slack = 1e-9;  // of angles that files and scenes give in degrees

/// Places of radius, angle and the third coordinate in (i, j, k).
glm::dvec3 ordered(VolumeKind kind, double radius, double angle, double third) {
    return kind == VolumeKind::spherical ? glm::dvec3(angle, third, radius)
                                         : glm::dvec3(radius, angle, third);
}

struct Range {
    double low;
    double high;
};

/// Of r * direction over ranges of radius >= 0 and of a factor.
Range product(const Range& radius, const Range& factor) {
    const auto [low, high] = std::minmax({radius.low * factor.low, radius.low * factor.high,
                                          radius.high * factor.low, radius.high * factor.high});
    return {low, high};
}

/// Range of cos(angle - peak) over angles.
Range cosine_range(double low, double high, double peak) {
    if (high - low >= 2.0 * pi) {
        return {-1.0, 1.0};
    }
    const auto [a, b] = std::minmax({std::cos(low - peak), std::cos(high - peak)});
    const auto reaches = [&](double angle) {
        return std::floor((high - angle) / (2.0 * pi)) > std::floor((low - angle) / (2.0 * pi)) ||
               std::remainder(low - angle, 2.0 * pi) == 0.0;
    };
    return {reaches(peak + pi) ? -1.0 : a, reaches(peak) ? 1.0 : b};
}

}  // namespace

std::span<const std::string_view> choice_names(VolumeKind) {
    static constexpr std::array<std::string_view, 3> names{"cartesian", "cylindrical", "spherical"};
    return names;
}

std::string_view to_string(VolumeKind kind) {
    return choice_names(kind)[static_cast<std::size_t>(kind)];
}

int VolumeShape::angle_axis() const {
    return kind == VolumeKind::cylindrical ? 1 : (kind == VolumeKind::spherical ? 0 : -1);
}

int VolumeShape::radius_axis() const {
    return kind == VolumeKind::cylindrical ? 0 : (kind == VolumeKind::spherical ? 2 : -1);
}

bool VolumeShape::flat() const {
    const double third = kind == VolumeKind::spherical ? latitude_rad : height_mm;
    return curvilinear() && !(r_max_mm > r_min_mm && angle_rad > 0.0 && third > 0.0);
}

void VolumeShape::validate(std::string_view where) const {
    if (!curvilinear()) {
        return;
    }
    const auto check = [where](std::string_view field, double value, double low, double high) {
        if (!std::isfinite(value) || value < low || value > high) {
            throw Error(ErrorCode::file, std::string(where),
                        std::string(field) + " " + std::to_string(value) + " is not between " +
                            std::to_string(low) + " and " + std::to_string(high));
        }
    };
    constexpr double far_mm = 1e30;
    check("r_min [mm]", r_min_mm, 0.0, far_mm);
    check("r_max [mm]", r_max_mm, r_min_mm, far_mm);
    check("first angle [rad]", first_angle_rad, -1e6, 1e6);
    check("angle [rad]", angle_rad, 0.0, 2.0 * pi + slack);
    if (kind == VolumeKind::cylindrical) {
        check("height [mm]", height_mm, 0.0, far_mm);
    } else {
        check("latitude [rad]", latitude_rad, 0.0, pi + slack);
    }
    if (wrap && std::abs(angle_rad - 2.0 * pi) > slack) {
        throw Error(ErrorCode::file, std::string(where),
                    "wrap needs a full circle, but the angle is " + std::to_string(angle_rad) + " rad");
    }
}

ShapeAxes axes_of(const VolumeShape& shape, const glm::ivec3& dims) {
    const bool spherical = shape.kind == VolumeKind::spherical;
    ShapeAxes axes{.dims = dims};
    axes.first = ordered(shape.kind, shape.r_min_mm, shape.first_angle_rad,
                         spherical ? -0.5 * shape.latitude_rad : 0.0);
    axes.extent = ordered(shape.kind, shape.r_max_mm - shape.r_min_mm, shape.angle_rad,
                          spherical ? shape.latitude_rad : shape.height_mm);
    for (int a = 0; a < 3; ++a) {
        const int intervals = a == shape.wrap_axis() ? dims[a] : std::max(dims[a] - 1, 1);
        axes.step[a] = axes.extent[a] / intervals;
    }
    return axes;
}

glm::dvec3 to_frame(const VolumeShape& shape, const glm::dvec3& c) {
    if (shape.kind == VolumeKind::spherical) {
        const double across = c.z * std::cos(c.y);
        return {across * std::cos(c.x), across * std::sin(c.x), c.z * std::sin(c.y)};
    }
    return {c.x * std::cos(c.y), c.x * std::sin(c.y), c.z};
}

glm::dvec3 from_frame(const VolumeShape& shape, const glm::dvec3& place) {
    const double across = std::hypot(place.x, place.y);
    const double middle = shape.first_angle_rad + 0.5 * shape.angle_rad;
    const double angle = across > 0.0 ? std::atan2(place.y, place.x) : 0.0;
    const double turned = middle + std::remainder(angle - middle, 2.0 * pi);
    return shape.kind == VolumeKind::spherical
               ? glm::dvec3(turned, across > 0.0 || place.z != 0.0 ? std::atan2(place.z, across) : 0.0,
                            std::hypot(across, place.z))
               : glm::dvec3(across, turned, place.z);
}

FrameBox box_around(const VolumeShape& shape, const glm::dvec3& low, const glm::dvec3& high) {
    const bool spherical = shape.kind == VolumeKind::spherical;
    const int angle = shape.angle_axis();
    const int radius = shape.radius_axis();
    Range across{low[radius], high[radius]};
    Range along{low.z, high.z};
    if (spherical) {
        const Range r = across;
        across = product(r, cosine_range(low.y, high.y, 0.0));
        along = product(r, {std::sin(low.y), std::sin(high.y)});
    }
    const Range x = product(across, cosine_range(low[angle], high[angle], 0.0));
    const Range y = product(across, cosine_range(low[angle], high[angle], 0.5 * pi));
    return {{x.low, y.low, along.low}, {x.high, y.high, along.high}};
}

FrameBox box_around(const VolumeShape& shape) {
    const ShapeAxes axes = axes_of(shape, glm::ivec3(2));
    return box_around(shape, axes.first, axes.first + axes.extent);
}

}  // namespace viscera
