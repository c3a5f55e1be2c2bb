#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/gl/program.h"

namespace viscera::volume {

/// A plane that cuts the volume; the side that the normal points to stays.
struct ClipPlane {
    glm::dvec3 point_mm{0.0};
    glm::dvec3 normal{0.0, 0.0, 1.0};  ///< any length but 0

    void visit(ParamVisitor& v);
    /// (n, d) with n of length 1: what has dot(n, p) + d >= 0 stays.
    [[nodiscard]] glm::dvec4 half_space() const;
};

inline constexpr std::size_t most_clip_planes = 8;

/// Throws Error(scene) for too many planes and for normals of length 0.
void validate_clips(std::span<const ClipPlane> planes);

/// The box [min, max] of local coordinates as far as all half-spaces of the world leave it: the box around
/// that. Nothing is left where min > max.
struct ClippedBox {
    glm::dvec3 min{1.0};
    glm::dvec3 max{0.0};

    [[nodiscard]] bool empty() const { return !(min.x <= max.x); }
};
[[nodiscard]] ClippedBox clipped_box(const glm::dvec3& min, const glm::dvec3& max,
                                     const glm::dmat4& local_to_world, std::span<const ClipPlane> planes);

/// For glsl/volume/clip.glsl.
[[nodiscard]] std::vector<std::string> clip_defines(std::span<const ClipPlane> planes);
void set_clips(const gl::Program& program, std::span<const ClipPlane> planes,
               const glm::dmat4& local_to_world);

}  // namespace viscera::volume
