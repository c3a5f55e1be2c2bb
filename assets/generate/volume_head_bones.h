#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace viscera::assets {

// The bones of the head of volume_head.h: signed distances [mm].

/// To the inside of the braincase.
[[nodiscard]] float braincase_distance(const glm::vec3& p);
/// To what stands out from the bone under it, solid.
[[nodiscard]] float skull_base_distance(const glm::vec3& p);
/// Thickness of the vault around it [mm].
[[nodiscard]] float vault_thickness(const glm::vec3& p);
/// How near a suture of the vault is [mm]; large where there is none.
[[nodiscard]] float suture_distance(const glm::vec3& p, std::uint32_t seed);
/// Face, base and everything else of the skull but the vault; solid.
[[nodiscard]] float face_bone_distance(const glm::vec3& p);
/// The orbit's hollow.
[[nodiscard]] float orbit_distance(const glm::vec3& p);
/// Sinuses in the bones.
[[nodiscard]] float sinus_distance(const glm::vec3& p);
[[nodiscard]] float mandible_distance(const glm::vec3& p);

/// Cervical vertebrae, 1 to 5.
inline constexpr int vertebra_count = 5;
[[nodiscard]] glm::vec3 vertebra_centre(int level);
[[nodiscard]] float vertebra_distance(const glm::vec3& p, int level);

/// A tooth stands in an arch that is a parabola seen from above.
struct Tooth {
    glm::vec3 centre{0.0F};        ///< of the crown
    glm::vec2 along{1.0F, 0.0F};   ///< unit vector of the arch, x and y
    glm::vec3 half_lengths{1.0F};  ///< of the crown: along the arch, across it, up
    float root_mm = 12.0F;         ///< length of the root; up positive, down negative
};
inline constexpr int teeth_per_side = 7;
/// Number 0 (middle incisor) to 6 (second molar) of the patient's left.
[[nodiscard]] Tooth tooth(int number, bool upper);
[[nodiscard]] float tooth_distance(const glm::vec3& p, const Tooth& tooth);

}  // namespace viscera::assets
