#include <gtest/gtest.h>

#include "engine/gl/functions.h"
#include "engine/gl/texture.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/sector_stage.h"

namespace viscera::test {
namespace {

/// Fragment and compute path side by side, on a software renderer that has both.
class ComputePath : public testing::Test {
  protected:
    void SetUp() override {
        const ContextInfo& info = fragment_.renderer().context_info();
        if (info.major * 10 + info.minor < 43) {
            GTEST_SKIP() << "this context has no compute shaders";
        }
    }

    /// The pictures are the same, and each was made the way it should be.
    void expect_same(const nlohmann::json& scene, double limit = 1e-6, std::size_t seen = 500) {
        FrameReport by_fragment;
        FrameReport by_compute;
        const Image wanted = mixed_shot(fragment_, scene, volume_, "volume.colour", &by_fragment);
        const Image got = mixed_shot(compute_, scene, volume_, "volume.colour", &by_compute);
        EXPECT_EQ(pass_of(by_fragment, "cast").path, DrawPath::fragment);
        EXPECT_EQ(pass_of(by_compute, "cast").path, DrawPath::compute);
        const Difference d = difference(wanted, got);
        EXPECT_LE(d.max, limit) << d.above << " pixels differ";
        EXPECT_GT(d.seen, seen);
        EXPECT_EQ(compute_.complaints(), std::vector<std::string>{});
    }

