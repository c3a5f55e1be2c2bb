#include "assets/generate/volume_head_bones.h"

#include <array>

#include "assets/generate/noise.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

/// Distance to the parabola y = front + bend x^2, seen from above; to first order.
float parabola_distance(const glm::vec3& q, float front, float bend) {
    const float slope = 2.0F * bend * q.x;
    return (q.y - front - bend * q.x * q.x) / std::sqrt(1.0F + slope * slope);
}

/// Ring of bone that the eye looks out of; its outer side lies further back.
float orbit_rim(const glm::vec3& q) {
    const glm::vec3 from = q - glm::vec3(33.0F, -66.0F, -1.0F);
    const float back = from.y - 0.6F * from.x;
    const float circle = std::sqrt(from.x * from.x + 1.25F * from.z * from.z) - 20.5F;
    return std::sqrt(circle * circle + back * back) - 4.0F;
}

float zygomatic_arch(const glm::vec3& q) {
    const float front = rod(q, {52.0F, -50.0F, -22.0F}, {65.0F, -26.0F, -23.0F}, 4.5F, 2.8F);
    const float back = rod(q, {65.0F, -26.0F, -23.0F}, {64.0F, 4.0F, -20.0F}, 2.8F, 3.4F);
    return join(front, back, 2.0F);
}

float upper_jaw(const glm::vec3& q) {
    float d = ellipsoid(q, {0.0F, -46.0F, -34.0F}, {33.0F, 31.0F, 22.0F});
    const float ridge = ellipse({parabola_distance(q, -74.0F, 0.046F), q.z + 49.0F}, {5.5F, 8.0F});
    d = join(d, std::max(ridge, q.x - 29.0F), 5.0F);
    // Piriform aperture: a pear, open to the front.
    const float narrow = 11.0F - 0.22F * (q.z + 38.0F);
    const float aperture =
        std::max({q.x - std::min(narrow, 11.5F), std::abs(q.z + 27.0F) - 16.0F, q.y + 40.0F});
    return carve(d, aperture, 3.0F);
}

}  // namespace

float braincase_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = ellipsoid(q, {0.0F, 9.0F, 34.0F}, {66.5F, 81.0F, 59.0F});
    const float beside = std::min(q.x, 32.0F);
    const float anterior = 10.0F + 0.010F * beside * beside;
    const float floor_z = anterior + (1.0F - anterior) * step_between(-36.0F, -14.0F, q.y);
    d = carve(d, q.z - floor_z, 8.0F);
    d = join(d, ellipsoid(q, {37.0F, -12.0F, 3.0F}, {24.0F, 31.0F, 22.0F}), 7.0F);
    return join(d, ellipsoid(q, {0.0F, 47.0F, -6.0F}, {50.0F, 42.0F, 34.0F}), 8.0F);
}

float skull_base_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = ellipsoid(q, {0.0F, -14.0F, -9.0F}, {19.0F, 18.0F, 12.0F});                     // sphenoid
    d = join(d, rod(q, {0.0F, 0.0F, -10.0F}, {0.0F, 22.0F, -38.0F}, 7.0F, 4.0F), 4.0F);       // clivus
    d = join(d, rod(q, {56.0F, 22.0F, -17.0F}, {13.0F, -2.0F, -13.0F}, 10.0F, 5.5F), 4.0F);   // petrous
    d = join(d, ellipsoid(q, {56.0F, 27.0F, -33.0F}, {10.0F, 13.0F, 17.0F}), 9.0F);           // mastoid
    d = join(d, rod(q, {16.0F, -20.0F, -20.0F}, {17.0F, -17.0F, -46.0F}, 3.5F, 2.5F), 3.0F);  // pterygoid
    d = join(d, rod(q, {27.0F, 16.0F, -30.0F}, {22.0F, 30.0F, -42.0F}, 4.0F, 6.0F), 4.0F);    // condyle
    return std::min(d, rod(q, {45.0F, 14.0F, -30.0F}, {40.0F, 2.0F, -50.0F}, 2.5F, 0.9F));    // styloid
}

