#include <gtest/gtest.h>

#include "effects/volume/mixed.h"
#include "tests/reference/volume_mixed.h"
#include "tests/volume/mixed_scene.h"

// The volume in mixed resolution: what the coarse picture cannot tell is cast, what it can is filled in.

namespace viscera::test {
namespace {

using nlohmann::json;
using reference::MixedPicture;

constexpr int width = 96;
constexpr int height = 80;

struct Mixed {
    double scale = 0.5;
    double tolerance = 0.01;
    double depth_tolerance_mm = 0.1;
};

class MixedResolution : public testing::TestWithParam<ComputeUse> {
  protected:
    /// The shells, with a ball of triangles in them when `mesh`.
    json full_scene(bool mesh, json parameters = {{"transfer_function", shell_function()}}) {
        json passes = json::array();
        if (mesh) {
            passes.push_back({{"name", "surface"},
                              {"effect", "mesh.surface"},
                              {"parameters", {{"mesh", ball_}, {"colour", {0.2, 0.9, 0.4}}}}});
        }
        return mixed_scene(passes, std::move(parameters), camera_at({60, -420, 90}, 200, 800), width, height);
    }
    /// The same with a coarse pass before it.
    static json in_mixed(json scene, const Mixed& how) {
        json& passes = scene["passes"];
        json coarse = passes.back();
        coarse["name"] = "coarse";
        coarse.erase("targets");  // it has no background
        coarse["parameters"]["mixed"] = {{"pass", "coarse"}};
        passes.back()["parameters"]["mixed"] = {
            {"pass", "fine"}, {"tolerance", how.tolerance}, {"depth_tolerance_mm", how.depth_tolerance_mm}};
        passes.insert(passes.end() - 1, coarse);
        scene["targets"]["volume.coarse"] = {{"format", "rgba32f"}, {"scale", how.scale}};
        return scene;
    }
    Image shot(const json& scene, std::string_view target = "volume.colour", FrameReport* report = nullptr) {
        return mixed_shot(stage_, scene, volume_, target, report);
    }

    TempFolder folder_;
    std::string ball_ = folder_.write("ball.obj", obj_text(ball_mesh({12, -20, 15}, 45, 16))).string();
    LiveVolume volume_{shell_volume()};
    Stage stage_{Backend::osmesa, {}, GetParam()};
};

bool same_pixel(const Image& a, int ax, int ay, const Image& b, int bx, int by) {
    for (int c = 0; c < 4; ++c) {
        if (a.at(ax, ay, c) != b.at(bx, by, c)) {
            return false;
        }
    }
    return true;
}

TEST_P(MixedResolution, CoarseTexelsAreRaysOfTheFullPicture) {
    for (const bool mesh : {false, true}) {
        json scene = full_scene(mesh);
        // Nothing behind, which the coarse pass leaves to the fine one.
        scene["passes"].back()["targets"] = {{"background", "nothing"}};
        const Image full = shot(scene);
        for (const double scale : {0.5, 0.37, 0.25, 1.0}) {
            const Image coarse = shot(in_mixed(scene, {.scale = scale}), "volume.coarse");
            for (int y = 0; y < coarse.height; ++y) {
                for (int x = 0; x < coarse.width; ++x) {
                    ASSERT_TRUE(same_pixel(coarse, x, y, full, MixedPicture::line_of(x, coarse.width, width),
                                           MixedPicture::line_of(y, coarse.height, height)))
                        << "texel " << x << "," << y << " at " << scale;
                }
            }
        }
    }
}

TEST_P(MixedResolution, EveryPixelIsFilledInAsTheReferenceDoesOrTheFullPictures) {
    for (const bool mesh : {false, true}) {
        json scene = full_scene(mesh);
        scene["passes"].back()["targets"] = {{"background", "nothing"}};
        const Image full = shot(scene);
        const Image depth = mesh ? shot(scene, "mesh.depth") : Image();
        const View view = stage_.renderer().still(0.0).eye();
        for (const Mixed& how : {Mixed{}, Mixed{.scale = 0.37, .tolerance = 0.05}, Mixed{.scale = 0.3}}) {
            const json mixed = in_mixed(scene, how);
            const Image coarse = shot(mixed, "volume.coarse");
            const Image got = shot(mixed);
            const MixedPicture wanted(coarse, {width, height}, mesh ? &depth : nullptr);
            const auto share_of = [&](int x, int y) {
                const auto pixel = wanted.at(x, y);
                if (!pixel) {
                    return 2.0;
                }
                if (!mesh) {
                    return 0.0;
                }
                const double ndc = 2.0 * depth.at(x, y, 0) - 1.0;
                const double rise = ndc + view.projection[2][2];
                const PixelRay ray = pixel_ray(view, x, y, width, height);
                return pixel->depth_gap * 2.0 * std::abs(view.projection[3][2]) / (rise * rise) /
                       glm::dot(ray.direction, view.forward) / how.depth_tolerance_mm;
            };
            std::size_t filled = 0;
            std::size_t cast = 0;
            std::size_t unsure = 0;
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    // What holds for one pixel holds for its tile.
                    const int tile_x = x / MixedPicture::tile_size;
                    const int tile_y = y / MixedPicture::tile_size;
                    double share = wanted.bend(tile_x, tile_y) / how.tolerance;
                    for (int j = 0; j < MixedPicture::tile_size; ++j) {
                        for (int i = 0; i < MixedPicture::tile_size; ++i) {
                            share = std::max(share, share_of(MixedPicture::tile_size * tile_x + i,
                                                             MixedPicture::tile_size * tile_y + j));
                        }
                    }
                    const auto pixel = wanted.at(x, y);
                    // The rounding of a depth is 0.02 mm here.
                    if (share > 0.7 && share < 1.4 && !pixel->copied) {
                        ++unsure;
                        continue;
                    }
                    if (share > 1.0 || pixel->copied) {
                        ++cast;
                        ASSERT_TRUE(same_pixel(got, x, y, full, x, y)) << "cast at " << x << "," << y;
                        continue;
                    }
                    ++filled;
                    for (int c = 0; c < 4; ++c) {
                        ASSERT_NEAR(got.at(x, y, c), std::clamp(pixel->colour[c], 0.0, c == 3 ? 1.0 : 1e9),
                                    1e-6)
                            << "filled in at " << x << "," << y;
                    }
                }
            }
            EXPECT_GT(filled, 1000U);
            EXPECT_GT(cast, 300U);
            EXPECT_LT(unsure, 1200U);
        }
    }
}

