#include "tests/reference/contrast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "effects/contrast/summarize_curve.h"

// The reference itself against closed forms: what shaders are held against must not be wrong.
namespace viscera::reference {
namespace {

// Perspective looking along -z from the origin, 90 degrees, aspect 1.
glm::dmat4 perspective(double near, double far) {
    glm::dmat4 m(0.0);
    m[0][0] = 1.0;
    m[1][1] = 1.0;
    m[2][2] = -(far + near) / (far - near);
    m[2][3] = -1.0;
    m[3][2] = -2.0 * far * near / (far - near);
    return m;
}

TEST(ReferenceRaster, SharedEdgesAreCoveredOnce) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> shift(-0.24, 0.24);
    for (const int snap : {-1, 8}) {
        std::vector<glm::dvec3> positions;
        std::vector<std::uint32_t> indices;
        constexpr std::uint32_t n = 8;
        for (std::uint32_t r = 0; r <= n; ++r) {
            for (std::uint32_t c = 0; c <= n; ++c) {
                const bool inner = r > 0 && c > 0 && r < n && c < n;
                // Half the vertices on pixel centres, so that many centres lie exactly on edges.
                const bool moved = inner && (r + c) % 2 == 0;
                positions.emplace_back(-1.0 + 2.0 * (c + (moved ? shift(random) : 0.0)) / n,
                                       -1.0 + 2.0 * (r + (moved ? shift(random) : 0.0)) / n, 0.0);
            }
        }
        for (std::uint32_t r = 0; r < n; ++r) {
            for (std::uint32_t c = 0; c < n; ++c) {
                const std::uint32_t i = r * (n + 1) + c;
                // Both orientations.
                indices.insert(indices.end(), {i, i + 1, i + n + 1, i + 1, i + n + 1, i + n + 2});
            }
        }
        // 20 x 20 pixels over 8 x 8 cells of 2.5: cell corners lie on pixel centres and between them.
        Buffer count(20, 20);
        rasterise(positions, indices, glm::dmat4(1.0), {.width = 20, .height = 20, .snap_bits = snap},
                  [&](const Fragment& f) { count.at(f.x, f.y) += 1.0; });
        for (const double c : count.data) {
            ASSERT_EQ(c, 1.0);
        }
    }
}

TEST(ReferenceRaster, InterpolatesWithPerspectiveAcrossTheNearPlane) {
    // A floor from behind the eye to far ahead: attributes are positions, so each is known from its ray.
    const std::vector<glm::dvec3> positions{{-40, -1, 5}, {40, -1, 5}, {40, -1, -100}, {-40, -1, -100}};
    const std::vector<std::uint32_t> indices{0, 1, 2, 0, 3, 2};
    int fragments = 0;
    rasterise(positions, indices, perspective(0.5, 1000.0), {.width = 64, .height = 64},
              [&](const Fragment& f) {
                  const double slope_x = (f.x + 0.5) / 32.0 - 1.0;
                  const double slope_y = (f.y + 0.5) / 32.0 - 1.0;
                  const double ahead = -1.0 / slope_y;
                  const glm::dvec3 p = f.interpolate(positions);
                  ASSERT_NEAR(p.z, -ahead, 1e-9);
                  ASSERT_NEAR(p.x, slope_x * ahead, 1e-9);
                  ASSERT_NEAR(p.y, -1.0, 1e-12);
                  ASSERT_GT(ahead, 0.5);
                  const double ndc = (1000.5 / 999.5 * ahead - 2.0 * 500.0 / 999.5) / ahead;
                  ASSERT_NEAR(f.depth, 0.5 * ndc + 0.5, 1e-12);
                  ++fragments;
              });
    EXPECT_GT(fragments, 1500);
}

TEST(ReferenceRaster, DrawsNothingOfWhatIsBehindOrWithoutNumbers) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<glm::dvec3> positions{{-1, -1, 5}, {1, -1, 5}, {0, 1, 5}, {nan, 0, -5}, {0, 0, 0}};
    const std::vector<std::uint32_t> indices{0, 1, 2, 0, 1, 3, 4, 4, 4};
    rasterise(positions, indices, perspective(0.5, 100.0), {.width = 16, .height = 16},
              [](const Fragment&) { ADD_FAILURE(); });
}

