#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/scene.h"
#include "engine/core/timeline.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;

TimelineTrack track(Interpolation interpolation, double period_s, const std::vector<double>& times_s) {
    TimelineTrack track{.value = "x", .interpolation = interpolation, .period_s = period_s, .keys = {}};
    for (const double time_s : times_s) {
        track.keys.push_back({.time_s = time_s, .values = {time_s}, .mesh = {}});
    }
    return track;
}

TEST(Timeline, ThereIsNothingBeforeTheFirstKeyAndTheLastOneStays) {
    const TimelineTrack keys = track(Interpolation::linear, 0.0, {1.0, 2.0, 4.0});
    EXPECT_EQ(place_at(keys, 0.999), std::nullopt);
    EXPECT_EQ(place_at(keys, 1.0), (TimelinePlace{0, 1, 0.0}));
    EXPECT_EQ(place_at(keys, 3.5), (TimelinePlace{1, 2, 0.75}));
    EXPECT_EQ(place_at(keys, 4.0), (TimelinePlace{2, 2, 0.0}));
    EXPECT_EQ(place_at(keys, 1e9), (TimelinePlace{2, 2, 0.0}));
    EXPECT_EQ(place_at(track(Interpolation::linear, 0.0, {}), 1.0), std::nullopt);
}

TEST(Timeline, HoldKeepsTheKeyBefore) {
    const TimelineTrack keys = track(Interpolation::hold, 0.0, {1.0, 2.0});
    EXPECT_EQ(place_at(keys, 1.999), (TimelinePlace{0, 0, 0.0}));
    EXPECT_EQ(place_at(keys, 2.0), (TimelinePlace{1, 1, 0.0}));
}

TEST(Timeline, APeriodRepeatsInBothDirections) {
    const TimelineTrack keys = track(Interpolation::linear, 2.0, {0.0, 1.0, 2.0});
    for (const double turn : {-4.0, -2.0, 0.0, 2.0, 64.0}) {
        EXPECT_EQ(place_at(keys, turn + 0.25), (TimelinePlace{0, 1, 0.25})) << turn;
        EXPECT_EQ(place_at(keys, turn + 1.5), (TimelinePlace{1, 2, 0.5})) << turn;
    }
}

Scene scene_with(const std::string& timeline) {
    return parse_scene(R"({"version": 1, "outputs": ["x"], "passes": [], "timeline": )" + timeline + "}",
                       "folder/scene.json");
}

TEST(Timeline, IsReadFromScenes) {
    const Scene scene = scene_with(
        R"([{"value": "tissue.contacts", "interpolation": "hold", "period_s": 3,
             "keys": [{"time_s": 1, "values": [1, 2.5]}, {"time_s": 2, "mesh": "a.glb"}, {"time_s": 3}]}])");
    ASSERT_EQ(scene.timeline.size(), 1U);
    const TimelineTrack& track = scene.timeline.front();
    EXPECT_EQ(track.value, "tissue.contacts");
    EXPECT_EQ(track.interpolation, Interpolation::hold);
    EXPECT_EQ(track.period_s, 3.0);
    ASSERT_EQ(track.keys.size(), 3U);
    EXPECT_THAT(track.keys[0].values, testing::ElementsAre(1.0, 2.5));
    EXPECT_EQ(track.keys[1].mesh.path, "folder/a.glb");
    EXPECT_TRUE(track.keys[2].values.empty());
}

TEST(Timeline, FaultsNameTheTrack) {
    const auto fault_of = [](const std::string& timeline) -> std::string {
        try {
            (void)scene_with(timeline);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::scene);
            return error.what();
        }
        return "no fault";
    };
    EXPECT_THAT(fault_of(R"([{"value": "a", "keys": [{"time_s": 1}, {"time_s": 1}]}])"),
                HasSubstr("/timeline/0: key 1 is not later than the one before"));
    EXPECT_THAT(fault_of(R"([{"value": "a", "keys": []}, {"value": "a", "keys": []}])"),
                HasSubstr("/timeline/1: another track is of \"a\""));
    EXPECT_THAT(fault_of(R"([{"value": "", "keys": []}])"), HasSubstr("/timeline/0: no value is named"));
    EXPECT_THAT(fault_of(R"([{"value": "a", "keys": [{"time_s": 0, "values": [1], "mesh": "m.stl"}]}])"),
                HasSubstr("/timeline/0: key 0 has values and a mesh"));
    EXPECT_THAT(fault_of(R"([{"value": "a", "period_s": 2, "keys": [{"time_s": 2.5}]}])"),
                HasSubstr("/timeline/0: key 0 lies outside the period"));
    EXPECT_THAT(fault_of(R"([{"value": "a", "keys": [{"time_s": 0, "vales": [1]}]}])"),
                HasSubstr("did you mean \"values\""));
    EXPECT_THAT(fault_of(R"([{"value": "a"}])"), HasSubstr("/timeline/0/keys: missing"));
}

}  // namespace
}  // namespace viscera::test
