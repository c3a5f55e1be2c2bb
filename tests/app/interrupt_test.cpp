#include "engine/io/volume.h"
#include "tests/app/app_test.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;

class Interrupt : public AppTest {
  protected:
    /// A scene with a volume beside it.
    void write_volume_scene() {
        Volume volume;
        volume.grid.dims = glm::ivec3(16);
        volume.grid.origin_mm = glm::dvec3(-7.5);
        volume.voxels.assign(16 * 16 * 16, std::byte{100});
        io::write_volume(volume, folder_ / "cube.nrrd");
        write_scene(nlohmann::json::parse(R"({
            "version": 1, "resolution": [32, 24], "camera": {"eye_mm": [0, -80, 0]},
            "passes": [{"name": "cast", "effect": "volume.ray_cast", "parameters": {
                "volume": {"file": "cube.nrrd"},
                "transfer_function": {"points": [{"value": 0, "opacity": 0}, {"value": 200, "opacity": 0.5}]}}}],
            "outputs": ["volume.colour"]})"));
    }
};

TEST_F(Interrupt, CtrlCEndsASequenceCleanlyWithWhatWasDone) {
    // --foreground: one signal, as a terminal sends it, and not a second one to the group.
    const Ended ended = run({"timeout", "--foreground", "--preserve-status", "-s", "INT", "5", VISCERA_APP,
                             "render", path("scene.json"), "-o", path("out"), "--backend", "osmesa",
                             "--frames", "0:10000000", "--report", path("report.json")});
    EXPECT_EQ(ended.code, 130) << "signal " << ended.signal << "\n" << ended.err;
    EXPECT_THAT(ended.err, testing::ContainsRegex("cancelled after [0-9]+ of 10000000 frames"));
    // What was announced as done is whole: as many files as frames in the report, none torn.
    const std::size_t frames = report().at("frames").size();
    EXPECT_GE(frames, 1U);
    std::size_t pictures = 0;
    for (const std::string& file : files()) {
        pictures += file.ends_with(".exr") ? 1U : 0U;
        EXPECT_TRUE(file.ends_with(".exr") || file.ends_with(".png")) << file;
    }
    EXPECT_EQ(pictures, frames);
}

TEST_F(Interrupt, ProgressNamesWhatIsLoaded) {
    write_volume_scene();
    const Ended told = render({"--progress"});
    expect_fine(told);
    EXPECT_THAT(told.err, HasSubstr("loading cube.nrrd 100 %"));
    EXPECT_THAT(told.err, HasSubstr("1 of 1 frames"));
    const Ended silent = render();
    expect_fine(silent);
    EXPECT_THAT(silent.err, testing::Not(HasSubstr("loading")));
}

}  // namespace
}  // namespace viscera::test
