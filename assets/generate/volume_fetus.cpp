#include "assets/generate/volume_fetus.h"

#include <cmath>
#include <numbers>

#include "assets/generate/noise.h"
#include "assets/generate/ultrasound_echo.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

using std::numbers::pi;

/// Distance to the skin of a head. x to its left, y out of the face, z to the crown [mm].
float skin_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = ellipsoid(q, {0.0F, -8.0F, 14.0F}, {34.0F, 43.0F, 34.0F});
    d = join(d, ellipsoid(q, {0.0F, 14.0F, -15.0F}, {24.0F, 23.0F, 29.0F}), 16.0F);
    d = join(d, sphere(q, {13.0F, 23.0F, -16.0F}, 12.5F), 9.0F);                        // cheeks
    d = join(d, rod(q, {5.0F, 32.5F, 5.0F}, {16.0F, 28.0F, 4.0F}, 4.5F, 4.0F), 6.0F);   // brows
    d = carve(d, ellipsoid(q, {12.5F, 36.5F, -2.5F}, {8.5F, 6.0F, 5.0F}), 5.0F);        // orbits
    d = join(d, ellipsoid(q, {12.0F, 29.5F, -2.5F}, {7.0F, 4.5F, 4.2F}), 2.0F);         // lids
    d = join(d, rod(q, {0.0F, 33.5F, 0.0F}, {0.0F, 41.0F, -10.0F}, 2.4F, 3.6F), 4.0F);  // nose
    d = join(d, sphere(q, {4.2F, 37.5F, -11.0F}, 2.8F), 2.5F);
    d = join(d, rod(q, {0.0F, 37.5F, -18.6F}, {6.5F, 34.5F, -19.8F}, 2.5F, 1.6F), 2.0F);  // lips
    d = join(d, rod(q, {0.0F, 36.8F, -24.0F}, {6.0F, 34.0F, -23.0F}, 2.6F, 1.6F), 2.0F);
    d = carve(d, rod(q, {0.0F, 40.0F, -21.3F}, {6.5F, 36.5F, -21.4F}, 1.0F, 0.6F), 1.2F);  // mouth
    d = join(d, sphere(q, {0.0F, 30.0F, -32.5F}, 6.5F), 6.0F);                             // chin
    d = join(d, ellipsoid(q, {30.5F, -6.0F, -5.0F}, {4.0F, 7.0F, 10.0F}), 4.0F);           // ears
    return join(d, rod(q, {0.0F, -10.0F, -34.0F}, {0.0F, -16.0F, -90.0F}, 17.0F, 34.0F), 12.0F);
}

/// A fist beside the cheek and its arm.
float hand_distance(const glm::vec3& p) {
    float d = rod(p, {34.0F, 30.0F, -44.0F}, {60.0F, 10.0F, -78.0F}, 8.0F, 11.0F);
    d = join(d, ellipsoid(p, {29.0F, 33.0F, -35.0F}, {9.0F, 8.0F, 10.0F}), 5.0F);
    for (const float finger : {0.0F, 1.0F, 2.0F, 3.0F}) {
        const float z = -29.0F - 4.2F * finger;
        d = join(d, rod(p, {32.0F, 39.0F, z}, {23.0F, 40.0F, z - 1.0F}, 2.4F, 2.2F), 1.2F);
    }
    return join(d, rod(p, {33.0F, 36.0F, -27.0F}, {25.0F, 37.5F, -25.0F}, 2.6F, 2.3F), 2.0F);
}

/// The head turned and bent in front of the probe: a place of the probe's frame in the head's.
glm::vec3 in_head(const glm::dvec3& place) {
    constexpr double turn = 0.42;
    constexpr double bend = 0.16;
    const glm::dvec3 p = place - glm::dvec3(106.0, 2.0, -2.0);
    const glm::dvec2 flat(std::cos(turn) * p.x + std::sin(turn) * p.y,
                          -std::sin(turn) * p.x + std::cos(turn) * p.y);
    const double out = -flat.x;
    return {flat.y, std::cos(bend) * out + std::sin(bend) * p.z,
            -std::sin(bend) * out + std::cos(bend) * p.z};
}

