#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "effects/register_all.h"
#include "engine/context/context.h"
#include "engine/runtime/renderer.h"
#include "tests/core/allocation_counter.h"

namespace viscera::test {
namespace {

/// The default scene, small, in a renderer as an app has it.
class WarmFrameTest : public testing::TestWithParam<HostStatePolicy> {
  protected:
    WarmFrameTest() : context_(create_context(Backend::osmesa)) {
        register_all(registry_);
        renderer_.emplace(context_->proc_address(), registry_);
        const auto scenes = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes";
        const std::vector<SceneOverride> small{{"/resolution", {256, 256}}};
        renderer_->set_scene(load_scene(scenes / "angiography.json", small));
    }

    [[nodiscard]] Renderer& renderer() { return *renderer_; }
    void set_scene(std::string_view text) { renderer_->set_scene(parse_scene(text, "test.json")); }
    /// Allocations of one frame.
    std::size_t allocations(double time_s, std::span<const HostVolume> volumes = {}) {
        Frame frame = renderer_->still(time_s);
        frame.volumes = volumes;
        frame.host_state = GetParam();
        const std::size_t before = allocation_count();
        report_ = &renderer_->render(frame);
        return allocation_count() - before;
    }
    [[nodiscard]] std::size_t drawn() const {
        return static_cast<std::size_t>(std::ranges::count_if(report_->passes, [](const PassReport& pass) {
            return pass.status == PassStatus::run || pass.status == PassStatus::reduced;
        }));
    }
    /// Three frames to get warm, and three that draw so many passes and allocate nothing.
    void expect_none_once_warm(double time_s, std::size_t passes, std::span<const HostVolume> volumes = {}) {
        for (int i = 0; i < 3; ++i) {
            (void)allocations(time_s += 0.01, volumes);
        }
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(allocations(time_s += 0.01, volumes), 0U) << "at " << time_s << " s";
            EXPECT_EQ(drawn(), passes);
        }
    }

  private:
    std::unique_ptr<Context> context_;
    Registry registry_;
    std::optional<Renderer> renderer_;
    const FrameReport* report_ = nullptr;
};

TEST_P(WarmFrameTest, TheMovingBolusAllocatesNothing) {
    double time_s = 1.5;
    for (int i = 0; i < 3; ++i) {
        (void)allocations(time_s += 0.01);
    }
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(allocations(time_s += 0.01), 0U) << "at " << time_s << " s";
        EXPECT_GE(drawn(), 7U) << "the frame was to be a full one";
    }
}

TEST_P(WarmFrameTest, ACachedFrameAllocatesNothing) {
    (void)allocations(1.5);
    (void)allocations(1.5);
    EXPECT_EQ(allocations(1.5), 0U);
    EXPECT_EQ(drawn(), 0U);
}

/// Bytes about the world's origin that differ from voxel to voxel.
Volume bytes_of_noise(int n, double spacing_mm) {
    Volume volume;
    volume.grid.dims = glm::ivec3(n);
    volume.grid.spacing_mm = glm::dvec3(spacing_mm);
    volume.grid.origin_mm = glm::dvec3(-0.5 * spacing_mm * (n - 1));
    for (int i = 0; i < n * n * n; ++i) {
        volume.voxels.push_back(static_cast<std::byte>(i * 37 % 251 / (1 + i % 7)));
    }
    return volume;
}

TEST_P(WarmFrameTest, AMovedVolumeWithEverythingInItAllocatesNothing) {
    const LiveVolume head(bytes_of_noise(24, 4.0));
    const LiveVolume labels(bytes_of_noise(12, 8.0));
    const std::array<HostVolume, 2> given{HostVolume{"head", &head},
                                          HostVolume{"another volume that gives labels", &labels}};
    set_scene(R"({"version": 1, "resolution": [64, 64], "outputs": ["volume.colour"],
        "camera": {"eye_mm": [0, -300, 60], "orbit_deg_per_s": 20},
        "passes": [{"name": "cast", "effect": "volume.ray_cast", "parameters": {
            "volume": {"host": "head"},
            "transfer_function": {"points": [{"value": 40, "opacity": 0}, {"value": 200, "opacity": 0.1}]},
            "shading": {"enabled": true, "light_volume": {"ambient_occlusion": 0.5}},
            "labels": {"host": "another volume that gives labels",
                       "segments": [{"id": 3, "points": [{"value": 9, "opacity": 0.2}]}]},
            "overlay": {"host": "another volume that gives labels"},
            "clip_planes": [{"normal": [1, 2, 0.5]}, {"normal": [0, 1, 0], "point_mm": [0, -20, 0]}]}}]})");
    expect_none_once_warm(1.5, 1U, given);
}

