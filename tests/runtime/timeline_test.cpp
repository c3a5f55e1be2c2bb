#include <filesystem>
#include <fstream>

#include "tests/io/temp_folder.h"
#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

/// Shows the first number of the host value "x", or -1 where there is none.
class TimelineFrames : public RuntimeTest {
  protected:
    TimelineFrames() {
        add("shows", {.ports = {write_port()}, .draw = [](const Pass& pass, double) {
                          const HostValues* values = pass.frame().values;
                          const HostValues::Entry* entry = values != nullptr ? values->find("x") : nullptr;
                          draw_fill(pass, entry != nullptr ? entry->values.front() : -1.0);
                      }});
        add("feedback", {.ports = {write_port(), previous_port()}, .draw = draw_add("last")});
    }
    float shown_at(double time_s) {
        renderer().render(renderer().still(time_s));
        return value_of("x");
    }
};

TEST_P(TimelineFrames, StandsInForAHost) {
    Scene scene = make_scene({{"shows"}}, {"x"});
    scene.timeline = {{.value = "x",
                       .interpolation = Interpolation::linear,
                       .period_s = 0.0,
                       .keys = {{1.0, {10.0}, {}}, {2.0, {20.0}, {}}, {3.0, {5.0, 6.0}, {}}, {4.0, {}, {}}}}};
    renderer().set_scene(scene);
    EXPECT_EQ(shown_at(0.5), -1.0F);
    EXPECT_EQ(shown_at(1.0), 10.0F);
    EXPECT_EQ(shown_at(1.25), 12.5F);
    EXPECT_EQ(shown_at(2.5), 20.0F);  // one number does not run into two
    EXPECT_EQ(shown_at(3.0), 5.0F);
    EXPECT_EQ(shown_at(4.0), -1.0F);
    EXPECT_EQ(shown_at(1.5), 15.0F);  // back in time
}

TEST_P(TimelineFrames, AHostsValuesWin) {
    Scene scene = make_scene({{"shows"}}, {"x"});
    scene.timeline = {
        {.value = "x", .interpolation = Interpolation::linear, .period_s = 0.0, .keys = {{0.0, {10.0}, {}}}}};
    renderer().set_scene(scene);
    HostValues values;
    Frame frame = renderer().still(1.0);
    frame.values = &values;
    renderer().render(frame);
    EXPECT_EQ(value_of("x"), -1.0F);
    values.set("x", std::vector<float>{3.0F});
    renderer().render(frame);
    EXPECT_EQ(value_of("x"), 3.0F);
}

TEST_P(TimelineFrames, VerticesOfMeshesRunIntoEachOther) {
    const TempFolder folder;
    const auto write = [&](const char* name, const char* first) {
        const std::filesystem::path file = folder / name;
        std::ofstream(file) << "v " << first << " 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
        return AssetPath{file};
    };
    Scene scene = make_scene({{"shows"}}, {"x"});
    scene.timeline = {{.value = "x",
                       .interpolation = Interpolation::linear,
                       .period_s = 0.0,
                       .keys = {{0.0, {}, write("timeline_a.obj", "1")},
                                {1.0, {}, write("timeline_b.obj", "3"), {4.0, 0.0, 0.0}}}}};
    renderer().set_scene(scene);
    EXPECT_EQ(shown_at(0.0), 1.0F);
    EXPECT_EQ(shown_at(0.25), 2.5F);
    EXPECT_EQ(shown_at(7.0), 7.0F);
}

TEST_P(TimelineFrames, SaysWhetherFramesBuildOnEachOther) {
    renderer().set_scene(make_scene({{"shows"}}, {"x"}));
    EXPECT_FALSE(renderer().keeps_state());
    renderer().set_scene(make_scene({{"feedback"}}, {"x"}));
    EXPECT_TRUE(renderer().keeps_state());
}

TEST_P(TimelineFrames, OnlyFramesThatAskForItAreReadBack) {
    renderer().set_scene(make_scene({{"feedback", 1.0}}, {"x"}));
    std::vector<std::uint64_t> captured;
    renderer().set_dump({DumpRequest::Kind::outputs, {}},
                        [&](CapturedFrame&& frame) { captured.push_back(frame.report.index); });
    for (std::uint64_t i = 0; i < 4; ++i) {
        Frame frame = renderer().frame(i);
        frame.capture = i >= 2;
        renderer().render(frame);
    }
    renderer().finish_captures();
    EXPECT_THAT(captured, testing::ElementsAre(2, 3));
    EXPECT_EQ(value_of("x"), 4.0F);  // frames that were not read back count all the same
}

INSTANTIATE_TEST_SUITE_P(Backends, TimelineFrames, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test
