#pragma once

#include <glm/glm.hpp>

namespace viscera::assets {

/// The surface that coronary arteries run on: an ellipsoid, 112 mm from base to apex, in the world frame (LPS
/// axes, mm, isocentre near its middle). Directions on it: beta [deg], 0 at the apex and 180 at the base;
/// phi [deg], 0 at the anterior interventricular groove, 90 at the left ventricle's side wall, 180 at the
/// posterior groove, -90 at the right ventricle.
class Heart {
  public:
    Heart();

    [[nodiscard]] glm::dvec3 point(double beta_deg, double phi_deg) const;
    /// (beta, phi) of the surface point straight under p.
    [[nodiscard]] glm::dvec2 angles(const glm::dvec3& p) const;
    /// The surface point on the ray from the centre through p, raised by lift_mm.
    [[nodiscard]] glm::dvec3 onto_surface(const glm::dvec3& p, double lift_mm = 0.0) const;
    /// Outward unit normal at a point on (or near) the surface.
    [[nodiscard]] glm::dvec3 normal(const glm::dvec3& p) const;
    [[nodiscard]] const glm::dvec3& centre() const { return centre_; }
    /// Unit axes as columns: anterior groove, side wall of the left ventricle, apex.
    [[nodiscard]] const glm::dmat3& axes() const { return axes_; }
    /// Half lengths along those axes [mm].
    [[nodiscard]] const glm::dvec3& half_lengths() const { return half_lengths_; }

  private:
    glm::dvec3 centre_{0.0};
    glm::dmat3 axes_{1.0};
    glm::dvec3 half_lengths_{40.0, 41.0, 56.0};
};

}  // namespace viscera::assets
