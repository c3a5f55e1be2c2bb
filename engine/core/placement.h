#pragma once

#include <glm/glm.hpp>

#include "engine/core/params.h"

namespace viscera {

/// Where a thing is put: scaled and turned about its own centre, then moved.
struct PlacementParams {
    glm::dvec3 move_mm{0.0};
    glm::dvec3 rotate_deg{0.0};  ///< about x, then y, then z
    glm::dvec3 scale{1.0};       ///< negative: mirrored

    void visit(ParamVisitor& v);
};

/// World -> world, about `centre` [mm]. The determinant may be negative.
[[nodiscard]] glm::dmat4 placement_matrix(const PlacementParams& placement, const glm::dvec3& centre);
/// Whether a matrix can be inverted: finite, and no axis vanishes beside the others.
[[nodiscard]] bool invertible(const glm::dmat4& matrix);

}  // namespace viscera
