#pragma once

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace viscera::assets {

struct Ray {
    glm::dvec3 origin{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};  ///< unit length
};

/// Part of a ray inside a convex body; empty when enter >= leave.
struct Chord {
    double enter = 0.0;
    double leave = 0.0;
    [[nodiscard]] double length() const { return leave > enter ? leave - enter : 0.0; }
};

struct Ellipsoid {
    glm::dvec3 centre{0.0};
    glm::dvec3 half_lengths{1.0};
    glm::dmat3 axes{1.0};  ///< unit axes as columns
    [[nodiscard]] Chord chord(const Ray& ray) const;
};

/// Elliptic cylinder along z, cut off flat.
struct Drum {
    glm::dvec3 centre{0.0};
    double half_width_x = 1.0;
    double half_width_y = 1.0;
    double half_height = 1.0;
    [[nodiscard]] Chord chord(const Ray& ray) const;
};

/// Length of `body` that none of `others` covers.
[[nodiscard]] double length_outside(const Chord& body, std::span<const Chord> others);

/// Cone-beam geometry: a point source and a flat square detector that looks at the isocentre (the origin).
class ConeBeam {
  public:
    static constexpr double source_axis_distance_mm = 750.0;
    static constexpr double source_image_distance_mm = 1200.0;
    static constexpr double detector_width_mm = 220.0;
    static constexpr int pixels = 1024;  ///< per row and column

    /// Positioner angles: LAO and cranial positive.
    ConeBeam(double primary_deg, double secondary_deg);

    /// Ray from the source to the centre of a pixel (row 0 is the top one); fractions are allowed.
    [[nodiscard]] Ray ray_to(double column, double row) const;
    /// Column, row (pixel centres at integers) and magnification in pixels per mm of a world point.
    [[nodiscard]] glm::dvec3 project(const glm::dvec3& p) const;
    [[nodiscard]] const glm::dvec3& source() const { return source_; }

  private:
    glm::dvec3 towards_detector_{0.0};
    glm::dvec3 right_{0.0};  ///< unit, along picture rows
    glm::dvec3 up_{0.0};
    glm::dvec3 source_{0.0};
};

}  // namespace viscera::assets
