#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/vessel_tree.h"

namespace viscera::assets {

/// Signed distance to the wall of a vessel tree [mm], negative in the lumen: along a branch the exact
/// distance to its round cones, across branches a smooth union that rounds each crotch. Known only near the
/// vessels, which space is cut into cubes for.
class VesselField {
  public:
    /// How far from the wall the distance is known [mm].
    static constexpr double reach_mm = 1.6;

    /// cube_mm: edge of the cubes, > 0.
    VesselField(const VesselTree& tree, double cube_mm);

    /// Signed distance; reach_mm where no vessel is near.
    [[nodiscard]] double distance(const glm::dvec3& p) const;
    /// Outward unit gradient, by central differences.
    [[nodiscard]] glm::dvec3 gradient(const glm::dvec3& p) const;
    /// The point of the wall that Newton's steps lead to from p.
    [[nodiscard]] glm::dvec3 onto_wall(glm::dvec3 p) const;
    /// Cubes near a vessel, in lexicographic order.
    [[nodiscard]] const std::vector<glm::ivec3>& cubes() const { return cubes_; }

  private:
    struct Cone {
        glm::dvec3 a{0.0};
        glm::dvec3 b{0.0};
        double radius_a = 0.0;
        double radius_b = 0.0;
        std::size_t branch = 0;
    };

    static double cone_distance(const Cone& cone, const glm::dvec3& p);
    void enter(const Cone& cone);

    double cube_mm_;
    std::vector<glm::ivec3> cubes_;
    std::unordered_map<std::uint64_t, std::vector<Cone>> cones_in_;
};

/// One number for a grid point with coordinates in [-2^20, 2^20).
[[nodiscard]] std::uint64_t grid_key(const glm::ivec3& p);

}  // namespace viscera::assets
