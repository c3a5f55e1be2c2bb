#include "engine/io/exr.h"
#include "engine/io/png.h"
#include "tests/app/app_test.h"

namespace viscera::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Render : public AppTest {
  protected:
    [[nodiscard]] io::ExrPart part(std::string_view file) const {
        return io::read_exr(folder_ / (std::string("out/") + std::string(file))).at(0);
    }
};

float number(const io::ExrPart& part, std::string_view name) {
    for (const io::ExrAttribute& attribute : part.attributes) {
        if (attribute.name == name) {
            return std::get<float>(attribute.value);
        }
    }
    ADD_FAILURE() << "no attribute " << name;
    return -1.0F;
}

TEST_F(Render, WritesItsOutputsAndSaysWhatItDid) {
    const Ended ended = render();
    expect_fine(ended);
    EXPECT_THAT(files(), ElementsAre("0000.final.exr", "0000.final.png"));
    EXPECT_THAT(ended.out, HasSubstr("frame 0"));
    EXPECT_THAT(ended.out, testing::ContainsRegex("vessels +(run|reduced)"));
    EXPECT_THAT(ended.out, testing::ContainsRegex("unused +culled"));
    EXPECT_THAT(ended.err, HasSubstr("osmesa"));
    EXPECT_THAT(ended.err, HasSubstr("(software)"));
    EXPECT_THAT(ended.out, Not(HasSubstr("llvmpipe")));
}

TEST_F(Render, TheHeaderTellsSceneTimeCameraAndRenderer) {
    expect_fine(render({"--time", "0.75"}));
    const io::ExrPart final = part("0000.final.exr");
    std::set<std::string> names;
    for (const io::ExrAttribute& attribute : final.attributes) {
        names.insert(attribute.name);
    }
    for (const char* name : {"viscera:scene_hash", "viscera:camera", "viscera:renderer", "viscera:time_s"}) {
        EXPECT_TRUE(names.contains(name)) << name;
    }
    EXPECT_EQ(number(final, "viscera:time_s"), 0.75F);
    EXPECT_EQ(final.image.width, 48);
    EXPECT_EQ(final.image.height, 32);
}

TEST_F(Render, TheReportHasTheDocumentedShape) {
    expect_fine(render({"--report", path("report.json"), "--dump", "all"}));
    const json document = report();
    for (const char* key : {"renderer", "backend", "version", "scene", "scene_hash"}) {
        EXPECT_TRUE(document.at(key).is_string()) << key;
    }
    EXPECT_EQ(document.at("backend"), "osmesa");
    EXPECT_TRUE(document.at("software").get<bool>());
    ASSERT_EQ(document.at("frames").size(), 1U);
    const json& frame = document["frames"][0];
    ASSERT_EQ(frame.at("passes").size(), 3U);
    const std::set<std::string> known{"run", "culled", "idle", "cached", "reduced"};
    for (const json& pass : frame["passes"]) {
        EXPECT_TRUE(pass.at("name").is_string());
        EXPECT_TRUE(pass.at("effect").is_string());
        EXPECT_TRUE(known.contains(pass.at("status").get<std::string>()));
        EXPECT_TRUE(pass.at("reason").is_string());
        EXPECT_TRUE(pass.at("cpu_ms").is_number());
        EXPECT_TRUE(pass.at("gpu_ms").is_null());
    }
    EXPECT_EQ(frame["passes"][1].at("status"), "culled");
    EXPECT_FALSE(frame["passes"][1].at("reason").get<std::string>().empty());
    ASSERT_EQ(frame.at("targets").size(), 2U);
    for (const json& target : frame["targets"]) {
        EXPECT_EQ(target.at("format"), "r16f");
        EXPECT_EQ(target.at("width"), 48);
        EXPECT_EQ(target.at("height"), 32);
        EXPECT_TRUE(std::filesystem::exists(target.at("file").get<std::string>()));
        EXPECT_LT(target.at("min").get<double>(), target.at("max").get<double>());
        EXPECT_EQ(target.at("nan"), 0);
        EXPECT_EQ(target.at("inf"), 0);
    }
}