float vault_thickness(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    const float temple = step_between(46.0F, 62.0F, q.x) * step_between(50.0F, 20.0F, q.z);
    const float brow = step_between(-55.0F, -72.0F, q.y) * step_between(34.0F, 14.0F, q.z);
    const float below = step_between(8.0F, -14.0F, q.z);
    const float crest = sphere(q, {0.0F, 92.0F, 4.0F}, 0.0F);  // external occipital protuberance
    const auto uneven = static_cast<float>(gradient_noise(glm::dvec3(p) / 34.0, 5U));
    return 6.2F - 2.2F * temple + 4.0F * brow - 1.6F * below * (1.0F - brow) + 0.9F * uneven +
           4.0F * step_between(16.0F, 2.0F, crest);
}

float suture_distance(const glm::vec3& p, std::uint32_t seed) {
    // Teeth of the seam: large waves with small ones on them.
    const auto seam = [&](double feature_mm, std::uint32_t salt) {
        return static_cast<float>(gradient_noise(glm::dvec3(p) / feature_mm, seed + salt));
    };
    const float wave = 2.6F * seam(5.0, 31U) + 1.2F * seam(2.6, 32U);
    const float coronal = p.y + 14.0F - 0.20F * (p.z - 93.0F) - 0.0F * p.x + wave;
    const float lambda = p.y - 74.0F + 0.75F * (p.z - 62.0F) + 0.55F * std::abs(p.x) + wave;
    float d = 1e3F;
    if (p.z > 20.0F) {
        d = std::abs(coronal) / 1.02F;
    }
    if (coronal > 0.0F && lambda < 0.0F && p.z > 30.0F) {
        d = std::min(d, std::abs(p.x + wave));
    }
    if (p.z > 0.0F) {
        d = std::min(d, std::abs(lambda) / 1.4F);
    }
    return d;
}

float face_bone_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = upper_jaw(q);
    d = join(d, ellipsoid(q, {46.0F, -54.0F, -21.0F}, {11.0F, 11.0F, 9.0F}), 10.0F);  // zygoma
    d = join(d, orbit_rim(q), 5.0F);
    d = join(d, std::max(orbit_distance(p) - 1.8F, -64.0F - q.y), 4.0F);
    d = join(d, zygomatic_arch(q), 9.0F);
    d = join(d, rod(q, {1.5F, -78.0F, 5.0F}, {2.5F, -89.0F, -15.0F}, 5.0F, 2.2F), 4.0F);    // nasal
    d = join(d, rod(q, {11.0F, -74.0F, 2.0F}, {13.0F, -72.0F, -30.0F}, 3.5F, 4.0F), 4.0F);  // frontal process
    d = join(d, ellipsoid(q, {0.0F, -78.0F, 14.0F}, {30.0F, 5.0F, 7.0F}), 6.0F);            // brow
    return join(d, skull_base_distance(p), 5.0F);
}

float orbit_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    const float cone = rod(q, {32.5F, -66.0F, -1.0F}, {15.0F, -28.0F, 0.0F}, 17.0F, 4.0F);
    const float mouth = rod(q, {32.5F, -66.0F, -1.0F}, {36.0F, -90.0F, -2.0F}, 17.0F, 18.0F);
    return std::min(cone, mouth);
}