TEST(ReferenceBuffer, SamplesAsOpenGLDoes) {
    Buffer b(4, 2);
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) {
            b.at(x, y) = x + 10.0 * y;
        }
    }
    EXPECT_EQ(sample_linear(b, b.uv(2, 1)), 12.0);
    EXPECT_NEAR(sample_linear(b, {0.5, 0.5}), 6.5, 1e-15);
    EXPECT_EQ(sample_linear(b, {-3.0, 7.0}), 10.0);
    EXPECT_EQ(sample_inside(b, {-0.01, 0.5}), 0.0);
}

ContrastMesh square(double z) {
    return {{{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}}, {0, 1, 2, 0, 2, 3}};
}

TEST(ReferenceContrast, MainTakesTheBrightest) {
    ContrastMesh mesh = square(0.0);
    const ContrastMesh other = square(0.5);
    mesh.positions_mm.insert(mesh.positions_mm.end(), other.positions_mm.begin(), other.positions_mm.end());
    mesh.indices.insert(mesh.indices.end(), {4, 6, 5, 4, 7, 6});
    const ContrastView view{glm::dmat4(1.0), {.width = 8, .height = 8}};
    const Buffer main = main_object(
        mesh, view, [](const Fragment& f) { return f.triangle < 2 ? 0.05 : 0.1; }, 0.9);
    for (const double value : main.data) {
        EXPECT_NEAR(value, 0.9 * 0.1 * opacity_loop(0.1), 1e-15);
    }
}

TEST(ReferenceContrast, CloudAndDistanceFollowTheirFormula) {
    const ContrastView view{glm::dmat4(1.0), {.width = 16, .height = 16}};
    const Injection injection{.radius_mm = 0.9, .brightness = 0.8, .threshold = 0.4};
    const Buffer c = cloud(square(0.0), view, injection);
    const Buffer d = distance_map(square(0.0), view, injection);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            const double away = glm::length(glm::dvec2((x + 0.5) / 8.0 - 1.0, (y + 0.5) / 8.0 - 1.0));
            const double q = std::clamp(3.0 * (1.0 - away / 0.9), 0.0, 1.0);
            EXPECT_NEAR(d.at(x, y, 0), q, 1e-12);
            EXPECT_EQ(d.at(x, y, 1), 1.0);
            EXPECT_NEAR(c.at(x, y, 1), 0.8 * q >= 0.4 ? q : 0.0, 1e-12);
            EXPECT_NEAR(c.at(x, y, 0), 0.8 * c.at(x, y, 1), 1e-15);
        }
    }
    EXPECT_EQ(injection_weight({.radius_mm = 0.0}, glm::dvec3(0.0)), 0.0);
}

// The reference asks the distance map as the thesis does, the curve the cloud's weight: what the cloud's
// threshold dropped makes no difference.
TEST(ReferenceContrast, SummarizeFollowsTheWrittenCurve) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Buffer main(64, 64);
    Buffer c(64, 64, 2);
    Buffer d(64, 64, 2);
    constexpr double brightness = 0.8;
    constexpr double threshold = 0.3;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            main.at(x, y) = unit(random) < 0.2 ? 0.0 : unit(random);
            const double q = unit(random) < 0.2 ? 0.0 : unit(random);
            d.at(x, y, 0) = q;
            const bool dropped = brightness * q < threshold;
            c.at(x, y, 0) = dropped ? 0.0 : brightness * q;
            c.at(x, y, 1) = dropped ? 0.0 : q;
        }
    }
    for (const auto& [named, transition] :
         {std::pair(Transition::smooth, contrast::SummarizeTransition::smooth),
          {Transition::thesis, contrast::SummarizeTransition::thesis},
          {Transition::densest, contrast::SummarizeTransition::densest}}) {
        const Buffer r = summarize(main, c, d, named);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                ASSERT_NEAR(r.at(x, y),
                            contrast::summarize(main.at(x, y), c.at(x, y, 0), c.at(x, y, 1), transition),
                            1e-15);
            }
        }
    }
}

