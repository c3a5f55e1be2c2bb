// Skipping changes no bit of the picture, whatever is made of the ray; it leaves out what an oracle would;
// and it is never stale.

#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "engine/io/volume.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

/// Shows 100 and more.
/// Casts with and without skipping; the pictures' bits are compared.
class Skipping : public testing::Test {
  protected:
    /// Number of pixels in which anything is to be seen.
    static int lit(const Shot& shot) {
        int count = 0;
        for (int y = 0; y < shot.image.height; ++y) {
            for (int x = 0; x < shot.image.width; ++x) {
                const glm::dvec4 c = shot.at(x, y);
                count += c != shot.at(0, 0) ? 1 : 0;
            }
        }
        return count;
    }
    Shot expect_same_by(VolumeStage& stage, nlohmann::json parameters, const Look& look) {
        parameters["sampling"]["skip"] = false;
        Shot whole = stage.cast(vessels_, parameters, look, size_);
        parameters["sampling"]["skip"] = true;
        const Shot skipped = stage.cast(vessels_, parameters, look, size_);
        EXPECT_TRUE(same_bits(whole, skipped))
            << parameters.dump() << " off by " << difference(whole.image, skipped.image).max << " in "
            << difference(whole.image, skipped.image).above << " pixels";
        return whole;
    }
    void expect_same(const nlohmann::json& parameters, const Look& look, int least_lit = 100) {
        const Shot whole = expect_same_by(stage_, parameters, look);
        EXPECT_GE(lit(whole), least_lit) << parameters.dump();
        SCOPED_TRACE("as it is compiled for hardware");
        EXPECT_LE(difference(whole.image, expect_same_by(hardware_, parameters, look).image).max, 1e-6);
    }
    static nlohmann::json parameters(std::string_view function, std::string_view scheme,
                                     std::string_view filter) {
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

    VolumeStage stage_;
    VolumeStage hardware_{as_on_hardware()};
    LiveVolume vessels_{vessel_volume(40, 2.0, 9)};
    Look look_{.eye_mm = {150, -190, 90}, .fov_deg = 24};
    glm::ivec2 size_{64};
};

TEST_F(Skipping, ChangesNoBitUnderAnyFunctionAndScheme) {
    for (const char* scheme : {"midpoint", "gauss", "preintegrated", "cell"}) {
        for (const char* function : {"composite", "mip", "minip", "average", "xray"}) {
            if (std::string_view(scheme) == "preintegrated" && std::string_view(function) != "composite") {
                continue;  // the same as midpoint or gauss
            }
            expect_same(parameters(function, scheme, "linear"), look_,
                        std::string_view(function) == "minip" ? 0 : 100);
        }
    }
    expect_same(parameters("isosurface", "gauss", "linear"), look_);
}

TEST_F(Skipping, ChangesNoBitUnderAnyFilter) {
    for (const char* filter :
         {"nearest", "linear_fp32", "bspline", "bspline_fp32", "catmull_rom", "catmull_rom_fp32"}) {
        expect_same(parameters("composite", "midpoint", filter), look_);
    }
    expect_same(parameters("isosurface", "gauss", "linear_fp32"), look_);
    expect_same(parameters("composite", "cell", "catmull_rom"), look_);
    nlohmann::json raw = parameters("mip", "gauss", "bspline");
    raw["sampling"]["prefilter"] = false;
    expect_same(raw, look_);
}

TEST_F(Skipping, ChangesNoBitWhereTheLastSlabIsLongerThanWhatIsLeft) {
    // The middle of a whole slab may then lie outside the crop, or behind a sub-volume's end, in a brick of
    // another kind.
    std::mt19937 random(31);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const char* scheme : {"midpoint", "gauss", "preintegrated"}) {
        for (const double step : {1.3, 9.0}) {
            nlohmann::json p = parameters("composite", scheme, "linear");
            p["sampling"]["step"] = step;
            for (int view = 0; view < 2; ++view) {
                const Look look{
                    .eye_mm = 190.0 * glm::normalize(glm::dvec3(unit(random), unit(random), unit(random))),
                    .fov_deg = 24};
                nlohmann::json cropped = p;
                cropped["crop"] = {{"first", {9, 4, 13}}, {"size", {22, 30, 15}}};
                expect_same(cropped, look, 0);
                nlohmann::json behind = p;
                behind["sub_volume"] = {{"depth_mm", 31.0}};
                expect_same(behind, look, 0);
            }
        }
    }
}

TEST_F(Skipping, ChangesNoBitForJitterLongStepsCropAndPlacement) {
    nlohmann::json p = parameters("composite", "gauss", "linear");
    for (const double step : {0.1, 0.77, 3.0}) {
        p["sampling"]["step"] = step;
        expect_same(p, look_);
    }
    p["sampling"]["step"] = 0.5;
    p["sampling"]["jitter"] = "hash";
    expect_same(p, look_);
    p["sampling"]["jitter"] = "none";
    p["crop"] = {{"first", {3.3, 0, 7}}, {"size", {30, 21.5, 0}}};
    expect_same(p, look_, 50);
    p["volume"] = {
        {"placement", {{"rotate_deg", {20, -70, 130}}, {"scale", {1.4, -0.6, 1}}, {"move_mm", {3, 4, -5}}}}};
    expect_same(p, look_, 50);
    p.erase("crop");
    p["sampling"]["step"] = 2.1;
    expect_same(p, look_);
}