float sinus_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = ellipsoid(q, {24.0F, -50.0F, -31.0F}, {9.5F, 17.0F, 14.0F});             // maxillary
    d = std::min(d, ellipsoid(p, {9.0F, -73.0F, 17.0F}, {9.0F, 3.2F, 9.0F}));          // frontal, left
    d = std::min(d, ellipsoid(p, {-8.0F, -73.0F, 15.0F}, {7.0F, 3.0F, 7.0F}));         // frontal, right
    d = std::min(d, ellipsoid(q, {7.5F, -15.0F, -10.0F}, {6.8F, 11.0F, 8.0F}));        // sphenoid
    const float labyrinth = ellipsoid(q, {7.5F, -46.0F, -3.0F}, {5.5F, 18.0F, 8.0F});  // ethmoid
    const float mastoid = ellipsoid(q, {57.0F, 26.0F, -29.0F}, {7.5F, 9.0F, 13.0F});
    if (labyrinth < 1.0F || mastoid < 1.0F) {  // honeycombs
        const auto cells = static_cast<float>(gradient_noise(glm::dvec3(p) / 4.5, 77U));
        d = std::min(
            {d, std::max(labyrinth, 0.9F - 9.0F * std::abs(cells)), std::max(mastoid, 1.1F - 8.0F * cells)});
    }
    return d;
}

float mandible_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    const float rise = 0.0048F * q.x * q.x;
    const float across = parabola_distance(q, -74.0F, 0.035F);
    float body = ellipse({across, q.z + 90.5F - rise}, {6.0F, 18.0F - 0.1F * q.x});
    body = std::max({body, q.x - 46.0F, q.y - 4.0F});
    const float t = std::clamp((q.z + 88.0F) / 50.0F, 0.0F, 1.0F);
    const glm::vec2 axis(45.0F + 4.0F * t, -8.0F + 3.0F * t);
    float ramus = ellipse({q.x - axis.x, q.y - axis.y}, {3.8F, 16.0F - 1.5F * t});
    ramus = std::max({ramus, q.z + 40.0F, -91.0F - q.z + 0.35F * std::max(0.0F, q.y)});
    float d = join(body, ramus, 7.0F);
    d = join(d, rod(q, {49.0F, 3.0F, -44.0F}, {51.0F, 3.0F, -27.0F}, 4.6F, 4.0F), 4.0F);
    d = join(d, ellipsoid(q, {51.0F, 3.0F, -25.0F}, {8.5F, 4.5F, 4.5F}), 2.0F);
    d = join(d, rod(q, {49.0F, -14.0F, -42.0F}, {49.0F, -16.0F, -25.0F}, 4.2F, 1.8F), 4.0F);
    return join(d, ellipsoid(q, {0.0F, -77.0F, -102.0F}, {15.0F, 7.0F, 7.5F}), 5.0F);
}

glm::vec3 vertebra_centre(int level) {
    constexpr std::array<glm::vec3, vertebra_count> centres{{{0.0F, 21.0F, -49.0F},
                                                             {0.0F, 21.0F, -66.0F},
                                                             {0.0F, 20.5F, -84.0F},
                                                             {0.0F, 21.5F, -101.0F},
                                                             {0.0F, 23.5F, -118.0F}}};
    return centres[static_cast<std::size_t>(level - 1)];
}

float vertebra_distance(const glm::vec3& p, int level) {
    const glm::vec3 q = folded(p - vertebra_centre(level));
    const bool atlas = level == 1;
    const float ring_mm = atlas ? 17.0F : 13.5F;
    const glm::vec2 from_canal(q.x, q.y - 18.0F);
    const float ring = std::abs(ellipse(from_canal, {ring_mm, 11.0F})) - 2.2F;
    float d = std::max(ring, std::abs(q.z + 0.25F * (q.y - 18.0F)) - 4.5F);
    if (!atlas) {
        const float drum = std::max(ellipse({q.x, q.y}, {11.5F, 8.5F}), std::abs(q.z) - 6.6F);
        d = join(d, drum, 2.5F);
        const float length = level == 2 ? 22.0F : 15.0F + 2.0F * static_cast<float>(level);
        d = join(d, rod(q, {0.0F, 29.0F, -3.0F}, {2.2F, 29.0F + length, -9.0F}, 3.0F, 2.6F), 3.0F);
    }
    if (level == 2) {  // dens
        d = join(d, rod(q, {0.0F, -1.0F, 6.0F}, {0.0F, -1.0F, 19.0F}, 5.0F, 4.2F), 3.0F);
    }
    d = join(d, ellipsoid(q, {17.0F, 10.0F, 0.0F}, {atlas ? 8.0F : 6.5F, 7.5F, 7.0F}), 3.0F);
    const float reach = atlas ? 36.0F : 26.0F;
    return join(d, rod(q, {16.0F, 6.0F, -1.0F}, {reach, 6.0F, -2.0F}, 4.0F, 2.6F), 3.0F);
}

