#include <cstring>

#include "tests/stress/volume_scene.h"

// Volumes that hosts change, take away and give back.
namespace viscera::test {
namespace {

using nlohmann::json;
using LiveVolumes = VolumeStress;

std::vector<std::byte> numbers(std::size_t count, float value) {
    std::vector<std::byte> bytes(count * sizeof(float));
    for (std::size_t i = 0; i < count; ++i) {
        std::memcpy(bytes.data() + i * sizeof value, &value, sizeof value);
    }
    return bytes;
}

/// A picture of the same voxels in a volume that has never changed.
Volume copy_of(const LiveVolume& volume) {
    return volume.volume();
}

TEST_F(LiveVolumes, UpdatesOfNothingOfAllAndManyAFrame) {
    LiveVolume live(ball_volume(8));
    const Image before = cast(live, ramp());
    const std::uint64_t version = live.version();
    live.update({{0, 0, 0}, {0, 8, 8}}, {});
    live.update({{8, 8, 8}, {0, 0, 0}}, {});
    EXPECT_EQ(live.version(), version);
    expect_same(picture(), before, "nothing was changed");
    for (int frame = 0; frame < 3; ++frame) {
        // More than the volume remembers, so that everything is taken anew, and fewer.
        for (int i = 0; i < (frame == 1 ? 100 : 20); ++i) {
            live.update({{i % 8, (i / 8) % 8, frame}, {1, 1, 2}},
                        numbers(2, 10.0F * static_cast<float>(i % 11)));
        }
        const Image changed = picture();
        expect_same(changed, cast(LiveVolume(copy_of(live)), ramp()), "as if it had always been so");
        give("host", &live);
    }
    live.update({{0, 0, 0}, {8, 8, 8}}, numbers(512, 100.0F));
    expect_same(picture(), cast(LiveVolume(copy_of(live)), ramp()), "all of it");
    for (const VoxelBox& wrong : {VoxelBox{{-1, 0, 0}, {1, 1, 1}}, VoxelBox{{7, 0, 0}, {2, 1, 1}},
                                  VoxelBox{{0, 0, 0}, {1, 1, 2147483647}}, VoxelBox{{0, 0, 0}, {-1, 1, 1}}}) {
        EXPECT_THROW(live.update(wrong, numbers(1, 0.0F)), Error);
    }
    EXPECT_TRUE(renderer().log().faults().empty()) << said();
}

TEST_F(LiveVolumes, AnotherVolumeInItsPlace) {
    LiveVolume live(ball_volume(8));
    (void)cast(live, ramp());
    json seen = ramp();
    seen["sampling"]["scheme"] = "cell";
    for (const char* scheme : {"gauss", "cell"}) {
        json parameters = ramp();
        parameters["sampling"]["scheme"] = scheme;
        give("host", &live);
        load(scene(parameters, front()));
        (void)picture();
        for (Volume next :
             {make_volume({3, 5, 2}, {2, 1, 3}, [](const glm::ivec3& i) { return 20.0 * i.x + 10.0 * i.z; }),
              constant_volume({4, 4, 4}, {1, 2, 1}, 80, ScalarType::u8), ball_volume(12)}) {
            next.grid.origin_mm += glm::dvec3(0.5, 0.0, -0.25);
            live.replace(next);
            give("host", &live);
            const Image changed = picture();
            const LiveVolume fresh(next);
            give("host", &fresh);
            Frame frame = volume_frame();
            const Image wanted = cast(fresh, parameters);
            expect_same(changed, wanted, std::string(scheme) + ": grid and type are the new ones");
            give("host", &live);
            load(scene(parameters, front()));
            (void)picture();
        }
    }
    EXPECT_THROW(live.replace({}), Error);
}

TEST_F(LiveVolumes, GoneForAFrameAndBack) {
    auto live = std::make_unique<LiveVolume>(ball_volume(8));
    const Image whole = cast(*live, ramp());
    give("host", nullptr);
    EXPECT_TRUE(is_empty(picture()));
    give("host", live.get());
    expect_same(picture(), whole, "back again");
    // Another object, perhaps in the same place of memory.
    for (int i = 0; i < 4; ++i) {
        live.reset();
        give("host", nullptr);
        EXPECT_TRUE(is_empty(picture()));
        live = std::make_unique<LiveVolume>(i % 2 == 0 ? constant_volume(glm::ivec3(8), glm::dvec3(1.25), 0.0)
                                                       : ball_volume(8));
        give("host", live.get());
        const Image next = picture();
        if (i % 2 == 0) {
            EXPECT_TRUE(is_empty(next));
        } else {
            expect_same(next, whole, "the ball once more");
        }
    }
    const HostVolume null{"host", nullptr};
    Frame frame = renderer().still(0.0);
    frame.volumes = std::span(&null, 1);
    EXPECT_TRUE(is_empty(picture(frame)));
}

TEST_F(LiveVolumes, BrokenVoxelsThatComeAndGo) {
    LiveVolume live(ball_volume(8));
    const Image whole = cast(live, ramp());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::byte> was(live.volume().voxels.begin(), live.volume().voxels.end());
    live.update({{2, 2, 2}, {4, 4, 4}}, numbers(64, nan));
    EXPECT_LT(largest(picture()), largest(whole));
    live.update({{0, 0, 0}, {8, 8, 8}}, was);
    expect_same(picture(), whole, "mended");
    expect_said_once("volume.non_finite", "NaN, infinite or beyond");
}

/// What is no number shows as the least value, also where that value changes elsewhere.
TEST_F(LiveVolumes, BrokenVoxelsFollowTheLeastValue) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const char* filter : {"linear", "bspline_fp32"}) {
        Volume volume = make_volume(glm::ivec3(8), glm::dvec3(1.25), [](const glm::ivec3& i) {
            return i == glm::ivec3(7) ? 10.0 : 80.0 + i.x;
        });
        LiveVolume live(std::move(volume));
        live.update({{0, 0, 0}, {4, 8, 8}}, numbers(256, nan));
        json parameters = ramp();
        parameters["sampling"]["filter"] = filter;
        parameters["shading"]["enabled"] = true;
        const Image before = cast(live, parameters);
        for (const float least : {70.0F, 5.0F}) {
            live.update({{7, 7, 7}, {1, 1, 1}}, numbers(1, least));
            const Image changed = picture();
            EXPECT_GT(difference(changed, before), 0.01) << filter;
            expect_same(changed, cast(LiveVolume(copy_of(live)), parameters), "as if it had always been so");
            (void)cast(live, parameters);
        }
    }
}

