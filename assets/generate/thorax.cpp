#include "assets/generate/thorax.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "assets/generate/heart.h"
#include "assets/generate/noise.h"
#include "assets/generate/random.h"
#include "assets/generate/tubes.h"

namespace viscera::assets {
namespace {

// Attenuation at about 80 kVp [1/mm]: of soft tissue, and what bone adds to it.
constexpr double soft_tissue = 0.02;
constexpr double lung_tissue = 0.006;
constexpr double spongy_bone = 0.011;
constexpr double dense_bone = 0.05;

constexpr double spine_x = -27.0;
constexpr double spine_y = 70.0;
constexpr double vertebra_pitch = 25.5;

/// Adds `added` times the length of each ray inside a body to the picture.
template <typename Body>
void draw_body(const Body& body, double reach_mm, double added, const ConeBeam& beam, GrayImage& integral) {
    const glm::dvec3 middle = beam.project(body.centre);
    const double reach = 1.1 * reach_mm * middle.z;
    const int left = std::max(0, static_cast<int>(middle.x - reach));
    const int right = std::min(integral.width - 1, static_cast<int>(middle.x + reach));
    const int top = std::max(0, static_cast<int>(middle.y - reach));
    const int bottom = std::min(integral.height - 1, static_cast<int>(middle.y + reach));
    for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
            integral.at(x, y) += static_cast<float>(added * body.chord(beam.ray_to(x, y)).length());
        }
    }
}

/// Nine thoracic vertebrae: body with denser shell and end plates, pedicles, transverse and spinous
/// processes.
void draw_spine(const ConeBeam& beam, GrayImage& integral) {
    const auto drum = [&](const glm::dvec3& centre, const glm::dvec3& half, double added) {
        draw_body(Drum{centre, half.x, half.y, half.z}, glm::length(half), added, beam, integral);
    };
    const auto lump = [&](const glm::dvec3& centre, const glm::dvec3& half, double added) {
        draw_body(Ellipsoid{centre, half}, std::max({half.x, half.y, half.z}), added, beam, integral);
    };
    for (int level = -4; level <= 4; ++level) {
        const double z = 7.0 + level * vertebra_pitch;
        const glm::dvec3 centre(spine_x + 1.5 * std::sin(0.011 * z), spine_y - 0.0006 * z * z, z);
        const double size = 1.0 - 0.03 * level;
        drum(centre, {16.0 * size, 14.0 * size, 10.6}, 0.35 * dense_bone);
        drum(centre, {14.9 * size, 12.9 * size, 9.8}, spongy_bone - 0.35 * dense_bone);
        for (const double side : {-1.0, 1.0}) {
            drum(centre + glm::dvec3(0.0, 0.0, side * 10.4), {16.6 * size, 14.3 * size, 1.1}, 0.006);
            const glm::dvec3 pedicle = centre + glm::dvec3(side * 11.5 * size, 18.0, 3.0);
            lump(pedicle, {4.2, 6.0, 6.4}, dense_bone);
            lump(pedicle, {2.6, 6.0, 4.7}, -0.7 * dense_bone);
            lump(centre + glm::dvec3(side * 23.0 * size, 26.0, 3.0), {12.0, 5.0, 4.6}, 0.3 * dense_bone);
        }
        lump(centre + glm::dvec3(0.0, 36.0, -9.0), {2.8, 13.0, 9.0}, 0.3 * dense_bone);
    }
}

/// One rib of the cage: from the spine outward and down, around the side, towards the breast bone.
Tube make_rib(double side, double z_mm, double radius_mm) {
    Tube rib;
    for (int i = 0; i <= 60; ++i) {
        const double t = i / 60.0;
        const double around = glm::radians(4.0 + 150.0 * t);
        const double drop = 24.0 * std::sin(around) + 88.0 * std::pow(std::sin(0.5 * around), 2.4);
        // The neck hides behind the spine; in front, bone goes over into cartilage.
        const double ends = std::min({1.0, 0.2 + 7.0 * t, 7.0 * (1.0 - t)});
        rib.points.push_back(
            {{spine_x + side * 132.0 * std::sin(around), 2.0 + 92.0 * std::cos(around), z_mm - drop},
             radius_mm * (1.0 + 0.15 * t),
             ends});
    }
    return rib;
}

