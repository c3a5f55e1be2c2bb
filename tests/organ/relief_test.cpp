#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "engine/io/exr.h"
#include "engine/io/png.h"
#include "tests/organ/organ_stage.h"

// Relief from maps against the normal that the displaced surface has itself.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr double size_mm = 60.0;
constexpr double amplitude_mm = 0.8;
constexpr double wave_number = 2.0 * std::numbers::pi / 20.0;  // [1/mm]
constexpr glm::dvec3 light(0.5, -0.8, 0.3);
constexpr double share = 0.9;

double slope_at(double x_mm) {
    return amplitude_mm * wave_number * std::cos(wave_number * x_mm);
}

struct Way {
    const char* name;
    double turn_deg;
    double scale;
    bool mirrored;
    double stretch = 1.0;
};
constexpr std::array<Way, 5> ways{{{"straight", 0, 1, false},
                                   {"turned by 37 degrees", 37, 0.6, false},
                                   {"turned by 180 degrees", 180, 1, false},
                                   {"mirrored", 0, 1, true},
                                   {"stretched", 0, 1, false, 0.4}}};

class Relief : public testing::Test {
  protected:
    Relief() {
        look_at(0.0);
        s.parameters["colour"] = {1, 1, 1};
        s.parameters["shading"] = {{"ambient", 0}, {"diffuse", share}, {"specular", 0}};
        s.parameters["lights"] = {
            {{"place", "infinity"}, {"position", {light.x, light.y, light.z}}, {"angular", 0}}};
    }
    /// So near that no pixel is as large as a texel of these maps: what is seen is the map itself, not one of
    /// its smaller copies.
    void look_at(double x_mm) {
        centre_mm_ = x_mm;
        s.camera = {{"kind", "orthographic"},
                    {"eye_mm", {x_mm, -200, 0}},
                    {"target_mm", {x_mm, 0, 0}},
                    {"height_mm", view_mm}};
    }
    /// Of what is seen at places all over the patch.
    double largest_error_anywhere() {
        double worst = 0.0;
        for (const double x_mm : {-21.0, -8.5, 4.0, 17.3}) {
            look_at(x_mm);
            worst = std::max(worst, largest_error(s.render()));
        }
        return worst;
    }
    void use_patch(const Way& way, double bend_mm = 0.0, int cells = 6) {
        s.use_mesh(patch_obj({.cells = cells,
                              .size_mm = size_mm,
                              .bend_mm = bend_mm,
                              .uv_turn_deg = way.turn_deg,
                              .uv_scale = way.scale,
                              .uv_stretch = way.stretch,
                              .mirrored_uv = way.mirrored}));
    }
    /// World x [mm] of a place in the texture, and the world's x direction along u and v.
    static double x_of(const Way& way, double u, double v) {
        const double t = way.turn_deg * std::numbers::pi / 180.0;
        const double a = (std::cos(t) * (u - 0.5) + std::sin(t) * (v - 0.5)) / way.scale / way.stretch;
        return size_mm * (way.mirrored ? -a : a);
    }
    static glm::dvec2 along(const Way& way) {
        const double t = way.turn_deg * std::numbers::pi / 180.0;
        return (way.mirrored ? -1.0 : 1.0) * glm::dvec2(std::cos(t), std::sin(t));
    }
    /// What the displaced plane shows: its own normal, under a light at infinity.
    double largest_error(const Image& image) {
        double worst = 0.0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const double x_mm =
                    centre_mm_ + view_mm * ((x + 0.5) / image.width - 0.5) * image.width / image.height;
                const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope_at(x_mm), -1.0, 0.0));
                const double wanted = share * std::max(glm::dot(normal, glm::normalize(light)), 0.0);
                worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y, 0)) - wanted));
            }
        }
        return worst;
    }
    static constexpr double view_mm = 6.0;
    double centre_mm_ = 0.0;
    OrganStage s{64, 64};
};