TEST_F(Render, FramesAreNumberedAndTimed) {
    expect_fine(render({"--frames", "2:5", "--report", path("report.json"), "--progress"}));
    EXPECT_THAT(files(), ElementsAre("0002.final.exr", "0002.final.png", "0003.final.exr", "0003.final.png",
                                     "0004.final.exr", "0004.final.png"));
    const json document = report();
    ASSERT_EQ(document["frames"].size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(document["frames"][i]["frame"], 2 + i);
        EXPECT_NEAR(document["frames"][i]["time_s"].get<double>(), 0.1 * static_cast<double>(2 + i), 1e-12);
    }
    EXPECT_NE(part("0002.final.exr").image.data, part("0004.final.exr").image.data) << "contrast moves on";
}

TEST_F(Render, WrongFrameRangesAreUsageErrors) {
    for (const char* range : {"5:2", "3:3", "a:b", "1:", ":4", "-1:3", "1:2:3", ""}) {
        const Ended ended = render({std::string("--frames=") + range});
        EXPECT_EQ(ended.code, 2) << range << "\n" << ended.err;
    }
    expect_refused(render({"--frames", "0:2", "--time", "1"}), 2, "--time");
    EXPECT_THAT(files(), ElementsAre());
}

TEST_F(Render, DumpsWhatIsAskedFor) {
    expect_fine(render({"--dump", "all"}));
    EXPECT_THAT(files(), ElementsAre("0000.contrast.main.exr", "0000.final.exr", "0000.final.png"));
    std::filesystem::remove_all(folder_ / "out");
    expect_fine(render({"--dump", "contrast.main"}));
    EXPECT_THAT(files(), ElementsAre("0000.contrast.main.exr"));
    expect_refused(render({"--dump", "contrast.mane"}), 3, "contrast.mane");
}

TEST_F(Render, EveryCompressionIsHonoured) {
    for (const std::string name : {"none", "zips", "zip", "piz", "dwaa"}) {
        expect_fine(render({"--exr-compression", name}));
        EXPECT_EQ(part("0000.final.exr").compression, name);
    }
    expect_refused(render({"--exr-compression", "lzw"}), 2, "lzw");
}

TEST_F(Render, OneFileCanHoldAllTargets) {
    expect_fine(render({"--exr-multipart", "--dump", "all"}));
    EXPECT_THAT(files(), ElementsAre("0000.exr", "0000.final.png"));
    EXPECT_EQ(io::read_exr(folder_ / "out/0000.exr").size(), 2U);
}

TEST_F(Render, SetChangesTheScene) {
    expect_fine(render({"--set", "/passes/2/parameters/background=0.25", "--set", "/time_s=-5"}));
    const io::ExrPart final = part("0000.final.exr");
    for (const float value : to_floats(final.image)) {
        ASSERT_EQ(value, 0.25F) << "before the bolus there is the background and nothing else";
    }
    expect_refused(render({"--set", "/passes/2/parameters/bakground=0.25"}), 3, "background");
    expect_refused(render({"--set", "/passes/9/name=x"}), 3, "/passes/9");
    expect_refused(render({"--set", "time_s=1"}), 2, "time_s");
    expect_refused(render({"--set", "/time_s"}), 2, "/time_s");
    expect_refused(render({"--set", "/time_s=soon"}), 3, "/time_s");
}

TEST_F(Render, ResolutionOverridesTheScenes) {
    expect_fine(render({"--resolution", "20x10"}));
    EXPECT_EQ(part("0000.final.exr").image.width, 20);
    EXPECT_EQ(io::read_image(folder_ / "out/0000.final.png").height, 10);
    for (const char* wrong : {"20", "x", "0x5", "-3x5", "20x10x3", "20 x 10", "1e3x5"}) {
        expect_refused(render({std::string("--resolution=") + wrong}), 2, "--resolution");
    }
    expect_refused(render({"--resolution", "1000000x4"}), 7, "1000000x4");
    expect_refused(render({"--resolution", "2147483647x2147483647"}), 7, "device");
}

