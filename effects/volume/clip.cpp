#include "effects/volume/clip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/error.h"

namespace viscera::volume {
namespace {

/// A half-space of the world in local coordinates, with a normal of length 1.
glm::dvec4 in_local(const glm::dvec4& half_space, const glm::dmat4& local_to_world) {
    const glm::dvec4 local = glm::transpose(local_to_world) * half_space;
    return local / std::max(glm::length(glm::dvec3(local)), 1e-300);
}

}  // namespace

void ClipPlane::visit(ParamVisitor& v) {
    v.field({.name = "point_mm", .doc = "A point of the plane, in the world.", .unit = "mm"}, point_mm);
    v.field({.name = "normal", .doc = "Points to the side that stays, in the world."}, normal);
}

glm::dvec4 ClipPlane::half_space() const {
    const glm::dvec3 n = glm::normalize(normal);
    return {n, -glm::dot(n, point_mm)};
}

void validate_clips(std::span<const ClipPlane> planes) {
    if (planes.size() > most_clip_planes) {
        throw Error(ErrorCode::scene, "/clip_planes",
                    "at most " + std::to_string(most_clip_planes) + " planes");
    }
    for (std::size_t i = 0; i < planes.size(); ++i) {
        if (!(glm::length(planes[i].normal) > 1e-150)) {
            throw Error(ErrorCode::scene, "/clip_planes/" + std::to_string(i) + "/normal",
                        "must not be of length 0");
        }
    }
}

ClippedBox clipped_box(const glm::dvec3& min, const glm::dvec3& max, const glm::dmat4& local_to_world,
                       std::span<const ClipPlane> planes) {
    if (planes.empty()) {
        return {min, max};
    }
    std::array<glm::dvec4, 6 + most_clip_planes> all{};
    std::size_t count = 0;
    for (int a = 0; a < 3; ++a) {
        glm::dvec4 low(0.0);
        low[a] = 1.0;
        all.at(count++) = low - glm::dvec4(0.0, 0.0, 0.0, min[a]);
        all.at(count++) = -low + glm::dvec4(0.0, 0.0, 0.0, max[a]);
    }
    for (const ClipPlane& plane : planes) {
        all.at(count++) = in_local(plane.half_space(), local_to_world);
    }
    const std::span<const glm::dvec4> walls = std::span(all).first(count);
    // What is left is convex and lies inside the box around its corners, where three walls meet.
    ClippedBox box{glm::dvec3(1e300), glm::dvec3(-1e300)};
    const double slack = 1e-9 * (1.0 + glm::length(max - min));
    for (std::size_t i = 0; i < walls.size(); ++i) {
        for (std::size_t j = i + 1; j < walls.size(); ++j) {
            for (std::size_t k = j + 1; k < walls.size(); ++k) {
                const glm::dvec3 a(walls[i]);
                const glm::dvec3 b(walls[j]);
                const glm::dvec3 c(walls[k]);
                const double determinant = glm::dot(a, glm::cross(b, c));
                if (std::abs(determinant) < 1e-12) {
                    continue;
                }
                const glm::dvec3 corner = -(walls[i].w * glm::cross(b, c) + walls[j].w * glm::cross(c, a) +
                                            walls[k].w * glm::cross(a, b)) /
                                          determinant;
                const bool kept = std::ranges::all_of(walls, [&](const glm::dvec4& wall) {
                    return glm::dot(wall, glm::dvec4(corner, 1.0)) >= -slack;
                });
                if (kept) {
                    box.min = glm::min(box.min, corner);
                    box.max = glm::max(box.max, corner);
                }
            }
        }
    }
    return box;
}

std::vector<std::string> clip_defines(std::span<const ClipPlane> planes) {
    if (planes.empty()) {
        return {};
    }
    return {"CLIP " + std::to_string(planes.size())};
}

void set_clips(const gl::Program& program, std::span<const ClipPlane> planes,
               const glm::dmat4& local_to_world) {
    std::array<glm::vec4, most_clip_planes> local{};
    for (std::size_t i = 0; i < planes.size(); ++i) {
        local[i] = in_local(planes[i].half_space(), local_to_world);
    }
    program.set("u_clip", std::span<const glm::vec4>(local).first(planes.size()));
}

}  // namespace viscera::volume
