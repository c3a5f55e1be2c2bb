#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

class Captures : public RuntimeTest {
  protected:
    Captures() {
        // Every frame another value, so that a mixed-up frame shows.
        add("time", {.ports = {write_port()}, .draw = [](const Pass& pass, double) {
                         draw_fill(pass, static_cast<double>(pass.frame().index));
                     }});
        add("add", {.ports = {write_port(), read_port()}, .draw = draw_add("in")});
        add("idle", {.ports = {write_port("out", "empty", 9.0F)},
                     .prepare = [](Prepare&, double) { return Work::idle("nothing"); },
                     .draw = draw_fill});
    }
    CaptureSink sink() {
        return [this](CapturedFrame&& frame) { frames_.push_back(std::move(frame)); };
    }
    static void expect_filled(const CapturedTarget& target, float value, int width, int height) {
        ASSERT_EQ(target.image.width, width) << target.name;
        ASSERT_EQ(target.image.height, height) << target.name;
        for (const float got : to_floats(target.image)) {
            ASSERT_EQ(got, value) << target.name;
        }
    }
    static std::vector<std::string> names_of(const CapturedFrame& frame) {
        std::vector<std::string> names;
        for (const CapturedTarget& target : frame.targets) {
            names.push_back(target.name);
        }
        return names;
    }

    std::vector<CapturedFrame> frames_;
};

/// A chain in which textures take turns: without a dump, a and c would share one.
Scene chain() {
    return make_scene({{"time", 0.0, {{"out", "a"}}},
                       {"add", 1000.0, {{"in", "a"}, {"out", "b"}}},
                       {"add", 1000.0, {{"in", "b"}, {"out", "c"}}},
                       {"add", 1000.0, {{"in", "c"}, {"out", "d"}}}},
                      {"d"});
}

TEST_P(Captures, FramesComeWholeAndInOrderWhileTheSizeChanges) {
    constexpr std::uint64_t count = 40;
    renderer().set_scene(chain());
    renderer().set_dump({DumpRequest::Kind::all, {}}, sink());
    std::vector<std::pair<int, int>> sizes;
    for (std::uint64_t i = 0; i < count; ++i) {
        Frame frame = renderer().frame(i);
        frame.width = 3 + static_cast<int>((i / 4) % 5) * 7;
        frame.height = 2 + static_cast<int>((i / 6) % 3) * 5;
        sizes.emplace_back(frame.width, frame.height);
        renderer().render(frame);
    }
    renderer().finish_captures();
    ASSERT_EQ(frames_.size(), count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const CapturedFrame& frame = frames_[i];
        EXPECT_EQ(frame.report.index, i);
        ASSERT_THAT(names_of(frame), testing::ElementsAre("a", "b", "c", "d"));
        for (std::size_t t = 0; t < 4; ++t) {
            expect_filled(frame.targets[t], static_cast<float>(i + 1000 * t), sizes[i].first,
                          sizes[i].second);
        }
    }
}

TEST_P(Captures, OutputsAndNamesAreWhatIsAskedFor) {
    renderer().set_scene(chain());
    renderer().set_dump({DumpRequest::Kind::outputs, {}}, sink());
    render(1);
    renderer().finish_captures();
    renderer().set_dump({DumpRequest::Kind::names, {"b", "a"}}, sink());
    render(2);
    renderer().finish_captures();
    renderer().set_dump({DumpRequest::Kind::none, {}}, sink());
    render(3);
    renderer().finish_captures();
    ASSERT_EQ(frames_.size(), 2U);
    EXPECT_THAT(names_of(frames_[0]), testing::ElementsAre("d"));
    EXPECT_THAT(names_of(frames_[1]), testing::ElementsAre("b", "a"));
    expect_filled(frames_[1].targets[0], 1002.0F, 8, 4);
    expect_filled(frames_[1].targets[1], 2.0F, 8, 4);
}

TEST_P(Captures, ADumpKeepsAPassAliveThatNothingElseNeeds) {
    renderer().set_scene(make_scene({{"time"}, {"add", 50.0, {{"out", "side"}}}}, {"x"}));
    renderer().set_dump({DumpRequest::Kind::names, {"side"}}, sink());
    EXPECT_EQ(status(render(3), 1), PassStatus::run);
    renderer().finish_captures();
    ASSERT_EQ(frames_.size(), 1U);
    expect_filled(frames_[0].targets[0], 53.0F, 8, 4);
}

TEST_P(Captures, EmptyTargetsComeAsTheirClearValue) {
    renderer().set_scene(make_scene({{"time"}, {"idle"}}, {"x", "empty"}));
    renderer().set_dump({DumpRequest::Kind::outputs, {}}, sink());
    for (std::uint64_t i = 0; i < 6; ++i) {
        render(i);
    }
    renderer().finish_captures();
    ASSERT_EQ(frames_.size(), 6U);
    for (std::uint64_t i = 0; i < 6; ++i) {
        expect_filled(frames_[i].targets.at(0), static_cast<float>(i), 8, 4);
        expect_filled(frames_[i].targets.at(1), 9.0F, 8, 4);
    }
}

TEST_P(Captures, AnUnknownNameIsRefusedAndTheRendererGoesOn) {
    renderer().set_scene(chain());
    renderer().set_dump({DumpRequest::Kind::names, {"nonsense"}}, sink());
    const auto error = error_of([&] { render(0); });
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), testing::HasSubstr("nonsense"));
    renderer().set_dump({DumpRequest::Kind::outputs, {}}, sink());
    render(1);
    renderer().finish_captures();
    ASSERT_EQ(frames_.size(), 1U);
    expect_filled(frames_[0].targets[0], 3001.0F, 8, 4);
}

TEST_P(Captures, ASizeThatIsRefusedDoesNotStopTheDump) {
    renderer().set_scene(chain());
    renderer().set_dump({DumpRequest::Kind::all, {}}, sink());
    render(0);
    Frame huge = renderer().frame(1);
    huge.width = 1 << 20;
    EXPECT_TRUE(error_of([&] { renderer().render(huge); }));
    render(2);
    renderer().finish_captures();
    ASSERT_EQ(frames_.size(), 2U);
    EXPECT_EQ(frames_[1].report.index, 2U);
    EXPECT_THAT(names_of(frames_[1]), testing::ElementsAre("a", "b", "c", "d"));
}

TEST_P(Captures, AnErrorOfTheSinkReachesTheCallerAndLaterFramesArrive) {
    renderer().set_scene(chain());
    int calls = 0;
    renderer().set_dump({DumpRequest::Kind::outputs, {}}, [&](CapturedFrame&& frame) {
        if (++calls == 1) {
            throw Error(ErrorCode::file, "sink", "full");
        }
        frames_.push_back(std::move(frame));
    });
    const auto error = error_of([&] {
        for (std::uint64_t i = 0; i < 10; ++i) {
            render(i);
        }
        renderer().finish_captures();
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::file);
    render(20);
    renderer().finish_captures();
    ASSERT_FALSE(frames_.empty());
    EXPECT_EQ(frames_.back().report.index, 20U);
}

TEST_P(Captures, ReadingBetweenDumpsGivesTheLastFrame) {
    renderer().set_scene(chain());
    renderer().set_dump({DumpRequest::Kind::outputs, {}}, sink());
    for (std::uint64_t i = 0; i < 4; ++i) {
        render(i);
        EXPECT_EQ(value_of("d"), static_cast<float>(3000 + i));
    }
    const auto error = error_of([&] { (void)renderer().read("a"); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
}

INSTANTIATE_TEST_SUITE_P(Backends, Captures, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test
