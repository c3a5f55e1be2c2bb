// Skipping in cylindrical and spherical volumes changes no bit of the picture, and gains.

#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "effects/volume/skip_map.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/sector_stage.h"

namespace viscera::test {
namespace {

nlohmann::json parameters(std::string_view function, std::string_view scheme, std::string_view filter) {
    nlohmann::json p{{"function", function},
                     {"transfer_function", vessels_shown()},
                     {"sampling", {{"scheme", scheme}, {"filter", filter}}}};
    if (function == "isosurface") {
        p["isosurface"] = {{"values", {{{"value", 90}, {"opacity", 0.6}}}}};
    }
    if (function == "average") {
        p["threshold"] = 40;
    }
    return p;
}

glm::ivec3 dims_of(const VolumeShape& shape) {
    return shape.kind == VolumeKind::cylindrical ? glm::ivec3(26, 54, 31) : glm::ivec3(54, 33, 26);
}

class SectorSkipping : public testing::Test {
  protected:
    void expect_same(const LiveVolume& volume, nlohmann::json p, const Look& look, int least_lit = 0) {
        p["sampling"]["skip"] = false;
        const Shot whole = stage_.cast(volume, p, look, size_);
        p["sampling"]["skip"] = true;
        const Shot skipped = stage_.cast(volume, p, look, size_);
        EXPECT_TRUE(same_bits(whole, skipped))
            << p.dump() << " off by " << difference(whole.image, skipped.image).max << " in "
            << difference(whole.image, skipped.image).above << " pixels";
        int lit = 0;
        for (int i = 0; i < size_.x * size_.y; ++i) {
            lit += whole.at(i % size_.x, i / size_.x) != whole.at(0, 0) ? 1 : 0;
        }
        EXPECT_GE(lit, least_lit);
        lit_ += lit;
    }

