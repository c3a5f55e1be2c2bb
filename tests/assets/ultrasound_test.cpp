#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "assets/generate/generate.h"
#include "assets/generate/ultrasound_echo.h"
#include "assets/generate/volume_artery.h"
#include "assets/generate/volume_fetus.h"
#include "assets/generate/volume_files.h"

namespace viscera::assets {
namespace {

using std::numbers::pi;
constexpr int coarser_scan = 2;

const Volume& artery() {
    static const Volume made = make_artery(default_seed, coarser_scan);
    return made;
}

const Volume& fetus() {
    static const Volume made = make_fetus(default_seed, coarser_scan);
    return made;
}

double gray(const Volume& volume, const glm::ivec3& i) {
    const glm::ivec3 n = volume.grid.dims;
    return std::to_integer<int>(volume.voxels[static_cast<std::size_t>(i.x + n.x * (i.y + n.y * i.z))]);
}

/// Mean over samples that pick(i) takes.
double mean(const Volume& volume, const auto& pick) {
    double sum = 0.0;
    double count = 0.0;
    glm::ivec3 i;
    for (i.z = 0; i.z < volume.grid.dims.z; ++i.z) {
        for (i.y = 0; i.y < volume.grid.dims.y; ++i.y) {
            for (i.x = 0; i.x < volume.grid.dims.x; ++i.x) {
                if (pick(i)) {
                    sum += gray(volume, i);
                    count += 1.0;
                }
            }
        }
    }
    EXPECT_GT(count, 50.0);
    return sum / count;
}

/// Of an artery's sample: radius [mm], angle [rad], way along it [mm].
glm::dvec3 in_artery(const glm::ivec3& i) {
    const glm::dvec3 n(artery().grid.dims);
    return {0.5 + 4.5 * i.x / (n.x - 1.0), 2.0 * pi * i.y / n.y, 24.0 * i.z / (n.z - 1.0)};
}

TEST(Artery, is_a_cylinder_with_wrap) {
    const VolumeShape& shape = artery().grid.shape;
    EXPECT_EQ(artery().grid.dims, glm::ivec3(56, 128, 36));
    EXPECT_EQ(shape.kind, VolumeKind::cylindrical);
    EXPECT_TRUE(shape.wrap);
    EXPECT_EQ(shape.angle_rad, 2.0 * pi);
    EXPECT_EQ(shape.r_min_mm, 0.5);
    EXPECT_EQ(artery().type, ScalarType::u8);
    EXPECT_EQ(artery().voxels.size(), 56U * 128U * 36U);
}

TEST(Artery, shows_blood_wall_and_the_shadow_of_calcium) {
    const double blood =
        mean(artery(), [](const glm::ivec3& i) { return in_artery(i).x > 0.55 && in_artery(i).x < 0.66; });
    const double outer =
        mean(artery(), [](const glm::ivec3& i) { return in_artery(i).x > 3.6 && in_artery(i).z > 20.0; });
    const double shadow = mean(artery(), [](const glm::ivec3& i) {
        const glm::dvec3 at = in_artery(i);
        return at.x > 4.0 && std::abs(at.y - 0.6) < 0.3 && std::abs(at.z - 15.5) < 1.5;
    });
    EXPECT_LT(blood, 65.0);
    EXPECT_GT(outer, 150.0);
    EXPECT_LT(shadow, 10.0);
}

TEST(Artery, has_no_seam) {
    // Neighbours across the seam are as alike as neighbours elsewhere.
    const glm::ivec3 n = artery().grid.dims;
    std::vector<double> apart(static_cast<std::size_t>(n.y));
    for (int j = 0; j < n.y; ++j) {
        for (int k = 0; k < n.z; ++k) {
            for (int i = 0; i < n.x; ++i) {
                apart[static_cast<std::size_t>(j)] +=
                    std::abs(gray(artery(), {i, j, k}) - gray(artery(), {i, (j + 1) % n.y, k}));
            }
        }
    }
    const double seam = apart.back();
    std::ranges::sort(apart);
    EXPECT_LT(seam, 1.15 * apart[apart.size() / 2]);
}

TEST(Fetus, is_a_sector_of_a_sphere) {
    const VolumeShape& shape = fetus().grid.shape;
    EXPECT_EQ(fetus().grid.dims, glm::ivec3(64, 58, 70));
    EXPECT_EQ(shape.kind, VolumeKind::spherical);
    EXPECT_FALSE(shape.wrap);
    EXPECT_NEAR(shape.latitude_rad, 76.0 * pi / 180.0, 1e-12);
    EXPECT_EQ(shape.r_min_mm, 45.0);
}

TEST(Fetus, lies_in_water_and_its_skull_casts_a_shadow) {
    const glm::ivec3 n = fetus().grid.dims;
    const auto radius = [&](const glm::ivec3& i) { return 45.0 + 105.0 * i.z / (n.z - 1.0); };
    const auto ahead = [&](const glm::ivec3& i) {
        return std::abs(i.x - n.x / 2) < n.x / 10 && i.y > n.y / 2 && i.y < n.y / 2 + n.y / 8;
    };
    EXPECT_LT(mean(fetus(), [&](const glm::ivec3& i) { return radius(i) > 54.0 && radius(i) < 60.0; }), 12.0);
    const double behind_skull =
        mean(fetus(), [&](const glm::ivec3& i) { return ahead(i) && radius(i) > 146.0; });
    const double beside_it = mean(fetus(), [&](const glm::ivec3& i) { return i.x < 3 && radius(i) > 146.0; });
    EXPECT_GT(beside_it, 150.0);
    EXPECT_LT(behind_skull, beside_it - 40.0);
}

TEST(Speckle, has_mean_one_and_spreads_as_rayleigh) {
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    for (double x = 0.1; x < 40.0; x += 0.37) {
        for (double y = 0.2; y < 40.0; y += 0.41) {
            const double a = speckle({x, y, 0.7 * x + 0.3 * y}, 3U);
            sum += a;
            squares += a * a;
            count += 1.0;
        }
    }
    const double mean = sum / count;
    EXPECT_NEAR(mean, 1.0, 0.08);
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean) / mean, 0.523, 0.08);
}

TEST(UltrasoundFiles, carry_their_geometry) {
    const auto file = std::filesystem::path(testing::TempDir()) / "viscera_artery.nrrd";
    write_volume(artery(), file);
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(file);
    EXPECT_THAT(text,
                testing::HasSubstr("\nviscera_geometry:=cylindrical\nviscera_r_min_mm:=0.5\n"
                                   "viscera_r_max_mm:=5\nviscera_first_angle_deg:=0\n"
                                   "viscera_angle_deg:=360\nviscera_wrap:=true\nviscera_height_mm:=24\n\n"));
}

}  // namespace
}  // namespace viscera::assets
