#include "assets/generate/volume_head_skin.h"

#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

/// Neck: oval, leaning to the front on its way up.
float neck_of(const glm::vec3& q) {
    const float middle_y = 22.0F - 0.16F * (q.z + 60.0F);
    const float d = ellipse({q.x, q.y - middle_y}, {55.0F, 52.0F});
    return carve(d, -(q.z + 40.0F), 20.0F);
}

/// Auricle: a dish that stands off the head, its rim thicker than its floor.
float ear(const glm::vec3& q) {
    constexpr float cosine = 0.88F;  // turned outwards by 28 degrees, and leaning back by 12
    constexpr float sine = 0.475F;
    const glm::vec3 from = q - glm::vec3(76.0F, 19.0F, -13.0F);
    const float back = 0.978F * from.y - 0.208F * from.z;
    const float up = 0.978F * from.z + 0.208F * from.y;
    const glm::vec3 local(cosine * from.x - sine * back, cosine * back + sine * from.x, up);
    const float narrow = 1.0F - 0.007F * std::max(0.0F, -local.z);  // towards the lobe
    const float disc = ellipsoid(local, {0.0F, 0.0F, 0.0F}, {5.5F, 17.0F * narrow, 31.0F});
    const float dish = ellipsoid(local, {5.0F, -2.0F, 4.0F}, {5.2F, 11.5F, 21.0F});
    const float concha = ellipsoid(local, {3.0F, -5.0F, -6.0F}, {6.0F, 7.0F, 10.0F});
    const float fold = rod(local, {2.0F, 6.0F, -12.0F}, {2.0F, 5.0F, 17.0F}, 2.0F, 2.2F);
    const float shell = carve(join(carve(disc, dish, 2.0F), fold, 2.5F), concha, 2.5F);
    return join(shell, sphere(q, {76.0F, 6.0F, -17.0F}, 3.5F), 3.0F);  // tragus
}

float nose(const glm::vec3& q) {
    float d = rod(q, {0.0F, -78.0F, 4.0F}, {0.0F, -96.0F, -34.0F}, 6.0F, 8.2F);
    d = join(d, sphere(q, {0.0F, -97.5F, -36.5F}, 8.0F), 4.0F);
    d = join(d, ellipsoid(q, {11.0F, -88.0F, -40.0F}, {6.0F, 9.0F, 6.0F}), 7.0F);
    return d;
}

float lips(const glm::vec3& q) {
    const float bow = 1.6F * step_between(0.0F, 5.0F, q.x) - 0.006F * q.x * q.x;
    const glm::vec3 upper(q.x, q.y + 0.010F * q.x * q.x * -1.0F, q.z - bow);
    const glm::vec3 lower(q.x, q.y - 0.012F * q.x * q.x, q.z);
    return std::min(ellipsoid(upper, {0.0F, -86.5F, -58.2F}, {25.0F, 7.0F, 4.6F}),
                    ellipsoid(lower, {0.0F, -85.0F, -67.6F}, {22.0F, 7.0F, 5.4F}));
}

/// Closed lids over the eyeball, in a hollow under the brow.
float with_eyes(float d, const glm::vec3& q) {
    d = carve(d, ellipsoid(q, {32.0F, -90.0F, -2.0F}, {17.0F, 14.0F, 10.5F}), 9.0F);
    d = carve(d, ellipsoid(q, {15.0F, -88.0F, -1.0F}, {5.0F, 9.0F, 6.0F}), 7.0F);
    d = join(d, sphere(q, {32.0F, -66.5F, -2.5F}, 14.0F), 4.0F);
    const float droop = 0.012F * (q.x - 32.0F) * (q.x - 32.0F);
    return carve(d, ellipsoid({q.x, q.y, q.z - droop}, {32.0F, -81.0F, -6.5F}, {13.0F, 4.0F, 0.9F}), 1.2F);
}

float with_mouth(float d, const glm::vec3& q) {
    d = join(d, lips(q), 3.5F);
    const float curve = q.y - 0.012F * q.x * q.x;
    d = carve(d, ellipsoid({q.x, curve, q.z}, {0.0F, -94.0F, -62.6F}, {24.0F, 9.0F, 1.2F}), 1.6F);
    d = carve(d, ellipsoid({q.x, curve, q.z}, {0.0F, -93.0F, -80.0F}, {19.0F, 9.5F, 5.0F}), 7.0F);
    return carve(d, rod(q, {0.0F, -94.0F, -47.0F}, {0.0F, -96.5F, -54.5F}, 2.2F, 2.8F), 3.0F);  // philtrum
}