/// [dB] and the loss behind it [dB per mm].
struct Tissue {
    double echo;
    double loss;
};

Tissue inside_skull(const glm::vec3& h, float depth, std::uint32_t salt) {
    if (depth < 2.2F) {
        return {-6.0, 2.2};
    }
    const glm::vec3 q = folded(h);
    const bool middle = q.x < 0.8F && h.z > -8.0F;
    const bool ventricle = ellipsoid(q, {8.0F, -6.0F, 14.0F}, {4.0F, 17.0F, 6.0F}) < 0.0F;
    const bool plexus = ellipsoid(q, {9.0F, -14.0F, 13.0F}, {3.0F, 8.0F, 4.0F}) < 0.0F;
    return {middle      ? -12.0
            : plexus    ? -14.0
            : ventricle ? -48.0
                        : -28.0 + 4.0 * gradient_noise(glm::dvec3(h) / 7.0, salt),
            0.05};
}

Tissue tissue_at(const glm::dvec3& place, double radius, std::uint32_t salt) {
    const double front = 49.0 + 3.0 * gradient_noise(place / 25.0, salt + 1U);
    const double back = 141.0 + 4.0 * gradient_noise(place / 30.0, salt + 2U);
    if (radius < front || radius > back) {
        return {-16.0, 0.06};  // the womb's wall
    }
    const glm::vec3 h = in_head(place);
    const float skin = std::min(skin_distance(h), hand_distance(h));
    if (skin > 0.0F) {
        return {-62.0 + 6.0 * gradient_noise(place / 4.0, salt + 3U), 0.0};  // water
    }
    const float skull = ellipsoid(h, {0.0F, -8.0F, 14.0F}, {31.5F, 40.0F, 31.5F});
    if (skull < 0.0F) {
        return inside_skull(h, -skull, salt + 4U);
    }
    return {skin > -1.2F ? -9.0 : -17.0, 0.12};  // skin, and what is below
}

}  // namespace

Volume make_fetus(std::uint64_t seed, int coarser) {
    Volume volume{.type = ScalarType::u8, .voxels = {}};
    VolumeGrid& grid = volume.grid;
    grid.dims = glm::ivec3(128, 116, 140) / coarser;
    const double longitude = 84.0 * pi / 180.0;
    const double latitude = 76.0 * pi / 180.0;
    constexpr double near_mm = 45.0;
    constexpr double far_mm = 150.0;
    grid.shape = {.kind = VolumeKind::spherical,
                  .r_min_mm = near_mm,
                  .r_max_mm = far_mm,
                  .first_angle_rad = -0.5 * longitude,
                  .angle_rad = longitude,
                  .latitude_rad = latitude};
    const double radius_step = (far_mm - near_mm) / (grid.dims.z - 1);
    const glm::dvec2 angle_step(longitude / (grid.dims.x - 1), latitude / (grid.dims.y - 1));
    grid.spacing_mm = {100.0 * angle_step.x, 100.0 * angle_step.y,
                       radius_step};  // for programs that show it unrolled
    const auto salt = static_cast<std::uint32_t>(seed);
    const auto dims = glm::u64vec3(grid.dims);
    volume.voxels.resize(dims.x * dims.y * dims.z);
    for (std::size_t j = 0; j < dims.y; ++j) {
        for (std::size_t i = 0; i < dims.x; ++i) {
            const double lon = -0.5 * longitude + static_cast<double>(i) * angle_step.x;
            const double lat = -0.5 * latitude + static_cast<double>(j) * angle_step.y;
            const glm::dvec3 beam(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon),
                                  std::sin(lat));
            double lost_db = 0.0;
            for (std::size_t k = 0; k < dims.z; ++k) {
                const double radius = near_mm + static_cast<double>(k) * radius_step;
                const Tissue tissue = tissue_at(radius * beam, radius, salt);
                const glm::dvec3 grain(lon / 0.02, lat / 0.024, radius / 1.1);
                volume.voxels[i + dims.x * (j + dims.y * k)] =
                    gray_of(tissue.echo - lost_db, speckle(grain, salt + 7U));
                lost_db = std::min(lost_db + radius_step * tissue.loss, 45.0);
            }
        }
    }
    return volume;
}

}  // namespace viscera::assets