TEST(SummarizeCurve, DensestNeverMakesAVesselLighter) {
    using contrast::SummarizeTransition;
    for (double q = 0.0; q <= 1.0; q += 1.0 / 64) {
        EXPECT_EQ(contrast::summarize(1.0, q, q, SummarizeTransition::densest), 1.0);
        EXPECT_EQ(contrast::summarize(1.3, q, q, SummarizeTransition::densest), 1.3);
        EXPECT_GE(contrast::summarize(0.2, q, q, SummarizeTransition::densest), 0.2);
    }
    EXPECT_LT(contrast::summarize(1.0, 0.5, 0.5, SummarizeTransition::smooth), 0.9) << "the pale ring";
    EXPECT_EQ(contrast::summarize(0.2, 1.0, 1.0, SummarizeTransition::densest), 1.0);
}

TEST(SummarizeCurve, SmoothHasNoJumpAndMeetsTheThesisAwayFromTheLine) {
    using contrast::SummarizeTransition;
    double before = contrast::summarize(1.0, 0.0, 0.0, SummarizeTransition::smooth);
    for (int i = 1; i <= 100000; ++i) {
        const double q = i / 100000.0;
        const double r = contrast::summarize(1.0, 0.0, q, SummarizeTransition::smooth);
        ASSERT_LT(std::abs(r - before), 1e-4);
        if (std::abs(0.9 - (1.0 - q)) > contrast::summarize_width) {
            ASSERT_NEAR(r, contrast::summarize(1.0, 0.0, q, SummarizeTransition::thesis), 1e-15);
        }
        before = r;
    }
    EXPECT_NEAR(contrast::summarize(0.3, 0.0, 0.0, SummarizeTransition::smooth), 0.3, 0.0);
    EXPECT_NEAR(contrast::summarize(0.3, 0.0, 1e-12, SummarizeTransition::smooth), 0.3, 1e-12);
}

TEST(ReferenceContrast, SpriteStandsAtItsBaseAndTurnsWithItsAxis) {
    // A sprite with one bright texel column up its own axis, seen from the side.
    Sprites pictures;
    pictures.views.push_back({90.0, Buffer(1, 1, 1, 1.0)});
    pictures.front = Buffer(1, 1, 1, 1.0);
    const SpriteCamera camera{.orthographic = true};
    const Buffer summary(100, 100, 1, 0.25);
    const Emitter up{{0, 0, 0}, {0, 0.4, 0}, {0.1, 0.4, 0}, 1.0};  // L = 0.2 in UV
    const Buffer a = sprites(std::vector{up}, pictures, camera, summary);
    // side UV = (uv - 0.5) / 0.2 + (0.55, 0.15): covers u 0.39 .. 0.59, v 0.47 .. 0.67.
    for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 100; ++x) {
            const bool inside = x >= 39 && x < 59 && y >= 47 && y < 67;
            ASSERT_NEAR(a.at(x, y), inside ? 0.5 : 0.0, 1e-12) << x << ' ' << y;
        }
    }
    const Emitter right{{0, 0, 0}, {0.4, 0, 0}, {0.4, 0.1, 0}, 1.0};
    const Buffer b = sprites(std::vector{right}, pictures, camera, summary);
    // Turned by 90 degrees clockwise: what lay at (x, y) from the base now lies at (y, -x).
    EXPECT_NEAR(b.at(66, 50), 0.5, 1e-12);
    EXPECT_NEAR(b.at(68, 50), 0.0, 1e-12);
    EXPECT_NEAR(b.at(50, 60), 0.5, 1e-12);
    EXPECT_NEAR(b.at(50, 62), 0.0, 1e-12);
    EXPECT_NEAR(b.at(50, 42), 0.5, 1e-12);
    EXPECT_NEAR(b.at(50, 40), 0.0, 1e-12);
}