float nasal_cavity(const glm::vec3& q) {
    const float hollow = nasal_hollow_distance(q);
    const float septum = q.x - 1.6F;
    const float lower = rod(q, {9.5F, -68.0F, -37.0F}, {9.0F, -28.0F, -37.0F}, 3.8F, 3.8F);
    const float middle = rod(q, {7.5F, -60.0F, -24.0F}, {7.0F, -28.0F, -26.0F}, 3.2F, 3.0F);
    return std::max({hollow, -septum, -lower, -middle});
}

}  // namespace

float skin_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = ellipsoid(q, {0.0F, 9.0F, 32.0F}, {76.5F, 94.0F, 73.0F});
    d = join(d, ellipsoid(q, {0.0F, -30.0F, -28.0F}, {62.0F, 51.0F, 62.0F}), 22.0F);
    d = join(d, ellipsoid(q, {0.0F, -32.0F, -78.0F}, {51.0F, 45.0F, 29.0F}), 16.0F);
    d = join(d, neck_of(q), 16.0F);
    d = join(d, ellipsoid(q, {0.0F, 8.0F, -14.0F}, {71.0F, 68.0F, 52.0F}), 26.0F);
    d = join(d, ellipsoid(q, {0.0F, 46.0F, -4.0F}, {60.0F, 54.5F, 44.0F}), 20.0F);
    d = join(d, ellipsoid(q, {56.0F, 24.0F, -34.0F}, {15.0F, 19.0F, 22.0F}), 16.0F);
    d = join(d, rod(q, {52.0F, -48.0F, -24.0F}, {62.0F, 0.0F, -24.0F}, 9.0F, 9.0F), 16.0F);
    float jaw = rod(q, {7.0F, -66.0F, -95.0F}, {39.0F, -14.0F, -84.0F}, 15.5F, 15.0F);
    jaw = join(jaw, rod(q, {39.0F, -14.0F, -84.0F}, {45.0F, -4.0F, -34.0F}, 15.0F, 14.0F), 10.0F);
    d = join(d, jaw, 14.0F);
    d = join(d, ellipsoid(q, {0.0F, -62.0F, -62.0F}, {31.0F, 25.0F, 22.0F}), 14.0F);
    d = join(d, ellipsoid(q, {0.0F, -71.0F, -98.0F}, {18.0F, 14.0F, 12.5F}), 12.0F);
    d = join(d, ellipsoid(q, {45.0F, -50.0F, -28.0F}, {18.0F, 21.0F, 17.0F}), 14.0F);
    d = join(d, ellipsoid(q, {21.0F, -73.0F, 13.0F}, {23.0F, 11.0F, 7.0F}), 9.0F);
    d = join(d, ellipsoid(q, {46.0F, -48.0F, 6.0F}, {15.0F, 20.0F, 15.0F}), 12.0F);
    if (q.y < -40.0F) {
        d = with_eyes(d, q);
        d = join(d, nose(q), 10.0F);
        d = carve(d, ellipsoid(q, {6.0F, -93.0F, -44.5F}, {2.8F, 4.6F, 4.6F}), 2.0F);
        d = with_mouth(d, q);
    }
    if (q.x > 55.0F) {
        d = join(d, ear(q), 4.0F);
        d = carve(d, rod(q, {84.0F, 11.0F, -19.0F}, {54.0F, 13.0F, -19.0F}, 3.2F, 2.8F), 1.5F);
    }
    return d;
}

float nasal_hollow_distance(const glm::vec3& p) {
    return ellipsoid(p, {0.0F, -48.0F, -27.0F}, {14.0F, 36.0F, 20.0F});
}

float airway_distance(const glm::vec3& p) {
    const glm::vec3 q = folded(p);
    float d = nasal_cavity(q);
    d = std::min(d, rod(q, {6.0F, -93.0F, -45.0F}, {5.0F, -74.0F, -36.0F}, 2.8F, 4.0F));
    float throat = rod(q, {0.0F, -18.0F, -30.0F}, {0.0F, -5.0F, -46.0F}, 9.0F, 8.0F);
    throat = join(throat, rod(q, {0.0F, -5.0F, -46.0F}, {0.0F, -4.0F, -84.0F}, 8.0F, 6.5F), 4.0F);
    throat = join(throat, rod(q, {0.0F, -4.0F, -84.0F}, {0.0F, -12.0F, -130.0F}, 6.5F, 8.5F), 4.0F);
    d = std::min(d, throat);
    const float mouth = ellipsoid(q, {0.0F, -42.0F, -57.5F}, {20.0F, 26.0F, 1.4F});
    return std::min(d, mouth);
}

}  // namespace viscera::assets