TEST_P(WarmFrameTest, MovedColoursInSegmentsAllocateNothing) {
    Volume colours = bytes_of_noise(24, 4.0);
    const std::vector<std::byte> grey = colours.voxels;
    colours.voxels.insert(colours.voxels.end(), grey.begin(), grey.end());
    colours.channels = 2;
    const LiveVolume head(std::move(colours));
    const LiveVolume labels(bytes_of_noise(12, 8.0));
    const std::array<HostVolume, 2> given{HostVolume{"head", &head}, HostVolume{"labels", &labels}};
    set_scene(R"({"version": 1, "resolution": [64, 64], "outputs": ["volume.colour"],
        "camera": {"eye_mm": [0, -300, 60], "orbit_deg_per_s": 20},
        "passes": [{"name": "cast", "effect": "volume.ray_cast", "parameters": {
            "volume": {"host": "head", "storage": "atlas"}, "function": "accumulate",
            "accumulate": {"channels": [{"threshold": [0.1, 1]}, {}]},
            "shading": {"enabled": true, "light_volume": {"ambient_occlusion": 0.5}},
            "labels": {"host": "labels", "segments": [{"id": 3, "opacity_factor": 0.5}]},
            "overlay": {"host": "labels"}}}]})");
    expect_none_once_warm(1.5, 1U, given);
}

TEST_P(WarmFrameTest, AMovedOrganBehindAMembraneAllocatesNothing) {
    const auto scenes = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes";
    const nlohmann::json membrane = {
        {"name", "membrane"},
        {"effect", "organ.surface"},
        {"parameters",
         {{"mesh", {{"file", "../meshes/organ.glb"}, {"placement", {{"scale", {1.02, 1.02, 1.02}}}}}},
          {"hematoma", {{"spots", {{{"centre", {-40, -30, -25}}, {"radius", 20}}}}}},
          {"blending", "blended"},
          {"opacity", 0.2},
          {"into_picture", true}}}};
    const std::vector<SceneOverride> changes{{"/resolution", {64, 48}},
                                             {"/camera/orbit_deg_per_s", 20},
                                             {"/passes/2", membrane},
                                             {"/outputs", {"organ.color"}}};
    renderer().set_scene(load_scene(scenes / "organ.json", changes));
    expect_none_once_warm(0.0, 3U);
}

TEST_P(WarmFrameTest, AnOrganThatBleedsWhileAHookMovesAllocatesNothing) {
    const auto scenes = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes";
    const std::vector<SceneOverride> small{{"/resolution", {64, 48}}};
    renderer().set_scene(load_scene(scenes / "laparoscopy.json", small));
    double time_s = 5.5;
    for (int i = 0; i < 30; ++i) {
        (void)allocations(time_s += 0.02);
    }
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(allocations(time_s += 0.02), 0U) << "at " << time_s << " s";
        EXPECT_GE(drawn(), 5U) << "energy, blood, the organ, the hook and the lens";
    }
}

TEST_P(WarmFrameTest, TwoEyesInMixedResolutionAllocateNothing) {
    const LiveVolume head(bytes_of_noise(24, 4.0));
    const std::array<HostVolume, 1> given{HostVolume{"head", &head}};
    set_scene(R"({"version": 1, "resolution": [64, 64], "outputs": ["volume.colour"],
        "camera": {"eye_mm": [0, -300, 60], "orbit_deg_per_s": 20, "stereo": {"layout": "side_by_side"}},
        "shared": {"head": {"volume": {"host": "head"}, "sampling": {"fovea": {}},
            "transfer_function": {"points": [{"value": 40, "opacity": 0}, {"value": 200, "opacity": 0.1}]}}},
        "passes": [
            {"name": "coarse", "effect": "volume.ray_cast",
             "parameters": {"$ref": "#/shared/head", "mixed": {"pass": "coarse"}}},
            {"name": "fine", "effect": "volume.ray_cast",
             "parameters": {"$ref": "#/shared/head", "mixed": {"pass": "fine"}}}]})");
    expect_none_once_warm(1.5, 5U, given);
}

INSTANTIATE_TEST_SUITE_P(HostState, WarmFrameTest,
                         testing::Values(HostStatePolicy::restore, HostStatePolicy::host_resets),
                         [](const auto& info) {
                             return info.param == HostStatePolicy::restore ? "Restored" : "HostResets";
                         });

}  // namespace
}  // namespace viscera::test
