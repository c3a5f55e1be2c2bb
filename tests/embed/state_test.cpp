#include <set>

#include "tests/embed/embed_test.h"

namespace viscera::test {
namespace {

using EmbeddedState = EmbedTest;

TEST_P(EmbeddedState, EveryRowIsAsItWasAfterEveryCall) {
    const HostValues values = world().values();
    const auto clean = clean_pictures(world().everything(), &values);
    poison();

    std::optional<Renderer> renderer;
    expect_untouched("constructor", [&] { renderer.emplace(make_renderer()); });
    expect_untouched("set_scene", [&] { renderer->set_scene(world().everything()); });

    std::set<std::string> drawn;
    const auto render = [&](const char* what, const Frame& frame) {
        expect_untouched(what, [&] {
            for (const PassReport& pass : renderer->render(frame).passes) {
                if (pass.status == PassStatus::run || pass.status == PassStatus::reduced) {
                    drawn.insert(pass.effect);
                }
            }
        });
    };
    Frame frame = renderer->still(World::time_s);
    frame.values = &values;
    render("cold frame", frame);
    std::map<std::string, Image> read;
    expect_untouched("read", [&] { read = pictures(*renderer); });
    EXPECT_EQ(differing(clean, read), std::vector<std::string>{}) << "the host's state changes the picture";
    render("cached frame", frame);
    Frame later = renderer->still(World::time_s + 0.1);
    later.values = &values;
    render("warm frame", later);  // by now a jet is in the air
    for (const Registry::Entry& entry : registry().entries()) {
        EXPECT_TRUE(drawn.contains(entry.name)) << entry.name << " is drawn by no test of embedding";
    }
    Frame wide = frame;
    wide.width = 140;
    wide.height = 70;
    render("resized frame", wide);
    render("frame of the first size", frame);
    expect_untouched("read", [&] { read = pictures(*renderer); });
    EXPECT_EQ(differing(clean, read), std::vector<std::string>{});

    std::size_t captured = 0;
    renderer->set_dump({.kind = DumpRequest::Kind::all},
                       [&](CapturedFrame&& frame_read) { captured += frame_read.targets.size(); });
    render("captured frame", frame);
    render("captured frame", later);
    expect_untouched("poll_captures", [&] { renderer->poll_captures(); });
    expect_untouched("finish_captures", [&] { renderer->finish_captures(); });
    EXPECT_GT(captured, 20U);
    renderer->set_dump({}, {});

    expect_untouched("set_parameter", [&] { renderer->set_parameter("composite", "/darkest", 0.3); });
    render("frame after set_parameter", frame);
    expect_untouched("reload_shaders",
                     [&] { EXPECT_EQ(renderer->reload_shaders(VISCERA_SOURCE_DIR "/glsl"), 0); });
    render("frame after reload_shaders", frame);
    expect_untouched("set_parameter", [&] { renderer->set_parameter("composite", "/darkest", 0.08); });
    render("frame with the old parameter", frame);
    expect_untouched("read", [&] { read = pictures(*renderer); });
    EXPECT_EQ(differing(clean, read), std::vector<std::string>{});

    GLuint released = 0;
    expect_untouched("release_texture", [&] { released = renderer->release_texture("final"); });
    EXPECT_NE(released, 0U);
    gl().DeleteTextures(1, &released);
    expect_untouched("destructor", [&] { renderer.reset(); });
    std::vector<std::string> said = complaints();
    // The world's bakes are small.
    std::erase_if(
        said, [](const std::string& text) { return text.find("gutters are narrower") != std::string::npos; });
    EXPECT_EQ(said, std::vector<std::string>{});
}

TEST_P(EmbeddedState, APoisonedHostThatResetsItselfGetsTheSamePicture) {
    const HostValues values = world().values();
    const auto clean = clean_pictures(world().everything(), &values);
    Renderer renderer = make_renderer();
    renderer.set_scene(world().everything());
    poison();
    Frame frame = renderer.still(World::time_s);
    frame.values = &values;
    frame.host_state = HostStatePolicy::host_resets;
    // The one thing that viscera cannot do without harm: the host's query stays its own.
    renderer.render(frame);
    EXPECT_EQ(differing(clean, pictures(renderer)), std::vector<std::string>{});
}

TEST_P(EmbeddedState, AnErrorOfTheHostsIsReportedAndNotThrown) {
    Renderer renderer = make_renderer();
    gl().Enable(0xFFFF);
    renderer.set_scene(world().small());
    EXPECT_EQ(renderer.log().faults().at("gl.host_error"), 1U);
    gl().Enable(0xFFFF);
    renderer.render(renderer.still(World::time_s));
    EXPECT_EQ(renderer.log().faults().at("gl.host_error"), 2U);
    ASSERT_FALSE(complaints().empty());
    EXPECT_NE(complaints().front().find("the host left an OpenGL error"), std::string::npos);
    gl().Enable(0xFFFF);
    Frame frame = renderer.still(World::time_s + 0.1);
    frame.host_state = HostStatePolicy::host_resets;
    EXPECT_NO_THROW(renderer.render(frame));
    gl().Enable(0xFFFF);
    EXPECT_NO_THROW((void)make_renderer());
}

TEST_P(EmbeddedState, AWrappedContextIsTheHostsOwn) {
    const auto wrapped = wrap_current_context(context().proc());
    EXPECT_EQ(wrapped->info().backend, Backend::current);
    expect_untouched("a renderer in a wrapped context", [&] {
        Renderer renderer(wrapped->proc_address(), registry(), options());
        renderer.set_scene(world().small());
        renderer.render(renderer.still(World::time_s));
    });
}

INSTANTIATE_TEST_SUITE_P(Hosts, EmbeddedState, each_host(), kind_name);

}  // namespace
}  // namespace viscera::test
