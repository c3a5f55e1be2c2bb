#include "assets/generate/volume_head_brain.h"

#include "assets/generate/noise.h"
#include "assets/generate/volume_head_bones.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

/// Height of the tent between cerebrum and cerebellum.
float tent_z(const glm::vec3& q) {
    const float ridge = 18.0F - 0.22F * (q.y - 22.0F);
    return ridge - 0.34F * q.x;
}

}  // namespace

Cerebrum cerebrum_at(const glm::vec3& p, std::uint32_t seed) {
    const glm::vec3 q = folded(p);
    const float pial = braincase_distance(p) + 2.2F;
    float whole = pial;
    // Nothing of it below the tent, which begins at the petrous ridge.
    whole = carve(whole, std::max(q.z - tent_z(q) - 1.5F, 0.56F * q.x - 8.0F - q.y), 3.0F);
    const float callosum = ellipsoid(q, {0.0F, 6.0F, 20.0F}, {20.0F, 40.0F, 24.0F});
    whole = std::max(whole, std::min(1.1F - q.x, callosum + 2.0F));
    whole = std::max(whole, std::min(8.0F - q.x, -(q.z - 4.0F)));  // nothing of it below the middle
    // Sulci follow the zero lines of a warped noise, deep where they are broad.
    const glm::dvec3 at(p);
    const glm::dvec3 bent =
        at + 5.0 * glm::dvec3(gradient_noise(at / 24.0, seed + 1U), gradient_noise(at / 24.0, seed + 2U),
                              gradient_noise(at / 24.0, seed + 3U));
    const auto fold = static_cast<float>(gradient_noise(bent / 15.0, seed + 4U));
    const auto depth = static_cast<float>(gradient_noise(at / 19.0, seed + 5U));
    const float from_fold = std::abs(fold) * 12.0F;
    const float sulcus_depth = 13.0F + 6.0F * depth;
    const float below_floor = -pial - sulcus_depth;
    float sulcus = std::max(from_fold - 0.55F, below_floor);
    // Sylvian fissure: from the temple backwards and up, between temporal and frontal lobe.
    const float lips = std::abs(q.z - 12.0F - 0.5F * (q.y + 20.0F) + 5.0F * depth) - 1.1F;
    const float fissure = std::max({lips, 33.0F - q.x, std::abs(q.y + 4.0F) - 32.0F});
    sulcus = std::min(sulcus, fissure);
    const float gray_below = std::max(0.0F, below_floor);
    const float to_sulcus = std::sqrt(from_fold * from_fold + gray_below * gray_below) - 0.55F;
    Cerebrum here;
    here.surface_mm = std::max(whole, -sulcus);
    here.cortex_mm = std::max(0.0F, std::min({-whole, to_sulcus, std::max(fissure, 0.0F)}));
    return here;
}

float cerebellum_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = ellipsoid(q, {22.0F, 46.0F, -12.0F}, {30.0F, 33.0F, 22.0F});
    d = join(d, ellipsoid(q, {0.0F, 46.0F, -6.0F}, {10.0F, 22.0F, 22.0F}), 5.0F);
    d = std::max(d, braincase_distance(p) + 2.0F);
    return carve(d, tent_z(q) - 2.5F - q.z, 2.0F);
}

float cerebellum_gray(const glm::vec3& p, std::uint32_t seed) {
    const float depth = -cerebellum_distance(p);
    const auto wobble = static_cast<float>(gradient_noise(glm::dvec3(p) / 12.0, seed + 9U));
    const float turns = (p.z + 0.55F * p.y + 3.0F * wobble) / 4.2F;
    const float wave = std::abs(2.0F * (turns - std::floor(turns)) - 1.0F);
    return std::clamp(1.35F - 0.11F * depth, 0.0F, 1.0F) * step_between(0.15F, 0.6F, wave) +
           step_between(2.5F, 1.0F, depth) * (1.0F - step_between(0.15F, 0.6F, wave)) * 0.6F;
}