TEST_F(Skipping, ChangesNoBitFromAnyOfThirtyPlaces) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const char* scheme : {"gauss", "cell"}) {
        for (int i = 0; i < 30; ++i) {
            // Some inside of the volume, some along its axes.
            Look look{.eye_mm = 170.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                      .target_mm = 15.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                      .fov_deg = 35};
            if (i % 5 == 0) {
                look.eye_mm[i / 5 % 2] = look.target_mm[i / 5 % 2];
            }
            look.orthographic_mm = i % 3 == 0 ? 90.0 : 0.0;
            expect_same(parameters("composite", scheme, "linear"), look, 0);
        }
    }
}

TEST_F(Skipping, FindsVesselsOfOneVoxel) {
    // A single bright voxel in the dark, wherever it lies beside the edges of bricks.
    for (const glm::ivec3 at : {glm::ivec3(0), glm::ivec3(3, 4, 7), glm::ivec3(8, 39, 20), glm::ivec3(39)}) {
        Volume dot = vessels_.volume();
        std::ranges::fill(dot.voxels, std::byte{0});
        dot.voxels[static_cast<std::size_t>(at.x + 40 * (at.y + 40 * at.z))] = std::byte{200};
        vessels_.replace(std::move(dot));
        for (const char* scheme : {"gauss", "cell"}) {
            Look look = look_;
            look.target_mm = 2.0 * (glm::dvec3(at) - 19.5);
            look.fov_deg = 3;
            expect_same(parameters("composite", scheme, "linear"), look, 30);
        }
    }
}

struct Count {
    double taken = 0.0;
    double needed = 0.0;  ///< by an oracle that knows which slabs change the picture
};

/// Of the generated head.
Count count_slabs(const nlohmann::json& points, bool skip) {
    VolumeStage stage(slab_counting());
    Log log;
    const LiveVolume volume(
        io::load_volume(std::filesystem::path(VISCERA_SOURCE_DIR) / "assets/volumes/head.mha", {}, log));
    const nlohmann::json parameters{{"transfer_function", {{"points", points}}},
                                    {"sampling", {{"scheme", "gauss"}, {"skip", skip}}}};
    Count count;
    const Shot shot =
        stage.cast(volume, parameters, {.eye_mm = {220, -480, 120}, .fov_deg = 30}, glm::ivec2(96));
    for (int y = 0; y < 96; ++y) {
        for (int x = 0; x < 96; ++x) {
            count.taken += shot.at(x, y).x;
            count.needed += shot.at(x, y).y;
        }
    }
    EXPECT_GT(count.needed, 10000.0);
    return count;
}

/// Prints what is taken beside what an oracle needs, and expects it to be at most `most` times as much: a
/// brick is taken whole where a voxel of it or beside it is seen.
void expect_fewer(const char* what, double most, const nlohmann::json& points) {
    const Count with = count_slabs(points, true);
    const Count without = count_slabs(points, false);
    std::printf("  %s: %.3f slabs taken for each that is needed, %.3f without skipping\n", what,
                with.taken / with.needed, without.taken / without.needed);
    EXPECT_EQ(with.needed, without.needed);
    EXPECT_LE(with.taken, most * with.needed);
}

TEST(SkippingOracle, LeavesOutWhatIsNoBone) {
    // Of a shell this thin bricks of a single voxel would still take 1.39 times as much.
    expect_fewer("bone", 1.9, {{{"value", 200}, {"opacity", 0.0}}, {{"value", 900}, {"opacity", 0.3}}});
}

TEST(SkippingOracle, LeavesOutTheAir) {
    expect_fewer("soft tissue", 1.15,
                 {{{"value", -400}, {"opacity", 0.0}}, {{"value", 0}, {"opacity", 0.004}}});
}

TEST(SkippingOracle, LeavesOutWhatSurroundsTheHeadOfTheScene) {
    std::ifstream stream(std::filesystem::path(VISCERA_SOURCE_DIR) / "assets/scenes/head.json");
    const nlohmann::json scene = nlohmann::json::parse(stream);
    expect_fewer("skin over bone", 1.15, scene["passes"][0]["parameters"]["transfer_function"]["points"]);
}

