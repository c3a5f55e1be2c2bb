#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <ostream>

#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"

// Files that are written anew while a renderer lives.

namespace viscera::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Rewritten {
    const char* name;
    const char* before;  ///< in assets, as the other
    const char* after;
    const char* target;
    json (*scene)(const std::string& file);
};
void PrintTo(const Rewritten& rewritten, std::ostream* out) {
    *out << rewritten.name;
}

json volume_scene(const std::string& file, const json& transfer) {
    const json camera{{"kind", "perspective"},
                      {"eye_mm", {300, -260, 210}},
                      {"target_mm", {0, 0, 0}},
                      {"vertical_fov_deg", 40}};
    return scene_of(
        camera,
        {pass("volume", "volume.ray_cast", {{"volume", {{"file", file}}}, {"transfer_function", transfer}})},
        {"volume.colour"}, 32, 32);
}

json organ_scene(json parameters) {
    parameters["mesh"] = {{"file", "../meshes/organ.glb"}};
    const json camera{{"kind", "perspective"},
                      {"eye_mm", {10, -35, -190}},
                      {"target_mm", {-5, 10, 0}},
                      {"up", {0, -1, 0}},
                      {"vertical_fov_deg", 55}};
    return scene_of(camera, {pass("o", "organ.surface", parameters)}, {"organ.color"}, 64, 64);
}

const Rewritten cases[] = {
    {"picture", "images/thorax.exr", "images/thorax_rao_caudal.exr", "background",
     [](const std::string& file) {
         return scene_of(tube_camera(), {pass("p", "picture.image", {{"file", file}})}, {"background"}, 32,
                         32);
     }},
    {"mesh", "meshes/tube.glb", "meshes/hook.glb", "mesh.colour",
     [](const std::string& file) {
         return scene_of(tube_camera(), {pass("m", "mesh.surface", {{"mesh", file}})}, {"mesh.colour"}, 64,
                         64);
     }},
    {"silhouette", "meshes/tube.glb", "meshes/hook.glb", "contrast.mask",
     [](const std::string& file) {
         return scene_of(tube_camera(), {pass("s", "contrast.silhouette", {{"mesh", file}})},
                         {"contrast.mask"}, 64, 64);
     }},
    {"vessel", "meshes/tube.glb", "meshes/hook.glb", "contrast.main",
     [](const std::string& file) {
         json parameters = tube_parameters();
         parameters["vessel"]["mesh"] = file;
         return scene_of(tube_camera(), {pass("v", "contrast.main", parameters)}, {"contrast.main"}, 64, 64);
     }},
    {"bake", "meshes/organ.glb", "meshes/abdomen.glb", "tissue.position",
     [](const std::string& file) {
         return scene_of(tube_camera(),
                         {pass("b", "tissue.bake", {{"mesh", {{"file", file}}}, {"size", 64}})},
                         {"tissue.position"}, 64, 64);
     }},
    {"organ_colours", "images/organ_diffuse.png", "images/abdomen_diffuse.png", "organ.color",
     [](const std::string& file) {
         return organ_scene({{"diffuse_map", file}});
     }},
    {"organ_slopes", "images/organ_normal.png", "images/abdomen_normal.png", "organ.color",
     [](const std::string& file) {
         return organ_scene({{"normal_map", {{"map", file}}}});
     }},
    {"volume", "volumes/artery.nrrd", "volumes/fetus.nrrd", "volume.colour",
     [](const std::string& file) {
         return volume_scene(file, {{"window", {{"width", 200}, {"level", 100}}}});
     }},
    {"transfer_function", "transfer_functions/ct-bone.json", "transfer_functions/ct-lung.json",
     "volume.colour",
     [](const std::string& file) {
         return volume_scene("../volumes/head.mha", {{"file", file}});
     }},
};

class RewrittenFiles : public testing::TestWithParam<Rewritten> {};

TEST_P(RewrittenFiles, AreReadAnewWithTheNextScene) {
    const fs::path assets = fs::path(VISCERA_SOURCE_DIR) / "assets";
    const TempFolder folder;
    const fs::path file = folder / ("file" + fs::path(GetParam().before).extension().string());
    const json scene = GetParam().scene(file.string());
    constexpr double time_s = 0.6;
    fs::copy_file(assets / GetParam().before, file);
    Stage stage;
    stage.load(scene);
    const Image first = stage.shot(GetParam().target, time_s);
    const auto written = fs::last_write_time(file);
    fs::copy_file(assets / GetParam().after, file, fs::copy_options::overwrite_existing);
    fs::last_write_time(file, written + std::chrono::seconds(1));
    EXPECT_TRUE(stage.shot(GetParam().target, time_s).data == first.data) << "frames look at no files";
    stage.load(scene);
    const Image second = stage.shot(GetParam().target, time_s);
    stage.load(scene);
    const std::size_t assets_held = stage.renderer().asset_count();
    EXPECT_TRUE(stage.shot(GetParam().target, time_s).data == second.data);
    EXPECT_EQ(stage.renderer().asset_count(), assets_held) << "what was not written is not read again";
    Stage fresh;
    fresh.load(scene);
    EXPECT_TRUE(second.data == fresh.shot(GetParam().target, time_s).data);
    EXPECT_FALSE(second.data == first.data);
    fresh.make_current();
}

INSTANTIATE_TEST_SUITE_P(Kinds, RewrittenFiles, testing::ValuesIn(cases),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace viscera::test
