#include <cmath>
#include <numbers>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// Blood at the poles of a sphere by longitude and latitude, where all meridians meet in a point.
namespace viscera::test {
namespace {

using nlohmann::json;

using std::numbers::pi;
constexpr double radius_mm = 12.0;
constexpr int around = 36;
constexpr int rings = 18;

/// How a mesh ends at a pole.
enum class Cap {
    fan,    ///< a triangle for each meridian's strip, with a corner of its own
    quads,  ///< two, one of which has no area
    point,  ///< a triangle for each strip, all with the same corner
};

/// In a texture of a size, of which it leaves a margin free. Its poles lie on the world's axis of a number.
std::string sphere_obj(Cap cap, int axis, double margin_px, int size) {
    std::ostringstream text;
    text.precision(12);
    for (int j = 0; j <= rings; ++j) {
        for (int i = 0; i <= around; ++i) {
            const bool pole = j == 0 || j == rings;
            const double column = pole && cap == Cap::fan     ? std::min(i + 0.5, around - 0.5)
                                  : pole && cap == Cap::point ? 0.5 * around
                                                              : i;
            const double longitude = 2.0 * pi * (i % around) / around;
            const double sine = pole ? 0.0 : std::sin(pi * j / rings);
            glm::dvec3 p;
            p[axis] = radius_mm * std::cos(pi * j / rings);
            p[(axis + 1) % 3] = radius_mm * sine * std::cos(longitude);
            p[(axis + 2) % 3] = radius_mm * sine * std::sin(longitude);
            const glm::dvec2 uv =
                (margin_px +
                 (size - 2.0 * margin_px) * glm::dvec2(column / around, static_cast<double>(j) / rings)) /
                static_cast<double>(size);
            text << "v " << p.x << ' ' << p.y << ' ' << p.z << "\nvt " << uv.x << ' ' << uv.y << '\n';
        }
    }
    const auto face = [&](int a, int b, int c) {
        text << "f " << a << '/' << a << ' ' << b << '/' << b << ' ' << c << '/' << c << '\n';
    };
    for (int j = 0; j < rings; ++j) {
        for (int i = 0; i < around; ++i) {
            const int a = j * (around + 1) + i + 1;
            const int c = a + around + 1;
            if (cap == Cap::quads || j + 1 < rings) {
                face(a, c, c + 1);
            }
            if (cap == Cap::quads || j > 0) {
                face(a, c + 1, a + 1);
            }
        }
    }
    return text.str();
}

/// A sphere with blood above the end of the x axis, and a wound there.
void set_sphere(BloodStage& stage, Cap cap, int axis, double margin_px) {
    stage.mesh["file"] =
        stage.folder.write("sphere.obj", sphere_obj(cap, axis, margin_px, stage.size)).string();
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
    stage.blood = {
        {"liquid", {{"steps_per_s", 240.0}, {"max_drops", 1024}, {"pinning_mm", 0.0}}},
        {"wounds", {{{"position_mm", {11.9, 0.0, 1.2}}, {"radius_mm", 0.3}, {"rate_mm3_s", 5.0}}}}};
    stage.spill([](const glm::dvec3& p) {
        return p.x > 0.9 * radius_mm && std::abs(p.y) < 2.0 && p.z > 1.5 ? 0.4 : 0.0;
    });
}

struct Found {
    double volume_mm3 = 0.0;
    glm::dvec3 centre_mm{0.0};
    double beside_mm = 0.0;  ///< mean distance from the plane y = 0
};

Found find_blood(BloodStage& stage) {
    const Image height = stage.read("tissue.blood_height");
    const Image position = stage.read("tissue.position");
    const Image metric = stage.read("tissue.metric");
    Found found;
    for (int y = 0; y < height.height; ++y) {
        for (int x = 0; x < height.width; ++x) {
            if (position.at(x, y, 3) == 1.0F && metric.at(x, y, 3) > 0.0F) {
                const double volume =
                    static_cast<double>(height.at(x, y, 0)) * static_cast<double>(metric.at(x, y, 3));
                found.volume_mm3 += volume;
                found.centre_mm +=
                    volume * glm::dvec3(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
                found.beside_mm += volume * std::abs(static_cast<double>(position.at(x, y, 1)));
            }
        }
    }
    found.centre_mm /= found.volume_mm3;
    found.beside_mm /= found.volume_mm3;
    return found;
}

class BloodPole : public testing::TestWithParam<Cap> {};

TEST_P(BloodPole, BloodCrossesIt) {
    Found elsewhere;
    for (const int axis : {1, 0}) {
        BloodStage stage(192);
        set_sphere(stage, GetParam(), axis, 10.0);
        stage.frame(0.0);
        const double start = stage.account().film;
        stage.run(0.0, 0.7, 0.1);
        const BloodAccount end = stage.account();
        const Found found = find_blood(stage);
        std::printf(
            "  poles on axis %d: %.3f mm^3, %.3f given, %.4f gone; centre %.3f %.3f %.3f, beside %.3f\n",
            axis, start, end.given, end.gone, found.centre_mm.x, found.centre_mm.y, found.centre_mm.z,
            found.beside_mm);
        EXPECT_EQ(end.gone, 0.0);
        EXPECT_NEAR(end.kept() / (start + end.given), 1.0, 1e-5);
        elsewhere = axis == 1 ? found : elsewhere;
        EXPECT_NEAR(found.centre_mm.y, 0.0, 0.15);
        EXPECT_NEAR(found.beside_mm, elsewhere.beside_mm, 0.25);
        // All of it lay above the pole, where texels get so narrow that it takes longer.
        EXPECT_LT(found.centre_mm.z, 0.5 * elsewhere.centre_mm.z);
        EXPECT_LT(elsewhere.centre_mm.z, -5.0);
    }
}

/// As most spheres come, with a texture that they fill.
TEST_P(BloodPole, NothingIsLostAtTheBorderOfTheTexture) {
    for (const bool turned : {false, true}) {
        BloodStage stage(128);
        set_sphere(stage, GetParam(), 0, 0.0);
        stage.gravity["gravity_m_s2"] = {0, turned ? -7.0 : 0.0, turned ? 7.0 : -9.80665};
        stage.load();
        stage.frame(0.0);
        const double start = stage.account().film;
        stage.run(0.0, 1.0, 0.1);
        const BloodAccount end = stage.account();
        std::printf("  %.3f mm^3, %.3f given, %.4f gone, off by %+.1e\n", start, end.given, end.gone,
                    end.kept() / (start + end.given) - 1.0);
        EXPECT_EQ(end.gone, 0.0);
        EXPECT_NEAR(end.kept() / (start + end.given), 1.0, 1e-5);
    }
}

INSTANTIATE_TEST_SUITE_P(Caps, BloodPole, testing::Values(Cap::fan, Cap::quads, Cap::point));

}  // namespace
}  // namespace viscera::test