TEST_F(Relief, OfAFloatMapIsTheDisplacedSurfaces) {
    for (const Way& way : ways) {
        use_patch(way);
        constexpr int texels = 512;
        s.parameters["normal_map"] = {
            {"encoding", "signed"},
            {"map", s.picture_file(std::string(way.name) + ".exr", texels, [&](double u, double v, int c) {
                 const glm::dvec2 slopes = slope_at(x_of(way, u, v)) * along(way);
                 const glm::dvec3 n = glm::normalize(glm::dvec3(-slopes, 1.0));
                 return c == 3 ? 1.0F : static_cast<float>(n[c]);
             })}};
        // Between texels slopes are mixed: h^2 / 8 of their second derivative at most, in both directions.
        const double step_mm = size_mm / way.scale / way.stretch / texels;
        const double mixing = 2.0 * step_mm * step_mm / 8.0 * amplitude_mm * std::pow(wave_number, 3.0);
        const double error = largest_error_anywhere();
        std::printf("  float map, %-24s %.2e (bound %.2e)\n", way.name, error, mixing + 2e-6);
        EXPECT_LE(error, mixing + 2e-6) << way.name;
        EXPECT_TRUE(s.stage().complaints().empty()) << s.stage().complaints().front();
    }
}

TEST_F(Relief, OfAnEightBitMapIsTheDisplacedSurfacesWithinQuantisation) {
    for (const Way& way : ways) {
        use_patch(way);
        constexpr int texels = 256;
        Image map = make_image(texels, texels, PixelFormat::rgba8);
        for (int y = 0; y < texels; ++y) {
            for (int x = 0; x < texels; ++x) {
                const glm::dvec2 slopes =
                    slope_at(x_of(way, (x + 0.5) / texels, (y + 0.5) / texels)) * along(way);
                const glm::dvec3 n = glm::normalize(glm::dvec3(-slopes, 1.0));
                for (int c = 0; c < 3; ++c) {
                    map.set(x, y, c, static_cast<float>((std::round(127.0 * n[c]) + 128.0) / 255.0));
                }
            }
        }
        const auto file = s.folder / (std::string(way.name) + ".png");
        io::write_png(file, map, {.alpha = false});
        s.parameters["normal_map"] = {{"map", file.string()}};
        // Half a step in each component of a normal, whose z is at least 1 / sqrt(1 + slope^2).
        const double steepest = amplitude_mm * wave_number;
        const double quantum = 0.5 / 127.0 * std::sqrt(1.0 + steepest * steepest) * (1.0 + steepest);
        const double error = largest_error_anywhere();
        std::printf("  8-bit map, %-24s %.2e (bound %.2e)\n", way.name, error, std::sqrt(2.0) * quantum);
        EXPECT_LE(error, std::sqrt(2.0) * quantum) << way.name;
    }
}

TEST_F(Relief, OfAHeightIsTheDisplacedSurfaces) {
    for (const Way& way : ways) {
        OrganStage of_height(64, 64);
        of_height.camera = s.camera;
        of_height.parameters = s.parameters;
        of_height.use_mesh(patch_obj({.cells = 6,
                                      .size_mm = size_mm,
                                      .bend_mm = 0.0,
                                      .uv_turn_deg = way.turn_deg,
                                      .uv_scale = way.scale,
                                      .uv_stretch = way.stretch,
                                      .mirrored_uv = way.mirrored}));
        constexpr int texels = 512;
        of_height.target("tissue.blood_color", 2, [](double, double, int c) { return c == 3 ? 0.0F : 1.0F; });
        of_height.target("tissue.blood_height", texels, [&](double u, double v, int) {
            return static_cast<float>(amplitude_mm * std::sin(wave_number * x_of(way, u, v)));
        });
        const Image image = of_height.render();
        // Central differences and mixing, of second order both; and the heights' own digits.
        const double step_mm = size_mm / way.scale / way.stretch / texels;
        const double bound =
            (1.0 / 6.0 + 2.0 / 8.0) * step_mm * step_mm * amplitude_mm * std::pow(wave_number, 3.0) +
            1.2e-7 * amplitude_mm / step_mm + 2e-6;
        const double error = largest_error(image);
        std::printf("  height, %-27s %.2e (bound %.2e)\n", way.name, error, bound);
        EXPECT_LE(error, bound) << way.name;
        s.stage().make_current();
    }
}

TEST_F(Relief, OfAFlatMapChangesNoBit) {
    use_patch(ways[1], 12.0);
    s.parameters["shading"]["specular"] = 0.4;
    const Image plain = s.render();
    Image flat = make_image(8, 8, PixelFormat::rgba8);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            flat.set(x, y, 0, 128.0F / 255.0F);
            flat.set(x, y, 1, 128.0F / 255.0F);
            flat.set(x, y, 2, 1.0F);
        }
    }
    io::write_png(s.folder / "flat.png", flat, {.alpha = false});
    s.parameters["normal_map"] = {{"map", (s.folder / "flat.png").string()}};
    EXPECT_EQ(s.render().data, plain.data);
    s.parameters["normal_map"]["map"] =
        s.picture_file("flat.exr", 8, [](double, double, int c) { return c < 2 ? 0.5F : 1.0F; });
    EXPECT_EQ(s.render().data, plain.data);
}

