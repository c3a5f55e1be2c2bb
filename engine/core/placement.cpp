#include "engine/core/placement.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace viscera {

void PlacementParams::visit(ParamVisitor& v) {
    v.field({.name = "move_mm", .doc = "Moves it in the world.", .unit = "mm"}, move_mm);
    v.field({.name = "rotate_deg",
             .doc = "Turns it about its centre: about the world's x axis, then y, then z.",
             .unit = "degree"},
            rotate_deg);
    v.field(
        {.name = "scale", .doc = "Scales it about its centre along the world's axes; negative: mirrored."},
        scale);
}

glm::dmat4 placement_matrix(const PlacementParams& placement, const glm::dvec3& centre) {
    glm::dmat4 m = glm::translate(glm::dmat4(1.0), placement.move_mm + centre);
    m = glm::rotate(m, glm::radians(placement.rotate_deg.z), glm::dvec3(0, 0, 1));
    m = glm::rotate(m, glm::radians(placement.rotate_deg.y), glm::dvec3(0, 1, 0));
    m = glm::rotate(m, glm::radians(placement.rotate_deg.x), glm::dvec3(1, 0, 0));
    m = glm::scale(m, placement.scale);
    return glm::translate(m, -centre);
}

bool invertible(const glm::dmat4& matrix) {
    const glm::dmat3 m(matrix);
    const double product = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
    const double volume = std::abs(glm::determinant(m));
    return std::isfinite(product) && product > 0.0 && volume > 1e-9 * product &&
           std::isfinite(glm::dot(glm::dvec3(matrix[3]), glm::dvec3(1.0)));
}

}  // namespace viscera
