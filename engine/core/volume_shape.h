#pragma once

#include <span>
#include <string_view>

#include <glm/glm.hpp>

namespace viscera {

/// What the axes (i, j, k) of a volume run along. cylindrical: radius, angle, height; spherical: longitude,
/// latitude, radius.
enum class VolumeKind { cartesian, cylindrical, spherical };
[[nodiscard]] std::span<const std::string_view> choice_names(VolumeKind kind);
[[nodiscard]] std::string_view to_string(VolumeKind kind);

/// Extents of a curvilinear volume in a frame of its own [mm]: the axis of cylinder or sphere is the frame's
/// z, angles count from its x towards its y. The ends are samples: n of them span an extent with n - 1
/// intervals, and with n intervals around a full circle that wraps.
struct VolumeShape {
    VolumeKind kind = VolumeKind::cartesian;
    double r_min_mm = 0.0;         ///< of the first sample, >= 0
    double r_max_mm = 0.0;         ///< of the last sample, >= r_min_mm
    double first_angle_rad = 0.0;  ///< of the first sample: angle, longitude
    double angle_rad = 0.0;        ///< from the first sample to the last, [0, 2 pi]; with wrap: 2 pi
    bool wrap = false;             ///< the last sample is a neighbour of the first
    double height_mm = 0.0;        ///< cylindrical: from z = 0 on, >= 0
    double latitude_rad = 0.0;     ///< spherical: in all, [0, pi]; half of it to either side of the equator

    [[nodiscard]] bool curvilinear() const { return kind != VolumeKind::cartesian; }
    /// The axis along which the angle or longitude runs; -1: none.
    [[nodiscard]] int angle_axis() const;
    /// The axis whose first and last samples are neighbours; -1: none.
    [[nodiscard]] int wrap_axis() const { return wrap ? angle_axis() : -1; }
    /// The axis along which the radius runs; -1: none.
    [[nodiscard]] int radius_axis() const;
    /// Whether it encloses nothing: an extent is 0.
    [[nodiscard]] bool flat() const;
    /// Throws Error(file) at `where` that names the field: a number that is not finite or outside the ranges
    /// above.
    void validate(std::string_view where) const;

    bool operator==(const VolumeShape&) const = default;
};

/// Curvilinear coordinates of a shape's samples: coordinate = first + index * step. Angles [rad], lengths
/// [mm].
struct ShapeAxes {
    glm::dvec3 first{0.0};
    glm::dvec3 extent{0.0};  ///< of all intervals
    glm::dvec3 step{0.0};    ///< between samples; of an axis with one sample its extent
    glm::ivec3 dims{1};
};
/// Curvilinear shapes only. An axis with one sample is constant along it; the sample counts as its first.
[[nodiscard]] ShapeAxes axes_of(const VolumeShape& shape, const glm::ivec3& dims);

/// Curvilinear coordinates in the order of the shape's axes <-> the shape's frame [mm]. On the axis the angle
/// is 0, in the centre the latitude, too. Angles are given in [first angle - (2 pi - angle) / 2, + 2 pi), so
/// that they are cut in the middle of the gap.
[[nodiscard]] glm::dvec3 to_frame(const VolumeShape& shape, const glm::dvec3& coordinates);
[[nodiscard]] glm::dvec3 from_frame(const VolumeShape& shape, const glm::dvec3& place);

/// A box of a shape's frame [mm].
struct FrameBox {
    glm::dvec3 min{0.0};
    glm::dvec3 max{0.0};
};
/// The box around all places with coordinates from `low` to `high`; an angle's range of 2 pi or more is all
/// around.
[[nodiscard]] FrameBox box_around(const VolumeShape& shape, const glm::dvec3& low, const glm::dvec3& high);
[[nodiscard]] FrameBox box_around(const VolumeShape& shape);

}  // namespace viscera