/// Shares are of the range that all voxels have now, not of one that they once had.
TEST_F(LiveVolumes, ColoursAreSharesOfTheRangeAsItIs) {
    Volume volume = constant_volume(glm::ivec3(6), glm::dvec3(1.5), 100.0, ScalarType::u8);
    volume.channels = 3;
    volume.voxels.resize(volume.voxels.size() * 3, std::byte{40});
    LiveVolume live(std::move(volume));
    const json parameters{{"function", "accumulate"},
                          {"accumulate", {{"channels", {json::object(), json::object(), json::object()}}}}};
    const Image before = cast(live, parameters);
    const auto paint = [&](const VoxelBox& box, int value) {
        const auto count = static_cast<std::size_t>(3 * box.size.x * box.size.y * box.size.z);
        live.update(box, std::vector<std::byte>(count, static_cast<std::byte>(value)));
        const Image changed = picture();
        expect_same(changed, cast(LiveVolume(copy_of(live)), parameters), "as if it had always been so");
        (void)cast(live, parameters);
        return changed;
    };
    const VoxelBox corner{{0, 0, 0}, {2, 1, 1}};
    EXPECT_GT(difference(paint(corner, 250), before), 0.01);  // all others are darker now
    (void)paint({{3, 3, 3}, {1, 1, 1}}, 250);                 // the greatest value twice
    (void)paint(corner, 100);                                 // and once
    (void)paint({{3, 3, 3}, {1, 1, 1}}, 100);                 // and nowhere
    (void)paint(corner, 0);
    (void)paint(corner, 90);
}

TEST_F(LiveVolumes, AHundredFramesHoldNoMore) {
    LiveVolume live(ball_volume(8));
    (void)cast(live, ramp());
    std::size_t held = 0;
    for (int i = 0; i < 100; ++i) {
        renderer().set_parameter("cast", "/transfer_function/points/1/opacity", 0.2 + 0.005 * i);
        live.update({{i % 8, 0, 0}, {1, 8, 8}}, numbers(64, static_cast<float>(i)));
        Frame frame = volume_frame();
        CameraParams camera = renderer().scene().camera;
        camera.eye_mm.x += 0.1 * i;
        frame.eyes[0] = make_view(camera, frame.aspect(), 0.0);
        renderer().render(frame);
        held = i == 50 ? renderer().asset_count() : held;
    }
    EXPECT_LE(renderer().asset_count(), held);
    // Without a changed parameter nothing tells that a version will not come back; what is held must stay
    // few.
    const std::size_t before = renderer().asset_count();
    for (int i = 0; i < 100; ++i) {
        live.update({{i % 8, 0, 0}, {1, 8, 8}}, numbers(64, static_cast<float>(i)));
        renderer().render(volume_frame());
    }
    EXPECT_LE(renderer().asset_count(), before + 4) << "each version of a volume leaves something behind";
}

}  // namespace
}  // namespace viscera::test
