#include "engine/context/window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "engine/context/shared_library.h"
#include "tests/context/environment.h"
#include "tests/context/offscreen.h"
#include "tests/context/xvfb.h"
#include "tests/core/error_of.h"

namespace viscera {
namespace {

using test::clear_and_read;
using test::Rgba8;

class Window : public testing::Test {
  protected:
    void SetUp() override {
        const std::string& display = test::Xvfb::of_process().display();
        if (display.empty()) {
            GTEST_SKIP() << "no window tests: Xvfb is not there (Debian package xvfb)";
        }
        display_.emplace("DISPLAY", display);
        options_.width = 320;
        options_.height = 200;
        options_.visible = false;
    }
    ContextOptions options_;

  private:
    std::optional<test::ScopedVariable> display_;
};

TEST_F(Window, ClearsAndReadsBack) {
    const auto window = create_context(Backend::glfw, options_);
    EXPECT_EQ(window->info().backend, Backend::glfw);
    const auto gl = gl::Functions::load(window->proc_address());
    EXPECT_EQ(clear_and_read(*gl, {0.2F, 0.4F, 0.6F, 0.8F}), (Rgba8{51, 102, 153, 204}));
    EXPECT_EQ(gl->GetError(), GLenum{GL_NO_ERROR});
}

TEST_F(Window, RunsALoop) {
    options_.visible = true;
    const auto window = create_window(options_);
    const auto gl = gl::Functions::load(window->proc_address());
    EXPECT_EQ(window->framebuffer_size().width, 320);
    EXPECT_EQ(window->framebuffer_size().height, 200);
    int frames = 0;
    while (!window->should_close()) {
        gl->ClearColor(0.0F, 0.0F, 1.0F, 1.0F);
        gl->Clear(GL_COLOR_BUFFER_BIT);
        window->swap();
        window->poll();
        if (++frames == 3) {
            window->close();
        }
    }
    EXPECT_EQ(frames, 3);
    EXPECT_EQ(gl->GetError(), GLenum{GL_NO_ERROR});
}

TEST_F(Window, TellsWhatItsUserDoes) {
    const auto window = create_window(options_);
    std::vector<std::string> said;
    window->events.key = [&](int key, bool pressed, Modifiers modifiers) {
        said.push_back("key " + std::to_string(key) + (pressed ? " down" : " up") +
                       (modifiers.shift ? " shift" : ""));
    };
    window->events.cursor = [&](double x, double y) {
        said.push_back("cursor " + std::to_string(static_cast<int>(x)) + " " +
                       std::to_string(static_cast<int>(y)));
    };
    window->events.button = [&](MouseButton button, bool pressed, Modifiers modifiers) {
        said.push_back(std::string("button ") + (button == MouseButton::right ? "right" : "other") +
                       (pressed ? " down" : " up") + (modifiers.control ? " control" : ""));
    };
    window->events.scroll = [&](double, double y) {
        said.push_back("scroll " + std::to_string(static_cast<int>(y)));
    };

    // GLFW hands the installed callbacks back when they are replaced: so they can be called as it would.
    const auto glfw = SharedLibrary::open("glfw", {"libglfw.so.3"}, "");
    auto* const handle = static_cast<GLFWwindow*>(window->native_window());
    const auto key = glfw.find<decltype(&glfwSetKeyCallback)>("glfwSetKeyCallback")(handle, nullptr);
    const auto cursor =
        glfw.find<decltype(&glfwSetCursorPosCallback)>("glfwSetCursorPosCallback")(handle, nullptr);
    const auto button =
        glfw.find<decltype(&glfwSetMouseButtonCallback)>("glfwSetMouseButtonCallback")(handle, nullptr);
    const auto scroll = glfw.find<decltype(&glfwSetScrollCallback)>("glfwSetScrollCallback")(handle, nullptr);
    key(handle, GLFW_KEY_ESCAPE, 0, GLFW_PRESS, GLFW_MOD_SHIFT);
    key(handle, 'R', 0, GLFW_RELEASE, 0);
    key(handle, GLFW_KEY_UNKNOWN, 0, GLFW_PRESS, 0);
    cursor(handle, 10.0, 50.0);
    button(handle, GLFW_MOUSE_BUTTON_RIGHT, GLFW_PRESS, GLFW_MOD_CONTROL);
    button(handle, GLFW_MOUSE_BUTTON_5, GLFW_PRESS, 0);
    scroll(handle, 0.0, -2.0);
    EXPECT_THAT(said, testing::ElementsAre("key 256 down shift", "key 82 up", "cursor 10 150",
                                           "button right down control", "scroll -2"));
    static_assert(key::escape == GLFW_KEY_ESCAPE && key::enter == GLFW_KEY_ENTER &&
                  key::tab == GLFW_KEY_TAB && key::right == GLFW_KEY_RIGHT && key::left == GLFW_KEY_LEFT &&
                  key::down == GLFW_KEY_DOWN && key::up == GLFW_KEY_UP && key::keypad_0 == GLFW_KEY_KP_0);
}

TEST_F(Window, WhatAListenerThrowsComesOutOfPollAndNotThroughGlfw) {
    const auto window = create_window(options_);
    window->events.scroll = [](double, double y) { throw std::runtime_error(std::to_string(y)); };
    const auto glfw = SharedLibrary::open("glfw", {"libglfw.so.3"}, "");
    auto* const handle = static_cast<GLFWwindow*>(window->native_window());
    const auto scroll = glfw.find<decltype(&glfwSetScrollCallback)>("glfwSetScrollCallback")(handle, nullptr);
    EXPECT_NO_THROW(scroll(handle, 0.0, 1.0));
    EXPECT_NO_THROW(scroll(handle, 0.0, 2.0));
    EXPECT_THROW(
        {
            try {
                window->poll();
            } catch (const std::runtime_error& error) {
                EXPECT_EQ(std::string_view(error.what()).substr(0, 1), "1") << "the first one";
                throw;
            }
        },
        std::runtime_error);
    EXPECT_NO_THROW(window->poll());
}

TEST_F(Window, AlternatesWithEglAndOsmesa) {
    const auto window = create_context(Backend::glfw, options_);
    const auto window_gl = gl::Functions::load(window->proc_address());
    test::mark(*window_gl, 0.125F);
    for (const Backend backend : {Backend::egl_surfaceless, Backend::osmesa}) {
        const auto other = create_context(backend);
        const auto other_gl = gl::Functions::load(other->proc_address());
        test::mark(*other_gl, 0.5F);
        for (int round = 0; round < 3; ++round) {
            window->make_current();
            ASSERT_EQ(test::read_mark(*window_gl), 0.125F) << to_string(backend) << " round " << round;
            other->make_current();
            ASSERT_EQ(test::read_mark(*other_gl), 0.5F) << to_string(backend) << " round " << round;
        }
    }
    window->make_current();
    EXPECT_EQ(test::read_mark(*window_gl), 0.125F);
}

TEST_F(Window, OpensWhileAnotherContextIsCurrentAndClosesWithoutIt) {
    const auto egl = create_context(Backend::egl_surfaceless);
    const auto gl = gl::Functions::load(egl->proc_address());
    test::mark(*gl, 0.5F);
    auto window = create_window(options_);
    egl->make_current();
    window.reset();
    EXPECT_EQ(test::read_mark(*gl), 0.5F);
}

TEST_F(Window, IsWrappedAsTheCallers) {
    const auto window = create_context(Backend::glfw, options_);
    const auto gl = gl::Functions::load(window->proc_address());
    test::mark(*gl, 0.125F);
    const auto wrapped = wrap_current_context(window->proc_address());
    const auto other = create_context(Backend::osmesa);
    wrapped->make_current();
    EXPECT_EQ(test::read_mark(*gl), 0.125F);
}

}  // namespace
}  // namespace viscera