    VolumeStage stage_;
    glm::ivec2 size_{40};
    int lit_ = 0;
};

TEST_F(SectorSkipping, ChangesNoBitUnderAnyFunctionSchemeAndFilter) {
    for (const NamedShape& named : some_shapes()) {
        if (std::string_view("ring ball").find(named.name) == std::string_view::npos) {
            continue;
        }
        SCOPED_TRACE(named.name);
        const bool all = named.shape.kind == VolumeKind::cylindrical;  // each picture is a shader to compile
        const LiveVolume volume(sector_vessels(named.shape, dims_of(named.shape)));
        const Look look{.eye_mm = sector_centre(volume.volume().grid) + glm::dvec3(110, -150, 80),
                        .target_mm = sector_centre(volume.volume().grid),
                        .fov_deg = 34};
        for (const char* scheme : {"midpoint", "gauss", "preintegrated"}) {
            if (!all && std::string_view(scheme) != "preintegrated") {
                continue;
            }
            for (const char* function : {"composite", "mip", "average", "xray"}) {
                if (std::string_view(scheme) != "preintegrated" ||
                    std::string_view(function) == "composite") {
                    expect_same(volume, parameters(function, scheme, "linear"), look, 30);
                }
            }
        }
        expect_same(volume, parameters("isosurface", "gauss", "linear"), look, 30);
        for (const char* filter : {"nearest", "bspline", "catmull_rom_fp32"}) {
            if (!all && std::string_view(filter) != "bspline") {
                continue;
            }
            expect_same(volume, parameters("composite", "gauss", filter), look, 30);
        }
        nlohmann::json p = parameters("composite", "gauss", "linear");
        for (const double step : {0.2, 4.0}) {
            p["sampling"]["step"] = step;
            expect_same(volume, p, look, 30);
        }
        p["sampling"]["step"] = 0.5;
        p["sampling"]["jitter"] = "hash";
        expect_same(volume, p, look, 30);
        p["sampling"]["jitter"] = "none";
        p["sampling"]["tolerance"] = 0.0;
        p["crop"] = {{"first", {4, 8, 4}}, {"size", {20, 32, 16}}};
        expect_same(volume, p, look, 10);
        p["volume"] = {{"placement", {{"rotate_deg", {20, -70, 130}}, {"scale", {1.4, -0.6, 1}}}}};
        expect_same(volume, p, look, 10);
    }
}

TEST_F(SectorSkipping, ChangesNoBitFromManyPlaces) {
    std::mt19937 random(23);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const LiveVolume volume(sector_vessels(named.shape, dims_of(named.shape)));
        const VolumeGrid& grid = volume.volume().grid;
        const glm::dvec3 axis = grid.direction[2];
        for (int i = 0; i < 9; ++i) {
            Look look{
                .eye_mm = sector_centre(grid) + 110.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                .target_mm = sector_centre(grid) + 9.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                .fov_deg = 45,
                .near_mm = 0.1};
            if (i == 1) {  // along the axis
                look.eye_mm = grid.origin_mm + 130.0 * axis;
                look.target_mm = grid.origin_mm;
                look.up = {0.0, 1.0, 0.0};
            } else if (i == 2) {  // in the centre or at the axis' end
                look.eye_mm = grid.origin_mm;
            } else if (i == 3) {  // parallel rays along the axis
                look.eye_mm = grid.origin_mm - 200.0 * axis;
                look.target_mm = grid.origin_mm;
                look.up = {0.0, 1.0, 0.0};
                look.orthographic_mm = 101.0;
            } else if (i == 4) {  // parallel rays across it
                look.eye_mm = grid.origin_mm + 12.0 * axis - 200.0 * grid.direction[0];
                look.target_mm = grid.origin_mm + 12.0 * axis;
                look.orthographic_mm = 101.0;
            }
            expect_same(volume, parameters("composite", i % 2 == 0 ? "gauss" : "midpoint", "linear"), look);
        }
    }
    EXPECT_GT(lit_, 10000);
}

TEST_F(SectorSkipping, FindsSingleVoxelsAtSeamAxisAndPoles) {
    for (const NamedShape& named : some_shapes()) {
        if (std::string_view("ring ball open ring").find(named.name) == std::string_view::npos) {
            continue;
        }
        SCOPED_TRACE(named.name);
        const glm::ivec3 n = dims_of(named.shape);
        for (const glm::ivec3 at :
             {glm::ivec3(0), n - 1, glm::ivec3(0, n.y - 1, 5), glm::ivec3(n.x - 1, 0, n.z - 2),
              glm::ivec3(1, n.y / 2, n.z - 1), n / 2}) {
            Volume dot = sector_vessels(named.shape, n);
            std::memset(dot.voxels.data(), 0, dot.voxels.size());
            const float bright = 200.0F;
            std::memcpy(dot.voxels.data() + 4 * (at.x + n.x * (at.y + n.y * at.z)), &bright, 4);
            const LiveVolume volume(dot);
            const VolumeGrid& grid = volume.volume().grid;
            Look look{.eye_mm = sector_centre(grid) + glm::dvec3(110, -150, 80),
                      .target_mm = grid.world_of_index(glm::dvec3(at)),
                      .fov_deg = 4};
            expect_same(volume, parameters("mip", "gauss", "linear"), look);
            expect_same(volume, parameters("composite", "gauss", "bspline_fp32"), look);
        }
    }
    EXPECT_GT(lit_, 500);
}

TEST(SectorSkippingCounts, LeavesOutMostOfTheDark) {
    for (const NamedShape& named : some_shapes()) {
        if (std::string_view("ring ball").find(named.name) == std::string_view::npos) {
            continue;
        }
        VolumeStage stage(slab_counting());
        const glm::ivec3 n = 2 * dims_of(named.shape);
        const LiveVolume volume(sector_vessels(named.shape, n));
        const Look look{.eye_mm = sector_centre(volume.volume().grid) + glm::dvec3(110, -150, 80),
                        .target_mm = sector_centre(volume.volume().grid),
                        .fov_deg = 34};
        std::array<double, 2> taken{};
        for (const bool skip : {false, true}) {
            nlohmann::json p = parameters("composite", "gauss", "linear");
            p["sampling"]["skip"] = skip;
            p["sampling"]["termination"] = 0;
            const Shot shot = stage.cast(volume, p, look, glm::ivec2(48));
            for (int i = 0; i < 48 * 48; ++i) {
                taken.at(skip ? 1 : 0) += shot.at(i % 48, i / 48).x;
            }
        }
        std::printf("  %s: %.0f of %.0f slabs taken\n", named.name, taken[1], taken[0]);
        EXPECT_LT(taken[1], 0.35 * taken[0]);
        EXPECT_GT(taken[1], 0.0);
    }
}

}  // namespace
}  // namespace viscera::test