TEST_F(Render, BackendsAgree) {
    expect_fine(render());
    const io::ExrPart osmesa = part("0000.final.exr");
    int others = 0;
    for (const std::string backend : {"egl", "egl-surfaceless", "egl-device", "auto"}) {
        const Ended ended = viscera({"render", path("scene.json"), "-o", path("out"), "--backend", backend});
        if (ended.code == 5) {
            EXPECT_FALSE(ended.err.empty());
            continue;
        }
        expect_fine(ended);
        ++others;
        if (ended.err.find("llvmpipe") != std::string::npos) {
            EXPECT_EQ(part("0000.final.exr").image.data, osmesa.image.data) << backend;
        }
    }
    EXPECT_GT(others, 0);
}

TEST_F(Render, RefusedBackendsSayWhy) {
    expect_refused(viscera({"render", path("scene.json"), "--backend", "vulkan"}), 2, "vulkan");
    expect_refused(viscera({"render", path("scene.json"), "--set", "/passes/7/parameters/x=1"}), 3,
                   "/passes/7");
    expect_refused(viscera({"render", path("scene.json"), "-o", path("out"), "--backend", "glfw"}), 5,
                   "isplay");
    expect_refused(viscera({"render", path("scene.json"), "-o", path("out"), "--egl-device", "99",
                            "--backend", "egl-device"}),
                   5, "99");
    expect_refused(viscera({"render", path("scene.json"), "-o", path("out"), "--egl-device", "99"}), 5,
                   "there is no EGL device 99");
    const Ended hardware = render({"--require-hardware"});
    expect_refused(hardware, 5, "hardware is required");
    EXPECT_THAT(files(), ElementsAre());
}

TEST_F(Render, RequireHardwareNeverEndsInSoftware) {
    const Ended ended = viscera({"render", path("scene.json"), "-o", path("out"), "--require-hardware"});
    if (ended.code == 0) {
        EXPECT_THAT(ended.err, Not(HasSubstr("llvmpipe")));
        return;
    }
    expect_refused(ended, 5, "hardware is required");
}

TEST_F(Render, BrokenShadersNameFileAndLine) {
    std::filesystem::copy(std::filesystem::path(VISCERA_SOURCE_DIR) / "glsl", folder_ / "glsl",
                          std::filesystem::copy_options::recursive);
    expect_fine(render({"--glsl", path("glsl")}));
    std::ofstream(folder_ / "glsl/contrast/composite.frag", std::ios::app) << "nonsense;\n";
    expect_refused(render({"--glsl", path("glsl")}), 6, "contrast/composite.frag:");
    std::filesystem::remove(folder_ / "glsl/contrast/composite.frag");
    expect_refused(render({"--glsl", path("glsl")}), 6, "contrast/composite.frag");
}

TEST_F(Render, FilesThatCannotBeReadOrWrittenAreNamed) {
    expect_refused(viscera({"render", path("none.json")}), 4, "none.json");
    expect_refused(viscera({"render", folder_.path().string()}), 4, folder_.path().string());
    expect_refused(viscera({"render", path("scene.json"), "--backend", "osmesa", "-o", "/proc/none"}), 4,
                   "/proc/none");
    (void)folder_.write("taken", "a file");
    expect_refused(viscera({"render", path("scene.json"), "--backend", "osmesa", "-o", path("taken")}), 4,
                   "taken");
    const Ended ended = render({"--report", path("none/report.json")});
    EXPECT_EQ(ended.code, 4);
    EXPECT_THAT(ended.err, HasSubstr("none/report.json"));
    EXPECT_THAT(files(), testing::IsEmpty()) << "said before anything is drawn";
    scene_["passes"][0]["parameters"]["vessel"]["mesh"] = "gone.glb";
    write_scene(scene_);
    expect_refused(render(), 4, "gone.glb");
    (void)folder_.write("gone.glb", tetra_glb().substr(0, 200));
    expect_refused(render(), 4, "gone.glb");
}

