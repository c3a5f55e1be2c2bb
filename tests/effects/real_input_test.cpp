#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "engine/core/image_compare.h"
#include "engine/io/mesh.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

const std::filesystem::path data = std::filesystem::path(VISCERA_DATA_DIR) / "vessels";

class RealInput : public testing::Test {
  protected:
    void SetUp() override {
        if (std::string_view(VISCERA_DATA_DIR).empty() || !std::filesystem::is_directory(data)) {
            GTEST_SKIP() << "no real vessels: VISCERA_DATA_DIR is empty or wrong";
        }
    }
    /// The chain of assets/scenes/vessels.json over a vessel of one's own.
    void load(const json& vessel, const json& camera) {
        stage_.load(scene_of(camera,
                             {{{"name", "vessels"},
                               {"effect", "contrast.geometry"},
                               {"parameters",
                                {{"vessel", vessel},
                                 {"bolus", {{"duration_s", 3}, {"rise_s", 0.2}, {"washout_s", 0.3}}},
                                 {"cloud", {{"radius_mm", 5}}}}}},
                              {{"name", "summarize"}, {"effect", "contrast.summarize"}},
                              {{"name", "composite"}, {"effect", "contrast.composite"}}},
                             {"final"}, 192, 192));
    }
    /// Share of the target that contrast covers; everything finite.
    double covered(double time_s) {
        const Image main = stage_.shot("contrast.main", time_s);
        double sum = 0.0;
        for (const float value : to_floats(main)) {
            EXPECT_TRUE(std::isfinite(value));
            sum += value > 0.05F ? 1.0 : 0.0;
        }
        return sum / (static_cast<double>(main.width) * main.height);
    }
    /// Contrast comes, fills and leaves.
    void expect_injection(double filled_s, double washed_out_s) {
        EXPECT_EQ(covered(-0.1), 0.0);
        const double early = covered(0.25 * filled_s);
        const double full = covered(filled_s);
        EXPECT_GT(early, 0.0);
        EXPECT_GT(full, 1.5 * early);
        EXPECT_EQ(covered(washed_out_s), 0.0);
    }

    Stage stage_;
};

json aorta_camera() {
    return {{"kind", "orthographic"},
            {"eye_mm", {222, 140, 400}},
            {"target_mm", {222, 140, 24}},
            {"up", {0, 1, 0}},
            {"height_mm", 100}};
}

json aorta(const std::string& file) {
    return {{"mesh", (data / file).string()}, {"centreline", (data / "aorta-centerline.vtp").string()}};
}

TEST_F(RealInput, AnAortaFillsAlongItsCentreline) {
    load(aorta("aorta-surface.stl"), aorta_camera());
    expect_injection(0.6, 20.0);  // 84 mm at about 250 mm/s
}

TEST_F(RealInput, NormalsAndTrianglesMayPointInward) {
    Log log;
    const MeshData inward = io::merge(io::load_meshes(data / "aorta-surface.stl", {}, log));
    // The same triangles the other way round, as OBJ.
    const std::filesystem::path turned =
        std::filesystem::path(testing::TempDir()) / "viscera_turned_aorta.obj";
    {
        std::ofstream file(turned);
        file.precision(9);
        for (const glm::vec3& p : inward.positions) {
            file << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
        }
        for (std::size_t i = 0; i < inward.indices.size(); i += 3) {
            file << "f " << inward.indices[i] + 1 << ' ' << inward.indices[i + 2] + 1 << ' '
                 << inward.indices[i + 1] + 1 << '\n';
        }
    }
    load(aorta("aorta-surface.stl"), aorta_camera());
    const Image as_it_is = stage_.shot("final", 0.8);
    json vessel = aorta("aorta-surface.stl");
    vessel["mesh"] = turned.string();
    load(vessel, aorta_camera());
    const Image outward = stage_.shot("final", 0.8);
    std::filesystem::remove(turned);
    // Interpolation along turned triangles rounds differently, by at most one unit of half a float below 1.
    const CompareResult result = compare(as_it_is, outward, {.max = 4.9e-4, .mean = 1e-5});
    EXPECT_TRUE(result.equal) << result.reason;
}

TEST_F(RealInput, EveryFormatOfOneSurfaceGivesOnePicture) {
    load(aorta("aorta-surface.stl"), aorta_camera());
    const Image stl = stage_.shot("final", 0.8);
    load(aorta("aorta-surface.vtp"), aorta_camera());
    const Image vtp = stage_.shot("final", 0.8);
    // STL's vertices are joined in another order, so the front's smoothing sums in another order.
    const CompareResult result = compare(stl, vtp, {.max = 2e-3, .mean = 1e-5});
    EXPECT_TRUE(result.equal) << result.reason;
}

TEST_F(RealInput, VesselsOfAWholeTrunkFillOverTheirSurface) {
    load({{"mesh", (data / "VH_F_Vasculature.glb").string()},
          {"injection_mm", {0, 480, -20}},
          {"geodesic", {{"speed_mm_s", 250}, {"bridge_mm", 3}}}},
         {{"kind", "orthographic"},
          {"eye_mm", {20, 280, 800}},
          {"target_mm", {20, 280, -24}},
          {"up", {0, 1, 0}},
          {"height_mm", 640}});
    expect_injection(2.5, 30.0);
}

}  // namespace
}  // namespace viscera::test
