#include "assets/generate/heart.h"

#include <algorithm>
#include <cmath>

namespace viscera::assets {

Heart::Heart() : centre_(-4.0, 2.0, 0.0) {
    // The apex points to the left, to the front and down; the right ventricle lies to the right and the
    // front.
    const glm::dvec3 apex = glm::normalize(glm::dvec3(0.62, -0.54, -0.57));
    const glm::dvec3 towards_right_ventricle(-0.65, -0.6, 0.0);
    const glm::dvec3 groove = glm::normalize(glm::cross(towards_right_ventricle, apex));
    axes_ = glm::dmat3(groove, glm::cross(apex, groove), apex);
}

glm::dvec3 Heart::point(double beta_deg, double phi_deg) const {
    const double beta = glm::radians(beta_deg);
    const double phi = glm::radians(phi_deg);
    const glm::dvec3 unit(std::sin(beta) * std::cos(phi), std::sin(beta) * std::sin(phi), std::cos(beta));
    return centre_ + axes_ * (half_lengths_ * unit);
}

glm::dvec2 Heart::angles(const glm::dvec3& p) const {
    const glm::dvec3 unit = glm::normalize((glm::transpose(axes_) * (p - centre_)) / half_lengths_);
    return {glm::degrees(std::acos(std::clamp(unit.z, -1.0, 1.0))), glm::degrees(std::atan2(unit.y, unit.x))};
}

glm::dvec3 Heart::onto_surface(const glm::dvec3& p, double lift_mm) const {
    const glm::dvec3 unit = glm::normalize((glm::transpose(axes_) * (p - centre_)) / half_lengths_);
    const glm::dvec3 q = centre_ + axes_ * (half_lengths_ * unit);
    return q + lift_mm * normal(q);
}

glm::dvec3 Heart::normal(const glm::dvec3& p) const {
    const glm::dvec3 local = glm::transpose(axes_) * (p - centre_);
    return glm::normalize(axes_ * (local / (half_lengths_ * half_lengths_)));
}

}  // namespace viscera::assets