    LiveVolume volume_{shell_volume()};
    Stage fragment_{Backend::osmesa, {}, ComputeUse::off};
    Stage compute_{Backend::osmesa, {}, ComputeUse::on};
};

nlohmann::json parameters() {
    return {{"transfer_function", shell_function()}};
}

TEST_F(ComputePath, EveryRayFunctionGivesTheSamePicture) {
    for (const char* function : {"composite", "mip", "average", "xray"}) {
        SCOPED_TRACE(function);
        nlohmann::json p = parameters();
        p["function"] = function;
        expect_same(mixed_scene(nlohmann::json::array(), p, camera_at({250, -380, 120})));
    }
}

TEST_F(ComputePath, WithAndWithoutSkipping) {
    for (const bool skip : {false, true}) {
        SCOPED_TRACE(skip);
        nlohmann::json p = parameters();
        p["sampling"] = {{"skip", skip}};
        expect_same(mixed_scene(nlohmann::json::array(), p, camera_at({250, -380, 120})));
    }
}

TEST_F(ComputePath, CylindersAndSpheres) {
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        volume_.replace(sector_vessels(named.shape, {12, 18, 10}));
        const glm::dvec3 centre = sector_centre(volume_.volume().grid);
        nlohmann::json camera = camera_at(centre + glm::dvec3(120.0, -180.0, 90.0));
        camera["target_mm"] = {centre.x, centre.y, centre.z};
        expect_same(mixed_scene(nlohmann::json::array(), parameters(), camera), 1e-6, 50);
    }
}

/// The volume is its own labels and overlay, too.
TEST_F(ComputePath, SegmentsAndOverlaysAsTexturesAndSlices) {
    nlohmann::json p = parameters();
    const nlohmann::json own{{{"value", 0}, {"opacity", 0.0}}, {{"value", 200}, {"opacity", 0.05}}};
    p["labels"] = {
        {"host", "host"},
        {"segments",
         {{{"id", 150}, {"opacity_factor", 3}}, {{"id", 199}, {"colour", {0, 1, 0}}, {"points", own}}}}};
    p["overlay"] = {{"host", "host"}, {"strength", 0.5}};
    p["sampling"] = {{"scheme", "preintegrated"}};
    for (const char* storage : {"texture_3d", "atlas"}) {
        SCOPED_TRACE(storage);
        p["volume"]["storage"] = storage;
        expect_same(mixed_scene(nlohmann::json::array(), p, camera_at({250, -380, 120})));
    }
}

TEST_F(ComputePath, Colours) {
    Volume colours = shell_volume(16, 12.0);
    std::vector<std::byte> rgb;
    for (const std::byte value : colours.voxels) {
        const auto n = std::to_integer<unsigned>(value);
        rgb.insert(rgb.end(), {value, static_cast<std::byte>(n / 2), static_cast<std::byte>(200 - n / 3)});
    }
    colours.voxels = std::move(rgb);
    colours.channels = 3;
    volume_.replace(std::move(colours));
    const nlohmann::json p{
        {"function", "accumulate"},
        {"accumulate",
         {{"channels", {{{"threshold", {0.1, 1}}}, nlohmann::json::object(), nlohmann::json::object()}}}},
        {"shading", {{"enabled", true}}},
        {"sampling", {{"filter", "catmull_rom"}}}};
    expect_same(mixed_scene(nlohmann::json::array(), p, camera_at({250, -380, 120})));
}

TEST_F(ComputePath, EveryFormatOfTheTarget) {
    for (const char* format : {"rgba32f", "rgba16f", "rgba8"}) {
        SCOPED_TRACE(format);
        nlohmann::json scene =
            mixed_scene(nlohmann::json::array(), parameters(), camera_at({250, -380, 120}));
        scene["targets"]["volume.colour"]["format"] = format;
        // Software renderers truncate to half when they draw; one step of a number below 1 is 2^-11.
        expect_same(scene, format == std::string("rgba16f") ? 0.00048828125 : 1e-6);
    }
}

TEST_F(ComputePath, RegionsOfAnySizeAndPlace) {
    for (const auto& [width, height] : {std::pair{97, 61}, std::pair{64, 64}, std::pair{203, 31}}) {
        SCOPED_TRACE(width);
        // Far away and aside: the volume covers a part whose corners are no multiples of a group.
        nlohmann::json camera = camera_at({500, -560, 220});
        camera["target_mm"] = {60, -20, 30};
        expect_same(mixed_scene(nlohmann::json::array(), parameters(), camera, width, height), 1e-6, 50);
    }
}

TEST_F(ComputePath, WhatLiesBesideTheRegionIsCleared) {
    // A picture all over, then one in a part: what the first left must be gone.
    const nlohmann::json near = mixed_scene(nlohmann::json::array(), parameters(), camera_at({40, -90, 20}));
    (void)mixed_shot(compute_, near, volume_);
    compute_.make_current();
    const HostVolume given{"host", &volume_};
    Frame frame = compute_.renderer().still(0.0);
    frame.volumes = std::span(&given, 1);
    CameraParams far;
    far.eye_mm = {500, -560, 220};
    frame.eyes[0] = make_view(far, frame.aspect());
    compute_.renderer().render(frame);
    const Image moved = compute_.renderer().read("volume.colour");
    fragment_.make_current();
    fragment_.load(near);
    fragment_.renderer().render(frame);
    EXPECT_LE(difference(fragment_.renderer().read("volume.colour"), moved).max, 1e-6);
}

TEST_F(ComputePath, SoftwareRenderersDoNotChooseIt) {
    Stage automatic;
    FrameReport report;
    const auto scene = mixed_scene(nlohmann::json::array(), parameters(), camera_at({250, -380, 120}));
    (void)mixed_shot(automatic, scene, volume_, "volume.colour", &report);
    EXPECT_EQ(pass_of(report, "cast").path, DrawPath::fragment);
}

TEST_F(ComputePath, AHostsTextureIsDrawnInto) {
    // What it is made of is only known to be drawable.
    compute_.make_current();
    nlohmann::json scene = mixed_scene(nlohmann::json::array(), parameters(), camera_at({250, -380, 120}));
    const std::unique_ptr<const gl::Functions> gl = gl::Functions::load(compute_.context().proc_address());
    const gl::Texture texture = gl::Texture::make_2d(*gl, 96, 80, PixelFormat::rgba32f, "host");
    const ImportedTarget target{"volume.colour", PixelFormat::rgba32f, 96, 80, true};
    const ImportedTexture import{"volume.colour", texture.id(), PixelFormat::rgba32f, 96, 80, true};
    const auto file = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes" / "test.json";
    scene["targets"] = nlohmann::json::object();
    compute_.renderer().set_scene(parse_scene(scene.dump(), file), std::span(&target, 1));
    const HostVolume given{"host", &volume_};
    Frame frame = compute_.renderer().still(0.0);
    frame.volumes = std::span(&given, 1);
    frame.imported = std::span(&import, 1);
    EXPECT_EQ(pass_of(compute_.renderer().render(frame), "cast").path, DrawPath::fragment);
}

TEST(ComputeReport, SaysHowAPassWasDrawn) {
    EXPECT_EQ(to_string(DrawPath::fragment), "fragment");
    EXPECT_EQ(to_string(DrawPath::compute), "compute");
    FrameReport report;
    report.passes = {{.name = "a", .path = DrawPath::compute}, {.name = "b"}};
    const nlohmann::json json = to_json(report);
    EXPECT_EQ(json["passes"][0]["path"], "compute");
    EXPECT_TRUE(json["passes"][1]["path"].is_null());
}

}  // namespace
}  // namespace viscera::test