Tooth tooth(int number, bool upper) {
    // Widths along the arch [mm]; thickness; what the crown lacks in height of the middle incisor's.
    constexpr std::array<float, teeth_per_side> upper_widths{8.5F, 6.5F, 7.6F, 7.0F, 6.8F, 10.0F, 9.4F};
    constexpr std::array<float, teeth_per_side> lower_widths{5.4F, 5.9F, 6.8F, 7.0F, 7.2F, 11.0F, 10.2F};
    constexpr std::array<float, teeth_per_side> thickness{5.0F, 5.0F, 6.6F, 8.0F, 8.4F, 10.0F, 9.8F};
    const auto at = static_cast<std::size_t>(number);
    const auto& widths = upper ? upper_widths : lower_widths;
    float arc = 0.5F * widths[at];
    for (std::size_t i = 0; i < at; ++i) {
        arc += widths[i];
    }
    const float front = upper ? -77.0F : -74.0F;
    constexpr float bend = 0.043F;
    float x = 0.0F;
    for (float walked = 0.0F; walked < arc; walked += 0.05F) {
        x += 0.05F / std::sqrt(1.0F + 4.0F * bend * bend * x * x);
    }
    Tooth made;
    const float slope = 2.0F * bend * x;
    made.along = glm::vec2(1.0F, slope) / std::sqrt(1.0F + slope * slope);
    const float height = number < 2 ? 9.5F : number == 2 ? 10.0F : 7.5F;
    const float bite = -62.0F + 0.06F * x;
    const float overlap = number < 3 ? 1.2F : 0.1F;
    made.half_lengths = {0.5F * widths[at] - 0.15F, 0.42F * thickness[at], 0.5F * height};
    made.centre = {x, front + bend * x * x, bite + (upper ? 0.5F * height - overlap : -0.5F * height - 0.1F)};
    made.root_mm = (upper ? 1.0F : -1.0F) * (number == 2 ? 16.0F : number < 2 ? 12.0F : 13.0F);
    return made;
}

float tooth_distance(const glm::vec3& p, const Tooth& t) {
    const glm::vec3 from = p - t.centre;
    const bool blade = t.half_lengths.y < 2.3F;
    // Incisors get thin towards the edge, and every crown narrows towards its neck.
    const float up = t.root_mm > 0.0F ? from.z : -from.z;
    const float part = std::clamp(up / t.half_lengths.z, -1.0F, 1.0F);
    const glm::vec3 half(t.half_lengths.x * (1.0F - 0.10F * std::max(0.0F, part)),
                         t.half_lengths.y * (blade ? 0.85F + 0.35F * part : 1.0F - 0.08F * part),
                         t.half_lengths.z);
    const glm::vec3 local(from.x * t.along.x + from.y * t.along.y, from.y * t.along.x - from.x * t.along.y,
                          from.z);
    const float crown = rounded_box(local, half, 0.5F * std::min(half.x, half.y));
    const float neck_z = (t.root_mm > 0.0F ? 0.6F : -0.6F) * t.half_lengths.z;
    const float width = 0.62F * std::min(half.x, half.y);
    float root = rod(local, {0.0F, 0.0F, neck_z}, {0.0F, 0.0F, neck_z + t.root_mm}, width, 0.9F);
    if (t.half_lengths.x > 4.5F) {  // molars stand on two
        const glm::vec3 side(std::abs(local.x), local.y, local.z);
        root =
            rod(side, {0.45F * half.x, 0.0F, neck_z}, {0.55F * half.x, 0.0F, neck_z + t.root_mm}, 2.4F, 0.9F);
    }
    return join(crown, root, 1.5F);
}

}  // namespace viscera::assets