void draw_ribs(const ConeBeam& beam, GrayImage& integral) {
    for (int level = -5; level <= 6; ++level) {
        for (const double side : {-1.0, 1.0}) {
            const double z = 10.0 + level * vertebra_pitch + (side > 0.0 ? 0.8 : -0.6);
            draw_tube(make_rib(side, z, 5.6), 0.62 * dense_bone, beam, integral);
            draw_tube(make_rib(side, z, 4.5), -0.5 * dense_bone, beam, integral);
        }
    }
}

/// One artery of the lung and what grows on it.
void draw_lung_vessel(Random& random, glm::dvec3 from, glm::dvec3 heading, double radius_mm, double length_mm,
                      const ConeBeam& beam, GrayImage& integral) {
    Tube vessel;
    vessel.points.push_back({from, radius_mm});
    constexpr int steps = 8;
    for (int i = 1; i <= steps; ++i) {
        const glm::dvec3 sway(random.normal(), random.normal(), random.normal());
        heading = glm::normalize(heading + 0.12 * sway);
        from += heading * (length_mm / steps);
        vessel.points.push_back({from, radius_mm * (1.0 - 0.3 * i / steps)});
    }
    draw_tube(vessel, soft_tissue - lung_tissue, beam, integral);
    if (radius_mm < 0.5) {
        return;
    }
    const glm::dvec3 across =
        glm::normalize(glm::cross(heading, {random.normal(), random.normal(), random.normal()}));
    for (const double side : {-1.0, 1.0}) {
        const double spread = random.uniform(0.3, 0.75);
        draw_lung_vessel(random, from, glm::normalize(heading + side * spread * across),
                         radius_mm * random.uniform(0.55, 0.72), length_mm * random.uniform(0.7, 0.9), beam,
                         integral);
    }
}

void draw_lung_vessels(std::uint64_t seed, const ConeBeam& beam, GrayImage& integral) {
    Random random(seed);
    for (const double side : {-1.0, 1.0}) {
        const glm::dvec3 hilum(spine_x + side * 38.0, 18.0, 34.0);
        for (int i = 0; i < 11; ++i) {
            const double turn = glm::radians(-75.0 + 150.0 * i / 10.0 + random.uniform(-8.0, 8.0));
            const glm::dvec3 heading(side * std::cos(turn), random.uniform(-0.5, 0.5), std::sin(turn));
            draw_lung_vessel(random, hilum + 6.0 * heading, glm::normalize(heading), random.uniform(2.8, 4.4),
                             30.0, beam, integral);
        }
    }
}

/// Trunk, lungs and what displaces them.
class SoftTissue {
  public:
    SoftTissue() {
        const Heart heart;
        solid_[0] = {heart.centre(), heart.half_lengths() + 3.0, heart.axes()};
        solid_[1] = {{-32.0, -10.0, -4.0}, {31.0, 34.0, 42.0}, glm::dmat3(1.0)};   // right heart
        solid_[2] = {{-16.0, 18.0, 78.0}, {26.0, 30.0, 26.0}, glm::dmat3(1.0)};    // aortic arch
        solid_[3] = {{2.0, -10.0, 46.0}, {22.0, 22.0, 24.0}, glm::dmat3(1.0)};     // pulmonary trunk
        solid_[4] = {{-48.0, 2.0, 70.0}, {13.0, 14.0, 70.0}, glm::dmat3(1.0)};     // superior vena cava
        solid_[5] = {{spine_x, 66.0, 0.0}, {27.0, 46.0, 260.0}, glm::dmat3(1.0)};  // around the spine
        solid_[6] = {{38.0, 4.0, -142.0}, {100.0, 104.0, 90.0}, glm::dmat3(1.0)};  // left dome
        solid_[7] = {{-98.0, 4.0, -130.0}, {96.0, 104.0, 92.0}, glm::dmat3(1.0)};  // right dome, liver
        solid_[8] = {{-9.0, 62.0, 20.0}, {12.5, 12.5, 160.0}, glm::dmat3(1.0)};    // descending aorta
    }
    /// Line integral of attenuation.
    [[nodiscard]] double integral(const Ray& ray) const {
        std::array<Chord, 9> covers{};
        std::transform(solid_.begin(), solid_.end(), covers.begin(),
                       [&](const Ellipsoid& e) { return e.chord(ray); });
        double air = 0.0;
        for (const Ellipsoid& lung : lungs_) {
            air += length_outside(lung.chord(ray), covers);
        }
        const double gas = gas_bubble_.chord(ray).length();
        return soft_tissue * (trunk_.chord(ray).length() - gas) - (soft_tissue - lung_tissue) * air;
    }