float stem_distance(const glm::vec3& p) {
    float d = ellipsoid(p, {0.0F, 13.0F, -9.0F}, {15.0F, 11.0F, 13.0F});                      // pons
    d = join(d, rod(p, {0.0F, 10.0F, 12.0F}, {0.0F, 15.0F, -8.0F}, 12.0F, 11.0F), 6.0F);      // midbrain
    d = join(d, rod(p, {0.0F, 17.0F, -16.0F}, {0.0F, 35.0F, -42.0F}, 8.0F, 5.5F), 5.0F);      // medulla
    return join(d, rod(p, {0.0F, 35.0F, -42.0F}, {0.0F, 40.0F, -135.0F}, 5.5F, 5.0F), 3.0F);  // cord
}

float ventricle_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = rod(q, {13.0F, -30.0F, 26.0F}, {7.0F, -8.0F, 32.0F}, 4.2F, 4.6F);           // frontal horn
    d = join(d, rod(q, {7.0F, -8.0F, 32.0F}, {13.0F, 22.0F, 34.0F}, 4.6F, 4.8F), 4.0F);   // body
    d = join(d, rod(q, {13.0F, 22.0F, 34.0F}, {25.0F, 36.0F, 20.0F}, 4.8F, 6.0F), 4.0F);  // atrium
    d = join(d, rod(q, {25.0F, 36.0F, 20.0F}, {20.0F, 60.0F, 21.0F}, 4.6F, 2.0F), 4.0F);  // occipital horn
    d = join(d, rod(q, {26.0F, 33.0F, 17.0F}, {31.0F, -4.0F, -3.0F}, 3.4F, 1.8F), 3.0F);  // temporal horn
    d = join(d, ellipsoid(q, {0.0F, 4.0F, 18.0F}, {2.3F, 14.0F, 9.0F}), 1.5F);            // third
    d = join(d, rod(q, {0.0F, 16.0F, 12.0F}, {0.0F, 25.0F, -4.0F}, 1.3F, 1.5F), 1.0F);    // aqueduct
    return join(d, ellipsoid(q, {0.0F, 29.0F, -12.0F}, {7.0F, 4.5F, 9.0F}), 2.0F);        // fourth
}

float dura_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    const float inside = braincase_distance(p);
    const float hollow = ellipsoid(q, {0.0F, -2.0F, 18.0F}, {40.0F, 52.0F, 36.0F});
    const float falx = std::max({q.x - 0.9F, -hollow, tent_z(q) - q.z, inside, 12.0F - q.z});
    const float notch = ellipsoid(q, {0.0F, 14.0F, 6.0F}, {17.0F, 24.0F, 60.0F});
    const float tent = std::max({std::abs(q.z - tent_z(q)) - 0.8F, -notch, 4.0F - q.y, inside});
    const float sinus = rod(q, {0.0F, 85.0F, 34.0F}, {0.0F, 88.0F, 12.0F}, 2.5F, 4.0F);
    return std::min({falx, tent, std::max(sinus, inside)});
}

float deep_gray_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    const float thalamus = ellipsoid(q, {11.0F, 12.0F, 21.0F}, {8.0F, 14.0F, 8.5F});
    const float lentiform = ellipsoid(q, {25.0F, -6.0F, 19.0F}, {6.5F, 17.0F, 10.0F});
    const float caudate = rod(q, {16.0F, -24.0F, 23.0F}, {16.0F, 8.0F, 34.0F}, 5.0F, 2.5F);
    return std::min({thalamus, lentiform, caudate});
}

float bleed_distance(const glm::vec3& p, std::uint32_t seed) {
    const float lump = ellipsoid(p, {-26.0F, 0.0F, 22.0F}, {8.5F, 14.0F, 9.5F});
    return lump < 12.0F ? lump + 2.8F * static_cast<float>(fractal_noise(glm::dvec3(p) / 9.0, 2, seed + 6U))
                        : lump;
}

}  // namespace viscera::assets