TEST(ReferenceContrast, SpriteViewsBlendByAngle) {
    Sprites pictures;
    pictures.views = {{30.0, Buffer(1, 1, 1, 0.2)}, {90.0, Buffer(1, 1, 1, 0.6)}};
    const SpriteCamera camera{.orthographic = true};
    const Buffer summary(10, 10, 1, 0.5);
    const double angle = std::numbers::pi / 4.0;
    const Emitter emitter{{0, 0, 0}, {0, std::sin(angle), std::cos(angle)}, {0, std::sin(angle), 0}, 1.0};
    const Buffer out = sprites(std::vector{emitter}, pictures, camera, summary);
    EXPECT_NEAR(out.at(5, 6), 0.2 + 0.4 * 15.0 / 60.0, 1e-12);
}

TEST(ReferenceContrast, BadEmittersGiveNothing) {
    Sprites pictures;
    pictures.views.push_back({90.0, Buffer(1, 1, 1, 1.0)});
    const SpriteCamera camera{.view_projection = perspective(0.5, 100.0)};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Emitter> bad{{{0, 0, -5}, {0, 0, -5}, {1, 0, -5}, 1.0},
                                   {{0, 0, 5}, {0, 1, 5}, {1, 1, 5}, 1.0},
                                   {{nan, 0, -5}, {0, 1, -5}, {1, 1, -5}, 1.0},
                                   {{0, 0, -5}, {0, 1, -5}, {1, 1, -5}, 0.0}};
    for (const double value : sprites(bad, pictures, camera, Buffer(8, 8, 1, 1.0)).data) {
        EXPECT_EQ(value, 0.0);
    }
}

TEST(ReferenceContrast, BrightnessLooksFourRingsFar) {
    Buffer summary(200, 200);
    summary.at(108, 100) = 1.0;  // 0.04 to the right of the texel at (100, 100)
    EXPECT_NEAR(sprite_brightness(summary, summary.uv(100, 100)), 1.0, 1e-12);
    EXPECT_NEAR(sprite_brightness(summary, summary.uv(98, 100)), 0.0, 1e-12);
    EXPECT_NEAR(sprite_brightness(summary, summary.uv(107, 101)), 0.0, 1e-12);
}

TEST(ReferenceContrast, BlurKeepsMassAndConstants) {
    Buffer dot(41, 41);
    dot.at(20, 20) = 1.0;
    const Buffer blurred = capillary(dot, 3.0, 0.5);
    double sum = 0.0;
    for (const double v : blurred.data) {
        sum += v;
    }
    EXPECT_NEAR(sum, 0.5, 1e-12);
    EXPECT_NEAR(blurred.at(23, 20) / blurred.at(20, 20), std::exp(-0.5), 1e-12);
    EXPECT_NEAR(capillary(Buffer(5, 3, 1, 0.7), 4.0, 1.0).at(0, 0), 0.7, 1e-12);
    EXPECT_EQ(capillary(dot, 0.0, 1.0).at(20, 20), 1.0);
}

TEST(ReferenceContrast, TonesFollowTheirFormulas) {
    const double mu = extinction_for(0.15);
    EXPECT_NEAR(tone_contrast(0.8, 1.0, Tone::beer_lambert, mu), 0.12, 1e-15);
    EXPECT_EQ(tone_contrast(0.8, 0.0, Tone::beer_lambert, mu), 0.8);
    EXPECT_NEAR(tone_contrast(0.8, 0.25, Tone::thesis, mu), 0.45, 1e-15);
    EXPECT_NEAR(tone_contrast(0.8, 0.5, Tone::thesis, mu), 0.075, 1e-15);
    const std::vector<Buffer> layers{Buffer(3, 3, 1, 0.2), Buffer(3, 3, 1, 0.6)};
    const Buffer picture = composite(Buffer(1, 1, 1, 0.9), layers, 3, 3, Tone::beer_lambert, 2.0);
    EXPECT_NEAR(picture.at(1, 2), 0.9 * std::exp(-1.2), 1e-15);
}

}  // namespace
}  // namespace viscera::reference
