// A host with a window of its own, and viscera in the right half of it.
//   host_glfw SCENE.json [FRAMES OUT.png]     with FRAMES: draws so many, writes the last and ends
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "engine/io/png.h"
#include "samples/host_common/embedded_scene.h"
#include "samples/host_common/host_gl.h"

namespace {

void* proc_address(const char* name) {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
}

/// GLFW and one window, whose context is current.
class Window {
  public:
    Window(int width, int height) {
        if (glfwInit() != GLFW_TRUE) {
            throw std::runtime_error("GLFW finds no display");
        }
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        window_ = glfwCreateWindow(width, height, "a host of viscera", nullptr, nullptr);
        if (window_ == nullptr) {
            glfwTerminate();
            throw std::runtime_error("GLFW gives no window with OpenGL 3.3 core");
        }
        glfwMakeContextCurrent(window_);
    }
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    ~Window() { glfwTerminate(); }
    [[nodiscard]] GLFWwindow* get() const { return window_; }

  private:
    GLFWwindow* window_ = nullptr;
};

void run(const char* scene, int frames, const char* file) {
    const Window window(1024, 512);
    const host::Triangle triangle(proc_address);
    host::EmbeddedScene embedded(proc_address, scene);
    for (int frame = 0; glfwWindowShouldClose(window.get()) == GLFW_FALSE; ++frame) {
        int width = 0;
        int height = 0;
        glfwGetFramebufferSize(window.get(), &width, &height);
        // Framebuffer 0 is this host's window: it says so, viscera would never assume it.
        constexpr unsigned framebuffer = 0;
        triangle.draw(framebuffer, width, height);
        if (width > 1 && height > 0) {
            const double time_s = frames > 0 ? 1.5 : glfwGetTime();
            embedded.draw(time_s, framebuffer, {width / 2, 0, width / 2, height});
        }
        if (frames > 0 && frame + 1 == frames) {
            viscera::io::write_png(file, triangle.read(framebuffer, width, height));
            return;
        }
        glfwSwapBuffers(window.get());
        glfwPollEvents();
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2 && count != 4) {
        std::cerr << "usage: host_glfw SCENE.json [FRAMES OUT.png]\n";
        return 2;
    }
    try {
        run(arguments[1], count == 4 ? std::atoi(arguments[2]) : 0, count == 4 ? arguments[3] : "");
        return 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