  private:
    Ellipsoid trunk_{{spine_x, 8.0, -20.0}, {185.0, 122.0, 420.0}, glm::dmat3(1.0)};
    std::array<Ellipsoid, 2> lungs_{{{{spine_x + 74.0, 4.0, 20.0}, {66.0, 94.0, 150.0}, glm::dmat3(1.0)},
                                     {{spine_x - 74.0, 4.0, 20.0}, {68.0, 94.0, 150.0}, glm::dmat3(1.0)}}};
    Ellipsoid gas_bubble_{{44.0, -14.0, -73.0}, {23.0, 18.0, 11.0}, glm::dmat3(1.0)};
    std::array<Ellipsoid, 9> solid_;
};

/// Detector picture of line integrals: automatic exposure, compressed range, unsharpness, noise.
void expose(GrayImage& image, std::uint64_t seed) {
    constexpr double range = 0.3;      // of the logarithm's range that the display keeps
    constexpr float brightest = 0.9F;  // where the lightest hundredth lies
    blur(image, 1.6);
    std::vector<float> sorted = image.pixels;
    const auto light = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 100);
    std::nth_element(sorted.begin(), light, sorted.end());
    GrayImage noise(image.width, image.height);
    Random random(seed);
    for (float& value : noise.pixels) {
        value = static_cast<float>(random.normal());
    }
    blur(noise, 0.8);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float transmission =
            brightest * static_cast<float>(std::exp(-range * static_cast<double>(image.pixels[i] - *light)));
        // Fewer quanta reach dark parts: relative noise grows as one over the root of the dose.
        const float grain = 0.02F * noise.pixels[i] * std::sqrt(transmission);
        image.pixels[i] = std::clamp(transmission + grain, 0.0F, 1.0F);
    }
}

}  // namespace

GrayImage make_thorax(const ConeBeam& beam, std::uint64_t seed) {
    GrayImage image(ConeBeam::pixels, ConeBeam::pixels);
    const SoftTissue soft;
    const auto shape_seed = static_cast<std::uint32_t>(seed);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            // Organs are no ellipsoids: their outlines are bent, and tissue is uneven.
            const glm::dvec3 place(4.0 * x / image.width, 4.0 * y / image.height, 0.5);
            const double bend_x = 24.0 * fractal_noise(place, 2, shape_seed);
            const double bend_y = 24.0 * fractal_noise(place, 2, shape_seed + 50U);
            image.at(x, y) = static_cast<float>(soft.integral(beam.ray_to(x + bend_x, y + bend_y)) +
                                                0.12 * fractal_noise(2.0 * place, 3, shape_seed + 90U));
        }
    }
    blur(image, 3.0);  // the heart and the diaphragm move during the exposure
    draw_lung_vessels(seed + 1, beam, image);
    draw_spine(beam, image);
    draw_ribs(beam, image);
    expose(image, seed + 2);
    return image;
}

}  // namespace viscera::assets
