#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "engine/core/image_compare.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/effects/vessel_picture.h"
#include "tests/io/temp_folder.h"

// Ways to one picture: three ways to find the densest fragment, one geometry pass or three, two drivers.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int overlap_side = 128;
constexpr double filling_s = 0.6;

json main_scene(json parameters, const std::string& method, bool floats) {
    parameters["method"] = method;
    json scene = scene_of(tube_camera(), json::array({pass("main", "contrast.main", std::move(parameters))}),
                          {"contrast.main"}, overlap_side, overlap_side);
    if (floats) {
        use_floats(scene, {"contrast.main"});
    }
    return scene;
}

Image main_by(Stage& stage, const json& parameters, const std::string& method, bool floats,
              const HostValues* values = nullptr) {
    stage.load(main_scene(parameters, method, floats));
    Image image = stage.shot("contrast.main", filling_s, values);
    EXPECT_TRUE(stage.complaints().empty()) << stage.complaints().front();
    return image;
}

std::size_t lit_pixels(const Image& image) {
    const std::vector<float> values = to_floats(image);
    return static_cast<std::size_t>(std::ranges::count_if(values, [](float v) { return v > 0.0F; }));
}

TEST(Overlap, DepthGivesTheMaximumBitForBit) {
    Stage stage;
    json weighted = tube_parameters();
    weighted["vessel"]["full_calibre_mm"] = 5.5;
    for (const json& parameters : {tube_parameters(), weighted}) {
        for (const bool floats : {false, true}) {
            const Image max = main_by(stage, parameters, "max", floats);
            EXPECT_GT(lit_pixels(max), 500U);
            EXPECT_EQ(max.data, main_by(stage, parameters, "depth", floats).data);
        }
    }
}

/// A mesh whose triangles share no vertex, each of a density of its own.
std::filesystem::path write_loose_triangles(const TempFolder& folder, const MeshData& mesh) {
    const std::filesystem::path file = folder / "loose.ply";
    std::ofstream out(file);
    out.precision(9);
    out << "ply\nformat ascii 1.0\nelement vertex " << mesh.indices.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty float DENSITY\nelement face "
        << mesh.triangle_count() << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const glm::vec3& p = mesh.positions[mesh.indices[i]];
        // Neighbours differ widely, no two are alike.
        const std::size_t shuffled = (i / 3 * 1013) % mesh.triangle_count();
        out << p.x << ' ' << p.y << ' ' << p.z << ' '
            << static_cast<double>(shuffled + 1) / static_cast<double>(4 * mesh.triangle_count()) << '\n';
    }
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        out << "3 " << i << ' ' << i + 1 << ' ' << i + 2 << '\n';
    }
    return file;
}

TEST(Overlap, PainterGivesTheMaximumBitForBitWhereTrianglesAreOfOneDensity) {
    const TempFolder folder;
    Stage stage;
    stage.load(main_scene(tube_parameters(), "max", false));
    const VesselPicture tube(tube_parameters(), stage.renderer().still(0.0).eye(), overlap_side,
                             overlap_side);
    ASSERT_NE(tube.vessel().mesh.triangle_count() % 1013, 0U);
    json parameters;
    parameters["vessel"] = {{"mesh", write_loose_triangles(folder, tube.vessel().mesh).string()},
                            {"density", "per_vertex"}};
    for (const bool floats : {false, true}) {
        const Image max = main_by(stage, parameters, "max", floats);
        EXPECT_GT(lit_pixels(max), 1000U);
        EXPECT_EQ(max.data, main_by(stage, parameters, "painter", floats).data);
        EXPECT_EQ(max.data, main_by(stage, parameters, "depth", floats).data);
    }
}

