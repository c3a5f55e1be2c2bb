#include "assets/generate/organ_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "assets/generate/noise.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

// The gallbladder from its fundus, which hangs out under the liver's edge, to the neck and along the duct.
constexpr glm::vec3 fundus{-40.0F, 4.0F, -38.0F};
constexpr glm::vec3 body{-33.0F, 11.0F, -12.0F};
constexpr glm::vec3 neck{-16.0F, 29.0F, 4.0F};
constexpr glm::vec3 duct{4.0F, 44.0F, 14.0F};

float noise(const glm::vec3& p, double feature_mm, std::uint32_t seed) {
    return static_cast<float>(gradient_noise(glm::dvec3(p) / feature_mm, seed));
}

}  // namespace

OrganField::OrganField(std::uint64_t seed) : seed_(static_cast<std::uint32_t>(seed * 977U + 11U)) {}

float OrganField::liver(const glm::vec3& p) const {
    const float right = ellipsoid(p, {-42.0F, -8.0F, 42.0F}, {76.0F, 50.0F, 78.0F});
    const float left = ellipsoid(p, {56.0F, -14.0F, 46.0F}, {68.0F, 33.0F, 58.0F});
    float d = join(right, left, 34.0F);
    // The lower side is hollow, which leaves a sharp edge in front.
    d = carve(d, ellipsoid(p, {-4.0F, 66.0F, -34.0F}, {150.0F, 66.0F, 76.0F}), 10.0F);
    // The fissure of the round ligament between the lobes: open in front down to the edge.
    d = carve(d, rod(p, {17.0F, -44.0F, 4.0F}, {18.0F, 2.0F, -18.0F}, 3.0F, 7.0F), 12.0F);
    // The bed.
    d = carve(d, rod(p, fundus, neck, 12.0F, 3.0F), 5.0F);
    // A shallow hollow on the front, as a wedge biopsy leaves it: blood stands in it.
    d = carve(d, ellipsoid(p, {-66.0F, -57.0F, 16.0F}, {13.0F, 8.0F, 11.0F}), 4.0F);
    return d + 1.5F * noise(p, 31.0, seed_) + 0.5F * noise(p, 11.0, seed_ + 1U);
}

float OrganField::gallbladder(const glm::vec3& p) const {
    float d = rod(p, fundus, body, 14.0F, 12.5F);
    d = join(d, rod(p, body, neck, 12.5F, 6.0F), 6.0F);
    d = join(d, rod(p, neck, duct, 4.5F, 4.0F), 3.0F);
    return d + 0.35F * noise(p, 9.0, seed_ + 2U);
}

float OrganField::fat(const glm::vec3& p) const {
    const float apron = ellipsoid(p, {0.0F, 86.0F, -22.0F}, {124.0F, 34.0F, 90.0F});
    const float stalk = rod(p, {8.0F, 50.0F, 12.0F}, {22.0F, 72.0F, -10.0F}, 16.0F, 22.0F);
    // Hollows of a few centimetres, which hold what runs down.
    const float lobes = 11.0F * noise(p, 42.0, seed_ + 3U) + 3.0F * noise(p, 17.0, seed_ + 4U) +
                        0.8F * noise(p, 7.0, seed_ + 6U);
    return join(apron, stalk, 14.0F) + lobes;
}

double OrganField::distance(const glm::dvec3& at) const {
    const glm::vec3 p(at);
    // The wide joint fills the wedge where the neck leaves the liver: no grid would hold its tip.
    return join(join(liver(p), gallbladder(p), 12.0F), fat(p), 6.0F);
}

glm::dvec3 OrganField::normal(const glm::dvec3& p) const {
    constexpr double step = 0.05;
    glm::dvec3 gradient(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 offset(0.0);
        offset[axis] = step;
        gradient[axis] = distance(p + offset) - distance(p - offset);
    }
    const double length = glm::length(gradient);
    return length > 0.0 ? gradient / length : glm::dvec3(0.0, 0.0, 1.0);
}

glm::dvec3 OrganField::onto_surface(glm::dvec3 p) const {
    constexpr int steps = 3;
    constexpr double longest_step = 1.5;
    for (int i = 0; i < steps; ++i) {
        p -= std::clamp(distance(p), -longest_step, longest_step) * normal(p);
    }
    return p;
}

OrganTissue OrganField::tissue(const glm::dvec3& at) const {
    const glm::vec3 p(at);
    const std::array<float, 3> d{liver(p), gallbladder(p), fat(p)};
    const float least = std::min({d[0], d[1], d[2]});
    // Where two meet, the border wanders.
    const double ragged = 1.2 + 0.5 * static_cast<double>(noise(p, 3.0, seed_ + 5U));
    std::array<double, 3> weight{};
    double sum = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        const double t = std::clamp(1.0 - static_cast<double>(d[i] - least) / ragged, 0.0, 1.0);
        weight[i] = t * t * (3.0 - 2.0 * t);
        sum += weight[i];
    }
    return {weight[0] / sum, weight[1] / sum, weight[2] / sum};
}

double OrganField::bed_distance(const glm::dvec3& at) const {
    const glm::vec3 p(at);
    // The joint is rounded, so on the line itself both are a little above 0, and equal.
    return std::abs(static_cast<double>(liver(p) - gallbladder(p)));
}

}  // namespace viscera::assets
