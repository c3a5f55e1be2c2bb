#include <filesystem>
#include <initializer_list>
#include <stdexcept>

#include "tests/io/temp_folder.h"
#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;

class Failure : public RuntimeTest {
  protected:
    Failure() {
        add("kept", {.ports = {write_port()}, .prepare = prepare_cached, .draw = draw_fill});
        add("add", {.ports = {write_port(), read_port()}, .draw = draw_add("in")});
        add("wrong_gl", {.ports = {write_port()}, .draw = [this](const Pass& pass, double value) {
                             if (fails_) {
                                 pass.gl().Enable(0xBEEF);
                             }
                             draw_fill(pass, value);
                         }});
        add("forgets", {.ports = {write_port()}, .draw = [this](const Pass& pass, double value) {
                            if (!fails_) {
                                draw_fill(pass, value);
                                return;
                            }
                            (void)pass.use(RecipeProgram::fill);
                            pass.draw_fullscreen();
                        }});
        add("throws", {.ports = {write_port(), read_port()},
                       .prepare =
                           [this](Prepare&, double) {
                               if (fails_ && in_prepare_) {
                                   throw std::runtime_error("prepare failed");
                               }
                               return Work::all(0);
                           },
                       .draw =
                           [this](const Pass& pass, double value) {
                               if (fails_) {
                                   throw std::runtime_error("draw failed");
                               }
                               draw_add("in")(pass, value);
                           }});
    }

