#include <cmath>
#include <limits>

#include "tests/stress/volume_scene.h"

// Mixed resolution, foveation and two eyes under odd sizes, values and views.
namespace viscera::test {
namespace {

using nlohmann::json;

class VolumeResolution : public VolumeStress {
  protected:
    /// A scene of one cast with a coarse pass of `coarse` before it, of which `size` is the target's rule.
    static json mixed(json scene_of_one, const json& size, const json& fine) {
        json coarse = scene_of_one["passes"].back();
        coarse["name"] = "coarse";
        coarse["parameters"]["mixed"] = {{"pass", "coarse"}};
        json how = fine;
        how["pass"] = "fine";
        scene_of_one["passes"].back()["parameters"]["mixed"] = how;
        scene_of_one["passes"].insert(scene_of_one["passes"].end() - 1, coarse);
        scene_of_one["targets"]["volume.coarse"] = size;
        return scene_of_one;
    }
    [[nodiscard]] Image shot(const json& made, const LiveVolume& volume) {
        give("host", &volume);
        load(made);
        return picture();
    }
};

TEST_F(VolumeResolution, AnySizeOfEitherPicture) {
    const LiveVolume ball(ball_volume(12));
    json one = scene(ramp(), front());
    for (const json& resolution : {json{1, 1}, json{2, 2}, json{3, 3}, json{4, 4}, json{5, 7}, json{1, 64},
                                   json{64, 1}, json{67, 53}}) {
        one["resolution"] = resolution;
        const Image full = shot(one, ball);
        for (const json& size :
             {json{{"scale", 0.5}}, json{{"scale", 0.05}}, json{{"scale", 1.0}}, json{{"scale", 3.0}},
              json{{"size", {4, 4}}}, json{{"size", {1, 30}}}, json{{"size", {16384, 1}}}}) {
            // All cast: bitwise the full picture. All filled in: finite, as picture() finds, and no brighter.
            expect_same(shot(mixed(one, size, {{"tolerance", 0.0}}), ball), full,
                        resolution.dump() + size.dump());
            const Image filled =
                shot(mixed(one, size, {{"tolerance", 1e30}, {"depth_tolerance_mm", 1e30}}), ball);
            EXPECT_LE(largest(filled), 1.5F) << resolution << size;
        }
    }
}

TEST_F(VolumeResolution, ThePictureIsDrawnLargerOrSmallerThanTheFrame) {
    const LiveVolume ball(ball_volume(12));
    json one = scene(ramp(), front());
    one["resolution"] = {48, 40};
    for (const double scale : {0.1, 0.5, 0.9, 1.7, 4.0}) {
        one["targets"]["volume.colour"] = {{"format", "rgba32f"}, {"scale", scale}};
        const Image full = shot(one, ball);
        expect_same(shot(mixed(one, {{"scale", 0.5}}, {{"tolerance", 0.0}}), ball), full,
                    std::to_string(scale));
        const Image got = shot(mixed(one, {{"scale", 0.5}}, json::object()), ball);
        EXPECT_EQ(got.width, full.width);
    }
}

TEST_F(VolumeResolution, VolumesOfOneVoxelNothingAndNoNumber) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const LiveVolume one_voxel(constant_volume(glm::ivec3(1), glm::dvec3(8.0), 100.0));
    const LiveVolume nothing(constant_volume(glm::ivec3(4), glm::dvec3(2.0), 0.0));
    const LiveVolume no_number(constant_volume(glm::ivec3(4), glm::dvec3(2.0), nan));
    json one = scene(ramp(), front());
    one["resolution"] = {40, 32};
    for (const LiveVolume* volume : {&one_voxel, &nothing, &no_number}) {
        const Image full = shot(one, *volume);
        expect_same(shot(mixed(one, {{"scale", 0.5}}, {{"tolerance", 0.0}}), *volume), full, "all cast");
        const Image got = shot(mixed(one, {{"scale", 0.5}}, json::object()), *volume);
        EXPECT_EQ(is_empty(got), is_empty(full));
    }
}

TEST_F(VolumeResolution, FoveasBeyondThePictureAndLongerThanTheVolume) {
    const LiveVolume ball(ball_volume(12));
    for (const json& centre : {json{0.5, 0.5}, json{-10, 10}, json{10, 0.5}}) {
        for (const double factor : {1.0, 3.0, 64.0}) {
            for (const double outer : {1e-6, 0.5, 20.0}) {
                json p = ramp();
                p["sampling"]["fovea"] = {
                    {"centre", centre}, {"radius", 0.0}, {"outer_radius", outer}, {"step_factor", factor}};
                const Image got = cast(ball, p);
                EXPECT_FALSE(is_empty(got));
                EXPECT_LE(largest(got), 1.5F);
            }
        }
    }
}

TEST_F(VolumeResolution, TwoEyesThatAreOneAndEyesThatLookPast) {
    const LiveVolume ball(ball_volume(12));
    give("host", &ball);
    json one = scene(ramp(), front());
    one["resolution"] = {40, 32};
    load(mixed(one, {{"scale", 0.5}}, json::object()));
    const Image alone = picture();
    Frame frame = volume_frame();
    frame.eyes[1] = frame.eyes[0];
    frame.eye_count = 2;
    Pictures both = render(frame);
    expect_same(both.at("volume.colour.left"), alone, "left");
    expect_same(both.at("volume.colour.right"), alone, "right");
    // One eye sees nothing of the volume, and then sees it again.
    frame.eyes[1].view[3][0] += 1e4;
    both = render(frame);
    expect_same(both.at("volume.colour.left"), alone, "left");
    EXPECT_TRUE(is_empty(both.at("volume.colour.right")));
    frame.eyes[1] = frame.eyes[0];
    both = render(frame);
    expect_same(both.at("volume.colour.right"), alone, "right again");
    // And a frame of one eye after frames of two.
    expect_same(picture(), alone, "one eye again");
}

}  // namespace
}  // namespace viscera::test
