#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace viscera::assets {

// What lies in the braincase of volume_head.h: signed distances [mm].

/// What a point of the cerebrum is made of.
struct Cerebrum {
    float surface_mm = 0.0F;  ///< to the folded surface, negative inside
    float cortex_mm = 0.0F;   ///< depth below the nearest surface, sulci included; >= 0 inside
};
[[nodiscard]] Cerebrum cerebrum_at(const glm::vec3& p, std::uint32_t seed);
[[nodiscard]] float cerebellum_distance(const glm::vec3& p);
/// 0 in a folium's white core, 1 in its cortex.
[[nodiscard]] float cerebellum_gray(const glm::vec3& p, std::uint32_t seed);
/// Brain stem and spinal cord.
[[nodiscard]] float stem_distance(const glm::vec3& p);
[[nodiscard]] float ventricle_distance(const glm::vec3& p);
/// Falx and tentorium, as thick as they show in CT.
[[nodiscard]] float dura_distance(const glm::vec3& p);
/// Basal ganglia and thalami.
[[nodiscard]] float deep_gray_distance(const glm::vec3& p);
/// A bleed into the right basal ganglia.
[[nodiscard]] float bleed_distance(const glm::vec3& p, std::uint32_t seed);

}  // namespace viscera::assets