/// What a renderer shows after changes, one after another, is what a fresh one shows.
class NeverStale : public testing::Test {
  protected:
    void expect_fresh(const char* after) {
        SCOPED_TRACE(after);
        const Shot shown = stage_.cast_again(volume_, view_, size_);
        VolumeStage fresh;
        const LiveVolume copy(volume_.volume());
        const Shot wanted = fresh.cast(copy, parameters_, look_, size_);
        EXPECT_TRUE(same_bits(shown, wanted)) << difference(shown.image, wanted.image).max;
        EXPECT_FALSE(same_bits(shown, before_)) << "the change changes nothing";
        before_ = shown;
    }
    void set(const char* pointer, const nlohmann::json& value) {
        parameters_[nlohmann::json::json_pointer(pointer)] = value;
        stage_.stage().make_current();
        stage_.stage().renderer().set_parameter("cast", pointer, value);
    }
    /// Fills a box.
    void fill(const glm::ivec3& first, const glm::ivec3& size, int value) {
        const std::vector<std::byte> data(static_cast<std::size_t>(size.x * size.y * size.z),
                                          static_cast<std::byte>(value));
        volume_.update({first, size}, data);
    }
    void start(nlohmann::json parameters) {
        parameters_ = std::move(parameters);
        before_ = stage_.cast(volume_, parameters_, look_, size_);
        view_ = before_.view;
    }

    VolumeStage stage_;
    LiveVolume volume_{vessel_volume(32, 2.5, 4)};
    nlohmann::json parameters_;
    Look look_{.eye_mm = {150, -190, 90}, .fov_deg = 24};
    glm::ivec2 size_{64};
    View view_;
    Shot before_;
};

TEST_F(NeverStale, Composite) {
    start({{"transfer_function", vessels_shown()}, {"crop", {{"first", {0, 0, 0}}}}});
    nlohmann::json points = vessels_shown()["points"];
    points[0]["value"] = 110;
    set("/transfer_function/points", points);
    expect_fresh("a narrower transfer function");
    points[0]["value"] = 5;
    set("/transfer_function/points", points);
    expect_fresh("a wider transfer function");
    set("/crop/first", {8, 0, 4});
    expect_fresh("a crop");
    fill({13, 11, 17}, {7, 6, 5}, 180);
    expect_fresh("new voxels");
    fill({13, 11, 17}, {7, 6, 5}, 0);
    fill({29, 2, 30}, {3, 1, 2}, 255);
    expect_fresh("voxels brighter than any before");
    set("/crop/first", {0, 0, 0});
    expect_fresh("no crop");
    volume_.replace(vessel_volume(32, 2.5, 5));
    expect_fresh("another volume");
}

TEST_F(NeverStale, WhereverTheRaysTurn) {
    // What lies ahead of rays is found for those ways that they go, when they go there.
    start({{"transfer_function", vessels_shown()}});
    nlohmann::json points = vessels_shown()["points"];
    const auto from = [&](const glm::dvec3& eye_mm) {
        look_.eye_mm = eye_mm;
        VolumeStage fresh;
        const Shot wanted = fresh.cast(LiveVolume(volume_.volume()), parameters_, look_, size_);
        const Shot shown = stage_.cast_again(volume_, wanted.view, size_);
        EXPECT_TRUE(same_bits(shown, wanted)) << eye_mm.x << ' ' << eye_mm.y << ' ' << eye_mm.z << ": "
                                              << difference(shown.image, wanted.image).max;
    };
    for (int way = 0; way < 8; ++way) {
        if (way == 4) {
            points[0]["value"] = 110;
            set("/transfer_function/points", points);
        }
        from({way % 2 != 0 ? 130 : -130, way / 2 % 2 != 0 ? 160 : -160, way / 4 != 0 ? 120 : -120});
    }
    from({2, -200, -1});
    from({10, -5, 3});  // inside, every way
    points[0]["value"] = 5;
    set("/transfer_function/points", points);
    from({12, -5, 3});
    from({-240, 0, 0});
}

TEST_F(NeverStale, Isosurface) {
    start({{"function", "isosurface"},
           {"transfer_function", vessels_shown()},
           {"isosurface", {{"values", {{{"value", 150}}}}}}});
    set("/isosurface/values", {{{"value", 40}}});
    expect_fresh("a lower value");
    fill({13, 11, 17}, {7, 6, 5}, 200);
    expect_fresh("new voxels");
    set("/isosurface/values", {{{"value", 230}}});
    fill({4, 21, 7}, {7, 6, 5}, 255);
    expect_fresh("a value that only new voxels have");
}

TEST_F(NeverStale, AverageAndMaximum) {
    start({{"function", "average"}, {"transfer_function", vessels_shown()}, {"threshold", 150}});
    set("/threshold", 70);
    expect_fresh("a lower threshold");
    fill({13, 11, 17}, {7, 6, 5}, 200);
    expect_fresh("new voxels");
    set("/function", "mip");
    expect_fresh("another function");
    fill({4, 21, 7}, {7, 6, 5}, 255);
    expect_fresh("new voxels");
}

TEST_F(NeverStale, PreintegratedAndPrefiltered) {
    start({{"transfer_function", vessels_shown()},
           {"sampling", {{"scheme", "preintegrated"}, {"filter", "bspline"}}}});
    nlohmann::json points = vessels_shown()["points"];
    points[0]["value"] = 100;
    set("/transfer_function/points", points);
    expect_fresh("a narrower transfer function");
    fill({13, 11, 17}, {7, 6, 5}, 255);
    expect_fresh("new voxels, brighter than any before");
}

}  // namespace
}  // namespace viscera::test
