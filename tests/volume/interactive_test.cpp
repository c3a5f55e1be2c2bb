#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/io/volume.h"
#include "engine/runtime/sampling_rate.h"
#include "tests/volume/mixed_scene.h"

namespace viscera::test {
namespace {

/// CPU time of the whole process [ms], the threads of software renderers included: unlike the wall clock it
/// does not depend on what else the machine does.
double cpu_ms() {
    return 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

class Interactive : public testing::Test {
  protected:
    Interactive() : volume_(shell_volume(64, 3.0)) {
        stage_.load(mixed_scene({},
                                {{"transfer_function", shell_function()},
                                 {"sampling", {{"step", 0.25}, {"skip", false}, {"termination", 0.0}}}},
                                {{"eye_mm", {0, -600, 0}}, {"vertical_fov_deg", 24}}, 256, 256));
    }

    /// The camera on its way about the volume.
    [[nodiscard]] Frame frame(double degrees, const Quality& quality = {}) {
        Frame frame = stage_.renderer().still(0.0);
        CameraParams camera = stage_.renderer().scene().camera;
        const double angle = degrees * std::numbers::pi / 180.0;
        camera.eye_mm = 600.0 * glm::dvec3(std::sin(angle), -std::cos(angle), 0.1);
        frame.eyes[0] = make_view(camera, frame.aspect());
        frame.volumes = std::span(&host_, 1);
        frame.quality = quality;
        return frame;
    }
    /// Renders and reads, which waits for the picture.
    [[nodiscard]] Image picture(double degrees, const Quality& quality = {}) {
        (void)stage_.renderer().render(frame(degrees, quality));
        return stage_.renderer().read("volume.colour");
    }
    [[nodiscard]] double time_of(double degrees, const Quality& quality) {
        const double start = cpu_ms();
        (void)picture(degrees, quality);
        return cpu_ms() - start;
    }

    Stage stage_;
    LiveVolume volume_;
    HostVolume host_{"host", &volume_};
};

TEST_F(Interactive, FramesFollowTheTargetAndTheStillPictureIsTheFullOne) {
    (void)picture(0.0);  // compiles
    const Image full = picture(60.0);
    const double full_ms = std::min(time_of(10.0, {}), time_of(20.0, {}));
    const double target_ms = 0.2 * full_ms;
    SamplingRateManager manager({.target_ms = target_ms});
    std::vector<double> times;
    FrameObservation seen{.interval_ms = 20.0, .moved = true};
    for (int i = 0; i <= 40; ++i) {
        const Quality quality = manager.next(seen);
        times.push_back(time_of(1.5 * i, quality));
        seen.draw_ms = times.back();
    }
    // From the fifth frame on; the median, for single frames compile shaders or fill new targets.
    std::vector<double> settled(times.begin() + 4, times.end());
    std::ranges::nth_element(settled, settled.begin() + 18);
    EXPECT_GE(settled[18], 0.6 * target_ms) << full_ms;
    EXPECT_LE(settled[18], 1.25 * target_ms) << full_ms;
    EXPECT_NE(stage_.renderer().read("volume.colour").data, full.data);

    // Still: not a frame more than the delay and six steps, and then the very picture.
    Quality quality;
    for (int i = 0; i < 8 + 6; ++i) {
        quality = manager.next({.interval_ms = 20.0});
        (void)picture(60.0, quality);
    }
    EXPECT_TRUE(quality.full());
    EXPECT_EQ(stage_.renderer().read("volume.colour").data, full.data);
    EXPECT_EQ(
        pass_of(stage_.renderer().render(frame(60.0, manager.next({.interval_ms = 20.0}))), "cast").status,
        PassStatus::cached);
    EXPECT_TRUE(stage_.complaints().empty());
}

TEST_F(Interactive, LessQualityIsNeverTakenForFull) {
    const Image full = picture(30.0);
    const Image coarse = picture(30.0, {.step_factor = 3.0});
    EXPECT_EQ(coarse.width, full.width);
    const Difference found = difference(full, coarse);
    EXPECT_GT(found.max, 0.0);
    EXPECT_LT(found.mean, 0.01);
    const Image small = picture(30.0, {.resolution = 0.5});
    EXPECT_EQ(small.width, full.width / 2);
    EXPECT_EQ(small.height, full.height / 2);
    EXPECT_EQ(picture(30.0).data, full.data)
        << "what was drawn less finely is not taken for the full picture";
    EXPECT_TRUE(stage_.complaints().empty());
}

TEST_F(Interactive, LongStepsSkipNothingThatIsSeen) {
    const auto shot = [&](bool skip, double step_factor) {
        stage_.renderer().set_parameter("cast", "/sampling/skip", skip);
        return picture(30.0, {.step_factor = step_factor});
    };
    for (const double step_factor : {1.0, 3.0, 12.0}) {
        EXPECT_EQ(shot(true, step_factor).data, shot(false, step_factor).data) << step_factor;
    }
}

/// A renderer that is told to stop some way into its work.
class Cancelled : public testing::Test {
  protected:
    Cancelled() : context_(create_context(Backend::osmesa, {.debug = true})) {
        register_all(registry_);
        io::write_volume(shell_volume(24, 6.0), folder_ / "shell.nrrd");
        nlohmann::json scene =
            mixed_scene({}, {{"transfer_function", shell_function()}}, camera_at({80, -620, 90}), 48, 40);
        scene["passes"][0]["parameters"]["volume"] = {{"file", "shell.nrrd"}};
        scene_ = parse_scene(scene.dump(), folder_ / "scene.json");
    }
    [[nodiscard]] std::unique_ptr<Renderer> make_renderer(ProgressCallback progress = {}) {
        auto renderer = std::make_unique<Renderer>(context_->proc_address(), registry_,
                                                   RendererOptions{.progress = std::move(progress)});
        renderer->set_scene(scene_);
        return renderer;
    }
    static Image shot(Renderer& renderer) {
        (void)renderer.render(renderer.still(0.0));
        return renderer.read("volume.colour");
    }

    TempFolder folder_;
    std::unique_ptr<Context> context_;
    Registry registry_;
    Scene scene_;
};

TEST_F(Cancelled, WorkTellsWhatItIsAndRisesToItsEnd) {
    std::map<std::string, std::vector<double>, std::less<>> told;
    const auto renderer = make_renderer([&](std::string_view what, double fraction) {
        told[std::string(what)].push_back(fraction);
        return true;
    });
    (void)shot(*renderer);
    ASSERT_EQ(told.size(), 2U);
    EXPECT_EQ(told.begin()->first, "loading shell.nrrd");
    EXPECT_EQ(told.rbegin()->first, "summarising shell.nrrd");
    for (const auto& [what, fractions] : told) {
        EXPECT_TRUE(std::ranges::is_sorted(fractions)) << what;
        EXPECT_EQ(fractions.back(), 1.0) << what;
    }
}

TEST_F(Cancelled, NothingIsHalfLoadedAndTheNextFrameIsComplete) {
    const Image whole = shot(*make_renderer());
    for (const std::string_view work : {"loading", "summarising"}) {
        bool stops = true;
        int asked = 0;
        const auto renderer = make_renderer([&](std::string_view what, double fraction) {
            asked += what.starts_with(work) ? 1 : 0;
            return !(stops && what.starts_with(work) && fraction > 0.0);
        });
        for (int attempt = 0; attempt < 2; ++attempt) {
            asked = 0;
            try {
                (void)shot(*renderer);
                ADD_FAILURE() << work << " went on";
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::usage);
                EXPECT_THAT(error.what(), testing::HasSubstr("cancelled"));
            }
            EXPECT_GE(asked, 1) << "the work begins anew";
        }
        stops = false;
        EXPECT_EQ(shot(*renderer).data, whole.data) << work;
    }
}

}  // namespace
}  // namespace viscera::test
