#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace viscera::assets {

/// What lies at a point of the surface: weights that add up to 1.
struct OrganTissue {
    double liver = 0.0;
    double gallbladder = 0.0;
    double fat = 0.0;
};

/// The organs that a laparoscope sees from the navel, as one body: both lobes of a liver with a sharp lower
/// edge, the gallbladder in its bed under the right one, its duct, and the fatty omentum below, whose hollows
/// hold what runs down. LPS [mm], the patient lies on the back: down is +y. Negative inside. Sums, products
/// and square roots only.
class OrganField {
  public:
    explicit OrganField(std::uint64_t seed);

    /// Half edge of the cube about the origin that holds all of it [mm].
    static constexpr double reach_mm = 150.0;

    /// Close to the signed distance.
    [[nodiscard]] double distance(const glm::dvec3& p) const;
    /// Outward unit gradient, by central differences.
    [[nodiscard]] glm::dvec3 normal(const glm::dvec3& p) const;
    /// The point of the surface that Newton's steps lead to from p.
    [[nodiscard]] glm::dvec3 onto_surface(glm::dvec3 p) const;
    [[nodiscard]] OrganTissue tissue(const glm::dvec3& p) const;
    /// Distance on the surface from the line where the gallbladder meets its bed [mm]: where it is cut loose.
    [[nodiscard]] double bed_distance(const glm::dvec3& p) const;

  private:
    [[nodiscard]] float liver(const glm::vec3& p) const;
    [[nodiscard]] float gallbladder(const glm::vec3& p) const;
    [[nodiscard]] float fat(const glm::vec3& p) const;

    std::uint32_t seed_;
};

}  // namespace viscera::assets