TEST_F(Render, AFullDiskIsAnErrorAndLeavesNoTornFile) {
    // The small PNG still fits, the uncompressed EXR does not.
    const Ended ended = render({"--frames", "0:3", "--exr-compression", "none"}, {.most_file_bytes = 2000});
    EXPECT_EQ(ended.code, 4) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("0000.final.exr"));
    EXPECT_THAT(files(), ElementsAre("0000.final.png"));
    EXPECT_GT(io::read_image(folder_ / "out/0000.final.png").width, 0);
}

TEST_F(Render, ScenesAtFaultNameEveryFault) {
    scene_["passes"][0]["parameters"]["tone"] = "loud";
    scene_["passes"][2]["effect"] = "contrast.compost";
    write_scene(scene_);
    const Ended ended = render();
    expect_refused(ended, 3, "scene.json");
    EXPECT_THAT(ended.err, HasSubstr("/passes/0/parameters/tone"));
    EXPECT_THAT(ended.err, HasSubstr("contrast.composite"));
    (void)folder_.write("scene.json", "{\"version\": 1,\n nonsense}");
    expect_refused(render(), 3, "line 2");
}

TEST_F(Render, SurvivedFaultsAreCounted) {
    std::string binary = tetra_binary();
    const std::string nan = bytes_of(std::numeric_limits<float>::quiet_NaN());
    binary.replace(72, 4, nan);
    (void)folder_.write("tetra.glb", glb(tetra_json(), binary));
    scene_["passes"][0]["parameters"] = {
        {"vessel", {{"mesh", "tetra.glb"}, {"mm_per_unit", 1}, {"density", "per_vertex"}}}};
    write_scene(scene_);
    const Ended ended = render({"--report", path("report.json"), "--frames", "0:4"});
    expect_fine(ended);
    EXPECT_EQ(report().at("faults").at("mesh: scalars that are not finite set to 0"), 1);
    const std::size_t first = ended.err.find("not finite");
    ASSERT_NE(first, std::string::npos);
    EXPECT_EQ(ended.err.find("not finite", first + 1), std::string::npos) << "said once";
}

/// The whole injection of the scene that the project ships, small.
TEST_F(Render, TheShippedSceneStaysFiniteAndSkipsWhatItCan) {
    const std::string scene = std::string(VISCERA_SOURCE_DIR) + "/assets/scenes/angiography.json";
    if (!std::filesystem::exists(std::string(VISCERA_SOURCE_DIR) + "/assets/meshes/coronary.glb")) {
        GTEST_SKIP() << "the assets are not made: cmake --build . --target assets";
    }
    expect_fine(
        viscera({"render", scene, "-o", path("out"), "--backend", "osmesa", "--resolution", "64x64",
                 "--frames", "0:90", "--dump", "all", "--exr-multipart", "--report", path("report.json")}));
    const json document = report();
    EXPECT_EQ(document.value("faults", json::object()), json::object()) << "nothing is amiss";
    ASSERT_EQ(document["frames"].size(), 90U);
    std::map<std::string, int> statuses;
    double darkest = 1.0;
    for (const json& frame : document["frames"]) {
        for (const json& target : frame["targets"]) {
            EXPECT_EQ(target["nan"], 0) << target;
            EXPECT_EQ(target["inf"], 0) << target;
            if (target["name"] == "final") {
                darkest = std::min(darkest, target["min"].get<double>());
            }
        }
        for (const json& pass : frame["passes"]) {
            ++statuses[pass["status"].get<std::string>()];
        }
    }
    EXPECT_LT(darkest, 0.2) << "contrast shows";
    for (const char* status : {"run", "reduced", "idle", "cached"}) {
        EXPECT_GT(statuses[status], 0) << status;
    }
}

}  // namespace
}  // namespace viscera::test
