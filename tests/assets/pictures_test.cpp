#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "assets/generate/rays.h"
#include "assets/generate/smoke.h"
#include "assets/generate/thorax.h"
#include "assets/generate/tubes.h"

namespace viscera::assets {
namespace {

constexpr int size = 128;

void expect_sprite(const GrayImage& sprite, const std::string& name) {
    float largest = 0.0F;
    for (int y = 0; y < sprite.height; ++y) {
        for (int x = 0; x < sprite.width; ++x) {
            const float value = sprite.at(x, y);
            ASSERT_TRUE(value >= 0.0F && value <= 1.0F) << name << " at " << x << ", " << y;
            if (x == 0 || y == 0 || x == sprite.width - 1 || y == sprite.height - 1) {
                ASSERT_EQ(value, 0.0F) << name << " at " << x << ", " << y;
            }
            largest = std::max(largest, value);
        }
    }
    EXPECT_GT(largest, 0.5F) << name;
}

double mean(const GrayImage& image, int x0, int y0, int x1, int y1) {
    double sum = 0.0;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            sum += static_cast<double>(image.at(x, y));
        }
    }
    return sum / ((x1 - x0) * (y1 - y0));
}

const Smoke& smoke() {
    static const Smoke made(1);
    return made;
}

TEST(Smoke, sprites_stay_in_range_and_end_at_zero) {
    for (const SmokeView& view : smoke_views) {
        expect_sprite(smoke().project(view, size), std::string(view.name));
    }
}

TEST(Smoke, side_view_starts_at_its_base_and_widens_upwards) {
    const GrayImage side = smoke().project(smoke_views[0], size);
    const auto pixel = [](double t) { return static_cast<int>(std::lround(t * (size - 1))); };
    const auto width = [&](double v) {
        int count = 0;
        for (int x = 0; x < size; ++x) {
            count += side.at(x, pixel(1.0 - v)) > 0.1F ? 1 : 0;
        }
        return count;
    };
    EXPECT_GT(side.at(pixel(0.55), pixel(1.0 - 0.17)), 0.2F);
    EXPECT_EQ(width(0.09), 0);
    EXPECT_GT(width(0.35), width(0.18));
    EXPECT_GT(width(0.5), 2 * width(0.18));
}

TEST(Smoke, neighbouring_views_show_the_same_plume) {
    // The same field turned by 22.5 degrees: far more alike than side and front.
    const auto distance = [](const GrayImage& a, const GrayImage& b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            sum += static_cast<double>(std::abs(a.pixels[i] - b.pixels[i]));
        }
        return sum;
    };
    const GrayImage side = smoke().project(smoke_views[0], size);
    const GrayImage front = smoke().project(smoke_views[4], size);
    EXPECT_LT(distance(side, smoke().project(smoke_views[1], size)), 0.5 * distance(side, front));
}

TEST(Rays, chords_match_closed_forms) {
    const Ray ray{{3.0, -50.0, 0.0}, {0.0, 1.0, 0.0}};
    EXPECT_NEAR((Ellipsoid{{0.0, 0.0, 0.0}, {5.0, 5.0, 5.0}}.chord(ray).length()), 8.0, 1e-12);
    EXPECT_NEAR((Drum{{0.0, 0.0, 1.0}, 5.0, 10.0, 4.0}.chord(ray).length()), 16.0, 1e-12);
    EXPECT_EQ((Drum{{0.0, 0.0, 9.0}, 5.0, 10.0, 4.0}.chord(ray).length()), 0.0);
    EXPECT_EQ((Ellipsoid{{9.0, 0.0, 0.0}, {5.0, 5.0, 5.0}}.chord(ray).length()), 0.0);
}

TEST(Rays, covered_length_counts_overlaps_once) {
    const std::array<Chord, 3> covers{{{2.0, 5.0}, {4.0, 6.0}, {9.0, 20.0}}};
    EXPECT_NEAR(length_outside({0.0, 10.0}, covers), 5.0, 1e-12);
    EXPECT_EQ(length_outside({3.0, 3.0}, covers), 0.0);
}

TEST(Rays, projection_returns_the_pixel_that_a_ray_came_from) {
    const ConeBeam beam(-30.0, -20.0);
    const Ray ray = beam.ray_to(100.0, 900.0);
    const glm::dvec3 pixel = beam.project(ray.origin + 700.0 * ray.direction);
    EXPECT_NEAR(pixel.x, 100.0, 1e-9);
    EXPECT_NEAR(pixel.y, 900.0, 1e-9);
    // The patient's left is on the right of the picture, the head on top.
    EXPECT_GT(ConeBeam(0.0, 0.0).project({10.0, 0.0, 0.0}).x, ConeBeam::pixels / 2);
    EXPECT_LT(ConeBeam(0.0, 0.0).project({0.0, 0.0, 10.0}).y, ConeBeam::pixels / 2);
}

TEST(Tubes, thickness_at_the_axis_is_the_diameter) {
    const ConeBeam beam(0.0, 0.0);
    GrayImage image(ConeBeam::pixels, ConeBeam::pixels);
    draw_tube({.points = {{{0.0, 0.0, -20.0}, 4.0}, {{0.0, 0.0, 20.0}, 4.0}}}, 1.0, beam, image);
    EXPECT_NEAR(image.at(512, 512), 8.0F, 0.02F);
    EXPECT_EQ(image.at(512 + 60, 512), 0.0F);
}

TEST(Thorax, lungs_are_bright_the_heart_is_gray_the_spine_is_dark) {
    const GrayImage thorax = make_thorax(ConeBeam(0.0, 0.0), 1);
    const auto [darkest, lightest] = std::minmax_element(thorax.pixels.begin(), thorax.pixels.end());
    EXPECT_GT(*darkest, 0.15F);  // contrast agent must still stand out on it
    EXPECT_LE(*lightest, 1.0F);
    const double lung = mean(thorax, 900, 200, 1000, 400);
    const double heart = mean(thorax, 600, 450, 700, 600);
    const double spine = mean(thorax, 220, 450, 340, 600);
    EXPECT_GT(lung, heart + 0.1);
    EXPECT_GT(heart, spine + 0.05);
}

}  // namespace
}  // namespace viscera::assets