TEST_P(MixedResolution, WithoutToleranceEveryRayIsCast) {
    json scene = full_scene(true);
    // Also where the last tiles reach beyond the picture.
    for (const json& size : {json{width, height}, json{97, 83}, json{94, 81}}) {
        scene["resolution"] = size;
        const Image full = shot(scene);
        for (const double scale : {0.5, 0.25, 0.37}) {
            const Difference d = difference(shot(in_mixed(scene, {.scale = scale, .tolerance = 0.0})), full);
            EXPECT_EQ(d.max, 0.0) << scale << " of " << size;
            EXPECT_GT(d.seen, 1500U);
        }
    }
}

TEST_P(MixedResolution, AtFullSizeEveryPixelIsCopied) {
    const json scene = full_scene(true);
    const Image full = shot(scene);
    // Whatever the tolerance: there is nothing between the texels.
    for (const double tolerance : {0.0, 1e9}) {
        const Mixed how{.scale = 1.0, .tolerance = tolerance, .depth_tolerance_mm = tolerance};
        EXPECT_EQ(difference(shot(in_mixed(scene, how)), full).max, 0.0);
    }
}

TEST_P(MixedResolution, EdgesOfMeshesAreExact) {
    // The volume is smooth, so that only the mesh has edges; and its tolerance could hardly be larger.
    json parameters{{"transfer_function",
                     {{"points",
                       {{{"value", 0}, {"colour", {0.3, 0.6, 1}}, {"opacity", 0.006}},
                        {{"value", 255}, {"colour", {1, 0.6, 0.3}}, {"opacity", 0.006}}}}}}};
    const json scene = full_scene(true, parameters);
    const Image full = shot(scene);
    const Image depth = shot(scene, "mesh.depth");
    for (const double scale : {0.5, 0.25, 0.37}) {
        const Image got = shot(in_mixed(scene, {.scale = scale, .tolerance = 0.2}));
        std::size_t edges = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const bool covered = depth.at(x, y, 0) < 1.0F;
                bool edge = false;
                for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                    const int i = std::clamp(x + dx, 0, width - 1);
                    const int j = std::clamp(y + dy, 0, height - 1);
                    edge = edge || (depth.at(i, j, 0) < 1.0F) != covered;
                }
                if (edge) {
                    ++edges;
                    ASSERT_TRUE(same_pixel(got, x, y, full, x, y)) << x << "," << y << " at " << scale;
                }
            }
        }
        EXPECT_GT(edges, 150U);
        EXPECT_GT(difference(got, full).max, 0.0) << "something was to be filled in";
    }
}