    /// A frame fails with an error of OpenGL that names the pass and says all of `said`; the next one is
    /// drawn.
    void expect_error_of_second_pass(const char* effect, std::initializer_list<const char*> said) {
        renderer().set_scene(make_scene({{"kept", 1.0}, {effect, 4.0}}, {"x"}));
        fails_ = true;
        const auto error = error_of([&] { render(0); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::gl);
        EXPECT_THAT(error->what(), HasSubstr("pass 'p1'"));
        for (const char* text : said) {
            EXPECT_THAT(error->what(), HasSubstr(text));
        }
        fails_ = false;
        render(1);
        EXPECT_EQ(value_of("x"), 4.0F);
    }

    bool fails_ = false;
    bool in_prepare_ = false;
};

TEST_P(Failure, AnOpenGlErrorNamesItsPassAndTheRendererGoesOn) {
    expects_messages_ = true;
    expect_error_of_second_pass("wrong_gl", {"invalid enum"});
}

TEST_P(Failure, AUniformThatIsNotSetNamesItsPassAndProgram) {
    // Another pass of the same program has set it: this one would draw with a value that is not its own.
    expect_error_of_second_pass("forgets", {"test/fill.frag", "'u_value'"});
}

TEST_P(Failure, ExceptionsOfEffectsLeaveTheRendererUsable) {
    renderer().set_scene(make_scene({{"kept", 1.0}, {"throws", 4.0}}, {"x"}));
    render(0);
    for (const bool in_prepare : {true, false}) {
        in_prepare_ = in_prepare;
        fails_ = true;
        EXPECT_THROW(render(1), std::runtime_error);
        EXPECT_TRUE(error_of([&] { (void)renderer().read("x"); })) << "a failed frame holds nothing";
        fails_ = false;
        render(2);
        EXPECT_EQ(value_of("x"), 5.0F);
    }
}

TEST_P(Failure, TheHostsStateIsPutBackAfterAnException) {
    renderer().set_scene(make_scene({{"kept", 1.0}, {"throws", 4.0}}, {"x"}));
    gl().Viewport(3, 5, 17, 19);
    gl().Enable(GL_BLEND);
    fails_ = true;
    EXPECT_THROW(render(0), std::runtime_error);
    std::array<GLint, 4> viewport{};
    gl().GetIntegerv(GL_VIEWPORT, viewport.data());
    EXPECT_THAT(viewport, testing::ElementsAre(3, 5, 17, 19));
    EXPECT_EQ(gl().IsEnabled(GL_BLEND), GL_TRUE);
}

TEST_P(Failure, AFailedFrameIsAsIfItHadNotBeenToTheNext) {
    add("feedback",
        {.ports = {write_port(), previous_port()}, .draw = [this](const Pass& pass, double value) {
             if (fails_) {
                 throw std::runtime_error("draw failed");
             }
             draw_add("last")(pass, value);
         }});
    renderer().set_scene(make_scene({{"feedback", 1.0}}, {"x"}));
    render(0);
    render(1);
    fails_ = true;
    EXPECT_THROW(render(2), std::runtime_error);
    fails_ = false;
    render(3);
    EXPECT_EQ(value_of("x"), 3.0F) << "what the frames before left stays";
    render(4);
    EXPECT_EQ(value_of("x"), 4.0F);
}

TEST_P(Failure, ABrokenShaderNamesFileAndLine) {
    expects_messages_ = true;
    shaders_["test/fill.frag"] = "#version 330 core\nout vec4 o;\nvoid main() { o = nonsense; }\n";
    renderer().set_scene(make_scene({{"kept", 1.0}}, {"x"}));
    const auto error = error_of([&] { render(0); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::gl);
    EXPECT_THAT(error->what(), HasSubstr("test/fill.frag:3"));
}

TEST_P(Failure, ASceneThatIsRefusedLeavesTheOneBefore) {
    renderer().set_scene(make_scene({{"kept", 3.0}}, {"x"}));
    render(0);
    for (const Scene& wrong :
         {make_scene({{"unknown", 1.0}}, {"x"}), make_scene({{"add", 1.0}}, {"x"}),
          make_scene({{"kept", 1.0}}, {"nothing"}), make_scene({{"kept", 1.0, {{"port", "x"}}}}, {"x"})}) {
        const auto error = error_of([&] { renderer().set_scene(wrong); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::scene);
        EXPECT_THAT(error->what(), HasSubstr("test.json"));
        render(1);
        EXPECT_EQ(value_of("x"), 3.0F);
    }
    EXPECT_TRUE(error_of([&] { renderer().set_parameter("p0", "/unknown", 1); }));
    EXPECT_TRUE(error_of([&] { renderer().set_parameter("p0", "no pointer", 1); }));
    EXPECT_TRUE(error_of([&] { renderer().set_parameter("p0", "/value/deeper", 1); }));
    EXPECT_TRUE(error_of([&] { renderer().set_parameter("nobody", "/value", 1); }));
    render(2);
    EXPECT_EQ(value_of("x"), 3.0F);
}

TEST_P(Failure, ARendererWithoutASceneSaysSo) {
    const auto error = error_of([&] { renderer().render({.width = 8, .height = 8}); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
}

TEST_P(Failure, FramesWithoutPixelsAndFramesTooLargeAreRefused) {
    renderer().set_scene(make_scene({{"kept", 3.0}}, {"x"}));
    for (const auto& [width, height, code] :
         {std::tuple(0, 4, ErrorCode::usage), std::tuple(4, -1, ErrorCode::usage),
          std::tuple(1 << 20, 4, ErrorCode::limit), std::tuple(4, 1 << 30, ErrorCode::limit)}) {
        const auto error = error_of([&] { renderer().render({.width = width, .height = height}); });
        ASSERT_TRUE(error) << width << " x " << height;
        EXPECT_EQ(error->code(), code) << error->what();
        render(0);
        EXPECT_EQ(value_of("x"), 3.0F);
    }
}

/// What is presented must be an output.
TEST_P(Failure, PresentingWhatIsNoOutputIsRefused) {
    renderer().set_scene(make_scene({{"kept", 3.0}}, {"x"}));
    Frame frame = renderer().frame(0);
    frame.present = {.enabled = true, .output = "other"};
    const auto error = error_of([&] { renderer().render(frame); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
    EXPECT_EQ(error->where(), "other");
}

TEST_P(Failure, ReloadingTakesNewShadersAndKeepsTheLastGoodOnes) {
    expects_messages_ = true;
    std::vector<std::string> errors;
    renderer().set_scene(make_scene({{"kept", 3.0}}, {"x"}));
    render(0);
    const TempFolder folder;
    const auto write = [&](const std::string& expression) {
        std::filesystem::create_directories(folder / "test");
        std::filesystem::create_directories(folder / "common");
        (void)folder.write("common/fullscreen.vert", *embedded_shader("common/fullscreen.vert"));
        (void)folder.write("test/fill.frag",
                           "#version 330 core\nuniform float u_value;\nout vec4 o_value;\nvoid main() {\n"
                           "o_value = vec4(" +
                               expression + ");\n}\n");
    };
    write("u_value + 100.0");
    EXPECT_EQ(renderer().reload_shaders(folder.path()), 0);
    render(1);
    EXPECT_EQ(value_of("x"), 103.0F) << "what was drawn with the old shader is no longer kept";
    write("u_value + nonsense");
    EXPECT_EQ(renderer().reload_shaders(folder.path()), 1);
    render(2);
    EXPECT_EQ(value_of("x"), 103.0F);
    std::filesystem::remove_all(folder / "test");
    EXPECT_EQ(renderer().reload_shaders(folder.path()), 1);
    render(3);
    EXPECT_EQ(value_of("x"), 103.0F);
    write("u_value + 200.0");
    EXPECT_EQ(renderer().reload_shaders(folder.path()), 0);
    render(4);
    EXPECT_EQ(value_of("x"), 203.0F);
}

TEST_P(Failure, TimesAreReportedForWhatRanAndSoftwareClaimsNoGpuTime) {
    renderer().set_scene(make_scene({{"kept", 3.0}, {"add", 1.0, {{"out", "y"}}}}, {"y"}));
    for (std::uint64_t i = 0; i < 12; ++i) {
        const FrameReport& report = render(i);
        double sum = 0.0;
        for (const PassReport& pass : report.passes) {
            EXPECT_GE(pass.cpu_ms, 0.0);
            sum += pass.cpu_ms;
            if (context_info().software) {
                EXPECT_FALSE(pass.gpu_ms);
            }
        }
        EXPECT_LE(sum, report.cpu_ms);
        EXPECT_GT(report.passes[1].cpu_ms, 0.0);
    }
}

TEST_P(Failure, LongPassNamesDoNoHarm) {
    Scene scene = make_scene({{"kept", 3.0}}, {"x"});
    scene.passes[0].name = std::string(5000, 'n');
    renderer().set_scene(scene);
    render(0);
    EXPECT_EQ(value_of("x"), 3.0F);
}

INSTANTIATE_TEST_SUITE_P(Backends, Failure, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test