TEST_F(Relief, TurningTheTextureTurnsNothingInTheWorld) {
    // The same relief, one of x alone, in textures laid on a bent surface in five ways. On it a map holds
    // what the height rises by per millimetre along the surface, in the directions of u and v.
    constexpr double bend_mm = 6.0;
    const double k = std::numbers::pi / size_mm;
    s.parameters["shading"]["specular"] = 0.4;
    look_at(9.0);
    std::vector<Image> images;
    for (const Way& way : ways) {
        use_patch(way, bend_mm, 60);
        const double t = way.turn_deg * std::numbers::pi / 180.0;
        const double mirror = way.mirrored ? -1.0 : 1.0;
        const auto normal = [&](double u, double v, int c) {
            const double x = x_of(way, u, v);
            const double z = size_mm * (std::cos(t) * (v - 0.5) - std::sin(t) * (u - 0.5)) / way.scale;
            const glm::dvec3 along_x(1.0, bend_mm * k * std::sin(k * x) * std::cos(k * z), 0.0);
            const glm::dvec3 along_z(0.0, bend_mm * k * std::cos(k * x) * std::sin(k * z), 1.0);
            const glm::dvec3 along_u = mirror * std::cos(t) * along_x - std::sin(t) * along_z;
            const glm::dvec3 along_v = mirror * std::sin(t) * along_x + std::cos(t) * along_z;
            const glm::dvec2 slopes =
                slope_at(x) * glm::dvec2(along_u.x / glm::length(along_u), along_v.x / glm::length(along_v));
            const glm::dvec3 n = glm::normalize(glm::dvec3(-slopes, 1.0));
            return c == 3 ? 1.0F : static_cast<float>(n[c]);
        };
        s.parameters["normal_map"] = {{"encoding", "signed"},
                                      {"map", s.picture_file(std::string(way.name) + ".exr", 512, normal)}};
        images.push_back(s.render());
    }
    for (std::size_t i = 1; i < images.size(); ++i) {
        const Deviation found = deviation(images[i], to_buffer(images[0]));
        std::printf("  bent, %-29s %.2e\n", ways[i].name, found.max);
        EXPECT_GE(found.content, 3000U);
        // Mixing texels costs up to 5e-4 in a slope, facets in place of the bent surface as much; highlights
        // of exponent 20 make more of it.
        EXPECT_LE(found.max, 2e-3) << ways[i].name;
    }
}

TEST(ReliefGradient, IsTheFiniteDifferenceOfTheDisplacedSurface) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
    for (int i = 0; i < 200; ++i) {
        // A plane walked over by px and py, in any direction and of either orientation; N on either side.
        const glm::dvec3 px = vector();
        const glm::dvec3 py = vector();
        glm::dvec3 normal = glm::normalize(glm::cross(px, py));
        normal = i % 2 == 0 ? normal : -normal;
        const auto height = [](double s, double t) {
            return 0.3 * std::sin(2.0 * s) + 0.2 * s * t - 0.1 * std::cos(3.0 * t);
        };
        const double s = unit(random);
        const double t = unit(random);
        constexpr double step = 1e-5;
        const auto place = [&](double a, double b) { return a * px + b * py + height(a, b) * normal; };
        const glm::dvec3 along_x = (place(s + step, t) - place(s - step, t)) / (2.0 * step);
        const glm::dvec3 along_y = (place(s, t + step) - place(s, t - step)) / (2.0 * step);
        glm::dvec3 wanted = glm::normalize(glm::cross(along_x, along_y));
        wanted = glm::dot(wanted, normal) < 0.0 ? -wanted : wanted;
        const glm::dvec2 rise((height(s + step, t) - height(s - step, t)) / (2.0 * step),
                              (height(s, t + step) - height(s, t - step)) / (2.0 * step));
        EXPECT_LE(glm::distance(reference::bumped(normal, px, py, rise), wanted), 1e-8) << i;
    }
}

}  // namespace
}  // namespace viscera::test
