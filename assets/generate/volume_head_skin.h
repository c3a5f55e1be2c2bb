#pragma once

#include <glm/glm.hpp>

namespace viscera::assets {

// The head of volume_head.h from outside. Landmarks [mm, LPS]: eyes at z = -2, crown at z = 105, chin at
// z = -111, tip of the nose at y = -105, back of the head at y = 103.

/// Signed distance to the skin.
[[nodiscard]] float skin_distance(const glm::vec3& p);
/// To the hollow between palate, eyes and sinuses that septum and conchae stand in.
[[nodiscard]] float nasal_hollow_distance(const glm::vec3& p);
/// To the air in nose, sinuses, throat and ear canals, as far as soft tissue bounds it.
[[nodiscard]] float airway_distance(const glm::vec3& p);

}  // namespace viscera::assets
