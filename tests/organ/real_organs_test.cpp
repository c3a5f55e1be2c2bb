#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "engine/io/mesh.h"
#include "engine/io/png.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/surface_mesh.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"

// Organs of real people: baked, burnt, bleeding and lit. VISCERA_SAVE_PICTURES names a folder for the
// pictures.
namespace viscera::test {
namespace {

using nlohmann::json;

const std::filesystem::path organs = std::filesystem::path(VISCERA_DATA_DIR) / "organs";

class RealOrgan : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (std::string_view(VISCERA_DATA_DIR).empty() || !std::filesystem::is_directory(organs)) {
            GTEST_SKIP() << "no real organs: VISCERA_DATA_DIR is empty or wrong";
        }
    }
};

double distance_to_line(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& direction) {
    return glm::length(glm::cross(p - from, direction));
}

TEST_P(RealOrgan, BleedsAndIsCoagulated) {
    const std::string file = (organs / GetParam()).string();
    std::vector<std::string> said;
    Log log([&](LogLevel, std::string_view message) { said.emplace_back(message); });
    const MeshData mesh = io::merge(io::load_meshes(file, {}, log));
    const Bounds bounds = mesh.bounds();
    const glm::dvec3 centre = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
    const double size = glm::distance(glm::dvec3(bounds.min), glm::dvec3(bounds.max));
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.35, -1.0, 0.4));
    const glm::dvec3 eye = centre + 1.1 * size * towards;
    // What lies under the crosshairs, and beside it.
    const auto seen = [&](const glm::dvec3& from) {
        glm::dvec3 best(0.0);
        double least = 1e30;
        for (const glm::vec3& p : mesh.positions) {
            const double score =
                10.0 * distance_to_line(glm::dvec3(p), from, towards) + glm::distance(glm::dvec3(p), from);
            if (score < least) {
                least = score;
                best = glm::dvec3(p);
            }
        }
        return best;
    };
    const glm::dvec3 side = 0.12 * size * glm::normalize(glm::cross(towards, glm::dvec3(0.0, 0.0, 1.0)));
    const auto place = [](const glm::dvec3& p) { return json{p.x, p.y, p.z}; };
    const glm::dvec3 burnt = seen(eye - side);
    const glm::dvec3 wound = seen(eye + side);

    const json surface{{"file", file}};
    json scene = scene_of(
        {{"kind", "perspective"},
         {"eye_mm", place(eye)},
         {"target_mm", place(centre)},
         {"up", {0, 0, 1}},
         {"vertical_fov_deg", 33},
         {"near_mm", 0.05 * size},
         {"far_mm", 4.0 * size}},
        {pass("bake", "tissue.bake", {{"mesh", surface}}), pass("gravity", "tissue.gravity"),
         pass("coagulate", "tissue.coagulate",
              {{"mesh", surface},
               {"contacts",
                {{{"from_mm", place(burnt)}, {"end_s", 2}, {"power", 1.5}, {"sigma_mm", 0.03 * size}}}}}),
         pass("blood", "tissue.blood",
              {{"mesh", surface},
               {"wounds",
                {{{"position_mm", place(wound)}, {"radius_mm", 0.01 * size}, {"rate_mm3_s", 6000}}}}}),
         pass("organ", "organ.surface",
              {{"mesh", surface},
               {"lights",
                {{{"falloff_mm", 4.0 * size},
                  {"position", {0, 0.05 * size, 0}},
                  {"angular", 1},
                  {"colour", {1.6, 1.6, 1.6}}}}},
               {"shading", {{"specular", 0.3}, {"shininess", 60}}}})},
        {"organ.color", "tissue.energy"}, 320, 240);
    Stage stage;
    stage.load(scene);
    stage.renderer().keep({"organ.color", "tissue.energy"});
    (void)stage.render(0.0);
    const Image before = stage.renderer().read("organ.color");
    for (int i = 1; i <= 12; ++i) {
        (void)stage.render(i / 8.0);
    }
    const Image after = stage.renderer().read("organ.color");
    const Image energy = stage.renderer().read("tissue.energy");
    int covered = 0;
    int redder = 0;
    int burnt_pixels = 0;
    for (int y = 0; y < after.height; ++y) {
        for (int x = 0; x < after.width; ++x) {
            for (int c = 0; c < 4; ++c) {
                ASSERT_TRUE(std::isfinite(after.at(x, y, c)));
            }
            covered += before.at(x, y, 0) > 0.005F ? 1 : 0;
            const float green_before = before.at(x, y, 1);
            redder += after.at(x, y, 1) < 0.6F * green_before && after.at(x, y, 0) > 0.02F ? 1 : 0;
            burnt_pixels += after.at(x, y, 1) > 1.4F * green_before && green_before > 0.01F ? 1 : 0;
        }
    }
    EXPECT_GT(covered, 8000) << "of 76,800 pixels";
    EXPECT_GT(std::ranges::max(to_floats(energy)), 0.5F);
    EXPECT_GT(redder, 100) << "blood";
    EXPECT_GT(burnt_pixels, 100) << "coagulated tissue is pale";
    EXPECT_LT(redder + burnt_pixels, covered / 2) << "and the rest as it was";
    if (const char* folder = std::getenv("VISCERA_SAVE_PICTURES")) {
        io::write_png(std::filesystem::path(folder) / (std::string(GetParam()) + ".png"), after,
                      {.alpha = false});
    }
}

TEST_P(RealOrgan, SaysWhoseAtlasItIsPaintedBy) {
    std::string said;
    Log log([&](LogLevel, std::string_view message) { said += std::string(message) + '\n'; });
    Assets assets(log);
    SurfaceMeshParams params;
    params.file.path = organs / GetParam();
    const std::shared_ptr<SurfaceMesh> mesh = SurfaceMesh::load(assets, params);
    const std::string_view name = GetParam();
    EXPECT_EQ(said.find("an atlas of") != std::string::npos, name != "VH_M_Spleen.glb") << said;
    if (name == "VH_M_Liver.glb") {
        EXPECT_NE(said.find("has no texture coordinates"), std::string::npos) << said;
    } else if (name == "liver-smoothUV.obj") {
        EXPECT_NE(said.find("several triangles on one place of the texture (100 % of it)"), std::string::npos)
            << said;
    }
    EXPECT_EQ(said.find("where they get one normal") != std::string::npos, name.ends_with(".glb")) << said;
    for (const glm::vec3& normal : mesh->data().normals) {
        ASSERT_NEAR(glm::length(normal), 1.0F, 1e-3F);
    }
}

INSTANTIATE_TEST_SUITE_P(Files, RealOrgan,
                         testing::Values("VH_M_Spleen.glb", "VH_M_Liver.glb", "liver-smoothUV.obj"),
                         [](const auto& info) {
                             std::string name = info.param;
                             std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                             return name;
                         });

}  // namespace
}  // namespace viscera::test