TEST_P(MixedResolution, ConstantsAndRampsAreExact) {
    // Along parallel rays through a volume whose value grows across the view, the mean is a ramp.
    // Whole numbers at the voxels, so that nothing is rounded.
    volume_.replace(byte_volume(32, 5.0, [](const glm::dvec3& p) {
        return 20.0 + 4.0 * (p.x + 77.5) / 5.0 + 2.0 * (p.z + 77.5) / 5.0;
    }));
    json camera = orthographic_at({0, -420, 0});
    camera["target_mm"] = {0, 0, 0};
    camera["height_mm"] = 100;
    json parameters{{"function", "average"},
                    {"transfer_function",
                     {{"entries", 16384},
                      {"interpolate", true},
                      {"points",
                       {{{"value", 0}, {"colour", {0, 0, 0}}, {"opacity", 1}},
                        {{"value", 250}, {"colour", {1, 1, 1}}, {"opacity", 1}}}}}}};
    const json scene = mixed_scene(json::array(), parameters, camera, width, height);
    const Image full = shot(scene);
    for (const double scale : {0.5, 0.25, 0.37}) {
        const Image got = shot(in_mixed(scene, {.scale = scale, .tolerance = 1e9}));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                ASSERT_EQ(got.at(x, y, 3), 1.0F) << "a constant";
                ASSERT_NEAR(got.at(x, y, 0), full.at(x, y, 0), 3e-6) << "a ramp";
            }
        }
        EXPECT_GT(std::abs(got.at(90, 70, 0) - got.at(5, 5, 0)), 0.2F);
    }
}

TEST_P(MixedResolution, WithoutACoarsePictureEveryRayIsCast) {
    const json scene = full_scene(true);
    const Image full = shot(scene);
    json alone = in_mixed(scene, {});
    alone["passes"][1]["enabled"] = false;
    alone["targets"].erase("volume.coarse");
    FrameReport report;
    EXPECT_EQ(difference(shot(alone, "volume.colour", &report), full).max, 0.0);
    EXPECT_EQ(pass_of(report, "cast").status, PassStatus::run);
}

TEST_P(MixedResolution, BothPassesAreSkippedTogether) {
    json scene = full_scene(true);
    scene["passes"].back()["parameters"]["volume"]["placement"]["move_mm"] = {-3000, 0, 0};
    FrameReport report;
    const Image got = shot(in_mixed(scene, {}), "volume.colour", &report);
    EXPECT_EQ(pass_of(report, "coarse").status, PassStatus::idle);
    EXPECT_EQ(pass_of(report, "cast").status, PassStatus::idle);
    EXPECT_EQ(difference(got, shot(scene, "mesh.colour")).max, 0.0);
}

TEST_P(MixedResolution, SizesThatCannotBeFilledInAreCast) {
    for (const bool mesh : {false, true}) {
        const json scene = full_scene(mesh);
        const Image full = shot(scene);
        for (const json& size : {json{{"size", {1, 1}}}, json{{"size", {3, 40}}}, json{{"scale", 4.0}}}) {
            json mixed = in_mixed(scene, {.tolerance = 1e9, .depth_tolerance_mm = 1e9});
            mixed["targets"]["volume.coarse"] = size;
            EXPECT_EQ(difference(shot(mixed), full).max, 0.0) << size;
        }
        json least = in_mixed(scene, {.tolerance = 1e9, .depth_tolerance_mm = 1e9});
        least["targets"]["volume.coarse"] = {{"size", {4, 4}}};
        for (const float value : to_floats(shot(least))) {
            ASSERT_TRUE(std::isfinite(value));
        }
    }
}

TEST_P(MixedResolution, AnEmptyDepthIsAsNone) {
    const Image without = shot(in_mixed(full_scene(false), {}));
    json scene = full_scene(true);
    scene["passes"][0]["parameters"]["placement"]["move_mm"] = {0, -5000, 0};
    EXPECT_EQ(difference(shot(in_mixed(scene, {})), without).max, 0.0);
}

INSTANTIATE_TEST_SUITE_P(By, MixedResolution, testing::Values(ComputeUse::off, ComputeUse::on),
                         [](const auto& info) {
                             return info.param == ComputeUse::on ? "ComputeShader" : "FragmentShader";
                         });

TEST(MixedResolutionLattice, TexelsHaveDifferentPixelsAndTheReferencesOnes) {
    for (const int lines : {1, 2, 5, 64, 97, 16384}) {
        for (int texels = 1; texels <= std::min(lines, 130); ++texels) {
            int last = -1;
            for (int t = 0; t < texels; ++t) {
                const int line = volume::lattice_line(t, texels, lines);
                ASSERT_GT(line, last);
                ASSERT_LT(line, lines);
                ASSERT_EQ(line, MixedPicture::line_of(t, texels, lines));
                last = line;
            }
        }
    }
    EXPECT_TRUE(volume::can_fill({4, 4}, {4, 9}, {8, 18}));
    EXPECT_FALSE(volume::can_fill({3, 9}, {9, 9}, {9, 9}));
    EXPECT_FALSE(volume::can_fill({5, 5}, {4, 9}, {9, 9}));
    EXPECT_FALSE(volume::can_fill({5, 5}, {9, 9}, {9, 4})) << "a picture that is drawn smaller";
}

}  // namespace
}  // namespace viscera::test
