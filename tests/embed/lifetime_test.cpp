#include <functional>
#include <thread>

#include "tests/embed/embed_test.h"
#include "tests/embed/recorder.h"

namespace viscera::test {
namespace {

using Embedded = EmbedTest;
using Alive = std::map<std::string, std::size_t>;

TEST_P(Embedded, ARendererLeavesNoObjectBehind) {
    const HostValues values = world().values();
    Recorder recorder(context().proc());
    {
        Renderer renderer(recorder.proc(), registry(), options());
        renderer.set_scene(world().everything());
        renderer.set_dump({.kind = DumpRequest::Kind::all}, [](CapturedFrame&&) {});
        for (const int width : {96, 60, 96}) {
            Frame frame = renderer.still(World::time_s);
            frame.width = width;
            frame.values = &values;
            renderer.render(frame);
        }
        renderer.reload_shaders(VISCERA_SOURCE_DIR "/glsl");
        const GLuint released = renderer.release_texture("final");
        recorder.forget_texture(released);
        gl().DeleteTextures(1, &released);
        recorder.hold_fences();
        renderer.render(renderer.still(World::time_s));
        EXPECT_TRUE(recorder.alive().contains("Syncs")) << "no read-back is under way when the renderer goes";
        EXPECT_GT(recorder.made(), 60U);
    }
    EXPECT_EQ(recorder.alive(), Alive{});
}

/// Passes that share a vessel and a table draw them at different times.
TEST_P(Embedded, AWarmFrameOfAMovingBolusMakesNoObject) {
    const nlohmann::json table{{{"time_s", 0}, {"density", 0}}, {{"time_s", 1}, {"density", 1}}};
    const std::vector<SceneOverride> changes{{"/resolution", {48, 48}},
                                             {"/shared/coronary/bolus/table", table}};
    Recorder recorder(context().proc());
    Renderer renderer(recorder.proc(), registry(), options());
    renderer.set_scene(load_scene(VISCERA_SOURCE_DIR "/assets/scenes/angiography.json", changes));
    for (const double time_s : {1.5, 1.6}) {
        renderer.render(renderer.still(time_s));
    }
    const std::size_t made = recorder.made();
    renderer.render(renderer.still(1.7));
    EXPECT_EQ(recorder.made(), made);
}

TEST_P(Embedded, ARendererThatFailsLeavesNoObjectBehind) {
    Recorder recorder(context().proc());
    {
        Renderer renderer(recorder.proc(), registry(), options());
        Scene scene = world().everything();
        scene.passes.front().parameters["file"] = "missing.png";
        renderer.set_scene(scene);
        EXPECT_TRUE(error_of([&] { renderer.render(renderer.still(World::time_s)); }));
    }
    EXPECT_EQ(recorder.alive(), Alive{});
    const RendererOptions broken{.shaders = [](std::string_view) { return std::optional<std::string>("?"); }};
    {
        Renderer renderer(recorder.proc(), registry(), broken);
        renderer.set_scene(world().small());
        EXPECT_TRUE(error_of([&] { renderer.render(renderer.still(World::time_s)); }));
    }
    EXPECT_EQ(recorder.alive(), Alive{});
}

TEST_P(Embedded, AfterAnErrorTheHostAndTheNextFrameAreAsIfNothingHadBeen) {
    const auto clean = clean_pictures(world().small(), nullptr);
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    renderer.render(renderer.still(World::time_s));
    poison();
    const auto fails = [&](const char* what, ErrorCode code, const auto& call) {
        expect_untouched(what, [&] {
            const auto error = error_of(call);
            ASSERT_TRUE(error) << what << " is not refused";
            EXPECT_EQ(error->code(), code) << error->what();
        });
    };
    const auto goes_on = [&](const char* what) {
        expect_untouched(what, [&] { renderer.render(renderer.still(World::time_s)); });
        EXPECT_EQ(differing(clean, pictures(renderer)), std::vector<std::string>{}) << what;
    };

    Scene bad = world().small();
    bad.passes.back().effect = "contrast.composit";
    fails("an unknown effect", ErrorCode::scene, [&] { renderer.set_scene(bad); });
    goes_on("after an unknown effect");
    fails("a bad parameter", ErrorCode::scene, [&] { renderer.set_parameter("composite", "/darkest", 7); });
    goes_on("after a bad parameter");

    Scene lost = world().small();
    lost.passes.front().parameters["file"] = "missing.png";
    renderer.set_scene(lost);
    for (int i = 0; i < 2; ++i) {
        fails("a missing file", ErrorCode::file, [&] { renderer.render(renderer.still(World::time_s)); });
    }
    renderer.set_scene(world().small());
    goes_on("after a missing file");

    Frame frame = renderer.still(World::time_s);
    frame.width = 0;
    fails("no pixels", ErrorCode::usage, [&] { renderer.render(frame); });
    frame.width = 1 << 20;
    fails("too many pixels", ErrorCode::limit, [&] { renderer.render(frame); });
    goes_on("after a size that the device refuses");
    fails("an unknown target", ErrorCode::usage, [&] { (void)renderer.read("nothing"); });
    renderer.keep({"nothing"});
    for (int i = 0; i < 2; ++i) {
        fails("an unknown target to keep", ErrorCode::scene,
              [&] { renderer.render(renderer.still(World::time_s)); });
    }
    renderer.keep({});
    goes_on("after an unknown target to keep");
}

TEST_P(Embedded, WithoutAContextNothingIsDrawnAndTheCallerIsTold) {
    Renderer renderer(context().proc(), registry(), options());
    renderer.set_scene(world().small());
    renderer.render(renderer.still(World::time_s));
    const auto clean = pictures(renderer);
    context().release();
    for (const auto& call : {std::function<void()>([&] { renderer.render(renderer.still(World::time_s)); }),
                             std::function<void()>([&] { (void)renderer.read("final"); })}) {
        const auto error = error_of(call);
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::context) << error->what();
    }
    context().make_current();
    renderer.render(renderer.still(World::time_s));
    EXPECT_EQ(differing(clean, pictures(renderer)), std::vector<std::string>{});
}

TEST_P(Embedded, TwoRenderersShareAContext) {
    const HostValues values = world().values();
    const auto clean = clean_pictures(world().everything(), &values);
    const auto clean_small = clean_pictures(world().small(), nullptr);
    Renderer first = make_renderer();
    std::optional<Renderer> second(make_renderer());
    first.set_scene(world().everything());
    second->set_scene(world().small());
    for (int i = 0; i < 2; ++i) {
        Frame frame = first.still(World::time_s);
        frame.values = &values;
        first.render(frame);
        second->render(second->still(World::time_s));
        EXPECT_EQ(differing(clean, pictures(first)), std::vector<std::string>{});
        EXPECT_EQ(differing(clean_small, pictures(*second)), std::vector<std::string>{});
    }
    second.reset();
    Frame frame = first.still(World::time_s);
    frame.values = &values;
    first.set_parameter("composite", "/darkest", 0.5);
    first.render(frame);
    first.set_parameter("composite", "/darkest", 0.08);
    first.render(frame);
    EXPECT_EQ(differing(clean, pictures(first)), std::vector<std::string>{});
}

TEST_P(Embedded, TwoContextsTakeTurns) {
    const auto clean = clean_pictures(world().small(), nullptr);
    const auto clean_later = clean_pictures(world().small(), nullptr, 0.9);
    Renderer here = make_renderer();
    here.set_scene(world().small());
    context().release();
    HostContext other(GetParam());
    {
        Renderer there(other.proc(), registry());
        there.set_scene(world().small());
        for (int i = 0; i < 3; ++i) {
            there.render(there.still(0.9));
            EXPECT_EQ(differing(clean_later, pictures(there)), std::vector<std::string>{});
            other.release();
            context().make_current();
            here.render(here.still(World::time_s));
            EXPECT_EQ(differing(clean, pictures(here)), std::vector<std::string>{});
            context().release();
            other.make_current();
        }
    }
    other.release();
    context().make_current();
}

TEST_P(Embedded, TwoThreadsRenderAtOnce) {
    const HostValues values = world().values();
    const auto clean = clean_pictures(world().everything(), &values);
    std::array<std::map<std::string, Image>, 2> read;
    const auto work = [&](std::map<std::string, Image>& result) {
        const HostContext own(GetParam());
        const Registry effects = all_effects();
        Renderer renderer(own.proc(), effects);
        renderer.set_scene(world().everything());
        for (const double time_s : {0.3, 0.9, World::time_s}) {
            Frame frame = renderer.still(time_s);
            frame.values = &values;
            renderer.render(frame);
        }
        result = pictures(renderer);
    };
    {
        const std::jthread first([&] { work(read[0]); });
        const std::jthread second([&] { work(read[1]); });
    }
    EXPECT_EQ(differing(clean, read[0]), std::vector<std::string>{});
    EXPECT_EQ(differing(clean, read[1]), std::vector<std::string>{});
}

TEST_P(Embedded, HostValuesComeThrough) {
    Renderer renderer = make_renderer();
    renderer.set_scene(world().everything());
    Frame frame = renderer.still(World::time_s);
    const auto centre = [&] { return renderer.read("host.main").at(48, 40, 0); };
    renderer.render(frame);
    EXPECT_EQ(centre(), 0.0F) << "no density is given yet";
    const auto without_smoke = renderer.read("contrast.reflux");
    HostValues values = world().values(0.25F);
    frame.values = &values;
    renderer.render(frame);
    const float thin = centre();
    EXPECT_GT(thin, 0.0F);
    EXPECT_NE(renderer.read("contrast.reflux").data, without_smoke.data) << "the host's emitter";
    values = world().values(1.0F);
    // A new object of the same size whose versions start anew must not pass for the old one.
    renderer.render(frame);
    EXPECT_GT(centre(), thin);
    values.erase("host_density");
    renderer.render(frame);
    EXPECT_EQ(centre(), 0.0F);
}

INSTANTIATE_TEST_SUITE_P(Hosts, Embedded, each_host(), kind_name);

}  // namespace
}  // namespace viscera::test