// Painted last is the triangle T with the densest vertex. Any other fragment of the pixel belongs to a
// triangle whose densest vertex is no denser, so the maximum exceeds what is seen by no more than the range
// of density over T, times the steepest slope of a S(a), which is 1 + 0.1752 * 10.91 = 2.912.
TEST(Overlap, PainterStaysWithinTheRangeOfDensityOverATriangle) {
    Stage stage;
    const Image max = main_by(stage, tube_parameters(), "max", true);
    const Image painter = main_by(stage, tube_parameters(), "painter", true);
    const VesselPicture tube(tube_parameters(), stage.renderer().still(0.0).eye(), overlap_side,
                             overlap_side);
    const MeshData& mesh = tube.vessel().mesh;
    const contrast::BolusParams& bolus = tube.parameters().bolus;
    const auto density = [&](std::size_t corner) {
        const double tau = static_cast<double>(tube.vessel().scalar[mesh.indices[corner]]);
        return bolus_density(bolus, filling_s - bolus.start_s - tau);
    };
    double range = 0.0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto [low, high] = std::minmax({density(i), density(i + 1), density(i + 2)});
        range = std::max(range, high - low);
    }
    ASSERT_LT(range, 0.3);  // else the bound would say nothing
    double below = 0.0;
    for (int y = 0; y < overlap_side; ++y) {
        for (int x = 0; x < overlap_side; ++x) {
            const double excess =
                static_cast<double>(max.at(x, y, 0)) - static_cast<double>(painter.at(x, y, 0));
            ASSERT_GE(excess, 0.0) << x << ' ' << y;
            ASSERT_LE(excess, 2.912 * range + float_bound) << x << ' ' << y;
            below = std::max(below, excess);
        }
    }
    std::printf("  painter below max by up to %.3g, bound %.3g\n", below, 2.912 * range);
}

TEST(FusedGeometry, EqualsThreePassesBitForBit) {
    Stage stage;
    for (const bool floats : {false, true}) {
        for (const double time_s : {0.35, filling_s, 2.4}) {
            const json outputs{"contrast.main", "contrast.cloud", "contrast.distance"};
            const json parameters = tube_parameters();
            json fused = scene_of(tube_camera(), json::array({pass("all", "contrast.geometry", parameters)}),
                                  outputs, overlap_side, overlap_side);
            json separate = scene_of(
                tube_camera(),
                {pass("main", "contrast.main", parameters), pass("cloud", "contrast.cloud", parameters),
                 pass("distance", "contrast.distance", parameters)},
                outputs, overlap_side, overlap_side);
            std::vector<Image> images;
            for (json* scene : {&fused, &separate}) {
                if (floats) {
                    use_floats(*scene, {"contrast.main", "contrast.cloud", "contrast.distance"});
                }
                stage.load(*scene);
                stage.render(time_s);
                for (const std::string name : {"contrast.main", "contrast.cloud", "contrast.distance"}) {
                    images.push_back(stage.renderer().read(name));
                }
            }
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_GT(lit_pixels(images[i]), 300U) << i << " at " << time_s;
                EXPECT_EQ(images[i].data, images[i + 3].data) << i << " at " << time_s;
            }
        }
    }
}

TEST(Backends, GiveOnePicture) {
    const auto file = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes" / "angiography.json";
    std::vector<std::map<std::string, Image>> pictures;
    for (const Backend backend : {Backend::osmesa, Backend::egl_surfaceless}) {
        Stage stage(backend);
        Scene scene = load_scene(file);
        scene.width = scene.height = overlap_side;
        stage.renderer().set_scene(std::move(scene));
        std::map<std::string, Image> targets;
        stage.renderer().set_dump({DumpRequest::Kind::all, {}}, [&](CapturedFrame&& frame) {
            for (CapturedTarget& target : frame.targets) {
                targets.emplace(target.name, std::move(target.image));
            }
        });
        stage.render(1.5);
        stage.renderer().finish_captures();
        pictures.push_back(std::move(targets));
    }
    ASSERT_GE(pictures[0].size(), 10U);
    ASSERT_EQ(pictures[0].size(), pictures[1].size());
    for (const auto& [name, image] : pictures[0]) {
        ASSERT_TRUE(pictures[1].contains(name)) << name;
        const CompareResult result = compare(image, pictures[1].at(name), {});
        std::printf("  OSMesa against EGL, %-22s largest difference %g\n", name.c_str(), result.max);
        EXPECT_EQ(image.data, pictures[1].at(name).data) << name << ": " << result.reason;
    }
    EXPECT_GT(lit_pixels(pictures[0].at("contrast.main")), 300U);
}

}  // namespace
}  // namespace viscera::test
