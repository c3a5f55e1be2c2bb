#include "effects/volume/slice_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/core/error.h"

namespace viscera::volume {
namespace {

glm::dvec3 corner(int i) {
    return {(i & 1) != 0 ? 1.0 : 0.0, (i & 2) != 0 ? 1.0 : 0.0, (i & 4) != 0 ? 1.0 : 0.0};
}

}  // namespace

std::span<const std::string_view> choice_names(SliceAxis) {
    static constexpr std::array<std::string_view, 3> names{"axial", "coronal", "sagittal"};
    return names;
}

void ObliqueParams::visit(ParamVisitor& v) {
    v.field({.name = "point_mm", .doc = "In the picture's middle, in the world.", .unit = "mm"}, point_mm);
    v.field({.name = "normal", .doc = "From the plane to the eye."}, normal);
    v.field({.name = "up", .doc = "Up in the picture, as far as it lies in the plane."}, up);
}

void PlaneParams::visit(ParamVisitor& v) {
    v.field({.name = "axis",
             .doc = "axial: the patient's right on the left, front up; coronal: right on the left, head up; "
                    "sagittal: front on the left, head up."},
            axis);
    v.field({.name = "position_mm",
             .doc = "Where the axis is cut, in the world; by default through the volume's centre.",
             .unit = "mm"},
            position_mm);
    v.field({.name = "oblique", .doc = "Any plane, instead of axis and position."}, oblique);
}

void PlaneParams::validate() const {
    if (!oblique) {
        return;
    }
    const double normal = glm::length(oblique->normal);
    if (!(normal > 1e-150)) {
        throw Error(ErrorCode::scene, "/plane/oblique/normal", "must not be of length 0");
    }
    const glm::dvec3 across = glm::cross(oblique->up, oblique->normal / normal);
    if (!(glm::length(across) > 1e-9 * glm::length(oblique->up))) {
        throw Error(ErrorCode::scene, "/plane/oblique/up", "must not be of length 0 nor along the normal");
    }
}

SlicePlane slice_plane(const PlaneParams& params, const glm::dmat4& texture_to_world) {
    if (params.oblique) {
        const glm::dvec3 normal = glm::normalize(params.oblique->normal);
        const glm::dvec3 right = glm::normalize(glm::cross(glm::normalize(params.oblique->up), normal));
        return {params.oblique->point_mm, right, glm::cross(normal, right)};
    }
    SlicePlane plane{texture_to_world * glm::dvec4(0.5, 0.5, 0.5, 1.0)};
    // LPS: x to the patient's left, y to the back, z to the head.
    int along = 2;
    plane.up = {0.0, 0.0, 1.0};
    switch (params.axis) {
        case SliceAxis::axial:
            plane.up = {0.0, -1.0, 0.0};
            break;
        case SliceAxis::coronal:
            along = 1;
            break;
        case SliceAxis::sagittal:
            along = 0;
            plane.right = {0.0, 1.0, 0.0};
            break;
    }
    plane.centre_mm[along] = params.position_mm.value_or(plane.centre_mm[along]);
    return plane;
}

double fitting_height_mm(const SlicePlane& plane, const glm::dmat4& texture_to_world, double aspect) {
    double half = 0.0;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 p = glm::dvec3(texture_to_world * glm::dvec4(corner(i), 1.0)) - plane.centre_mm;
        half = std::max({half, std::abs(glm::dot(p, plane.up)), std::abs(glm::dot(p, plane.right)) / aspect});
    }
    return 2.0 * half;
}

MeshData cut_polygon(const SlicePlane& plane, const glm::dmat4& texture_to_world) {
    const glm::dvec3 normal = plane.normal();
    std::array<double, 8> height{};
    double most = 0.0;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 p = glm::dvec3(texture_to_world * glm::dvec4(corner(i), 1.0)) - plane.centre_mm;
        height.at(static_cast<std::size_t>(i)) = glm::dot(normal, p);
        most = std::max(most, std::abs(height.at(static_cast<std::size_t>(i))));
    }
    // A face of the box is cut as a whole: its corners count as inside whatever rounding says.
    for (double& h : height) {
        h = std::abs(h) < 1e-12 * most ? 0.0 : h;
    }
    std::vector<glm::dvec3> corners;
    const auto add = [&](const glm::dvec3& p) {
        if (std::ranges::none_of(corners, [&](const glm::dvec3& q) { return glm::length(p - q) < 1e-12; })) {
            corners.push_back(p);
        }
    };
    for (int i = 0; i < 8; ++i) {
        for (int bit = 1; bit < 8; bit *= 2) {
            const double a = height.at(static_cast<std::size_t>(i));
            const double b = height.at(static_cast<std::size_t>(i | bit));
            if ((i & bit) == 0 && a * b <= 0.0 && a != b) {
                add(glm::mix(corner(i), corner(i | bit), a / (a - b)));
            }
        }
    }
    if (corners.size() < 3) {
        return {};
    }
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& p : corners) {
        middle += p / static_cast<double>(corners.size());
    }
    const auto angle = [&](const glm::dvec3& p) {
        const glm::dvec3 way = texture_to_world * glm::dvec4(p - middle, 0.0);
        return std::atan2(glm::dot(way, plane.up), glm::dot(way, plane.right));
    };
    std::ranges::sort(corners, {}, angle);
    MeshData mesh;
    for (const glm::dvec3& p : corners) {
        mesh.positions.emplace_back(p);
    }
    for (std::uint32_t i = 2; i < corners.size(); ++i) {
        mesh.indices.insert(mesh.indices.end(), {0U, i - 1U, i});
    }
    return mesh;
}

}  // namespace viscera::volume
