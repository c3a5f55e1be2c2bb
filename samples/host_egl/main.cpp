// A host without a window: its own EGL context, framebuffer and drawing, and viscera in the right half of it.
//   host_egl SCENE.json OUT.png
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <exception>
#include <iostream>
#include <stdexcept>

#include "engine/io/png.h"
#include "samples/host_common/embedded_scene.h"
#include "samples/host_common/host_gl.h"

namespace {

/// An OpenGL 3.3 context that stays current while it lives.
class EglContext {
  public:
    EglContext() : display_(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)) {
        constexpr std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                                   3,
                                                   EGL_CONTEXT_MINOR_VERSION,
                                                   3,
                                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                   EGL_NONE};
        if (eglInitialize(display_, nullptr, nullptr) != EGL_TRUE || eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
            throw std::runtime_error("EGL has no surfaceless display with OpenGL");
        }
        context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
        if (context_ == EGL_NO_CONTEXT ||
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
            throw std::runtime_error("EGL gives no OpenGL 3.3 core context");
        }
    }
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;
    ~EglContext() {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
    }
    [[nodiscard]] static void* proc_address(const char* name) {
        return reinterpret_cast<void*>(eglGetProcAddress(name));
    }

  private:
    EGLDisplay display_;
    EGLContext context_ = EGL_NO_CONTEXT;
};

void run(const char* scene, const char* file) {
    constexpr int width = 1024;
    constexpr int height = 512;
    const EglContext context;
    const host::Offscreen offscreen(EglContext::proc_address, width, height);
    const host::Triangle triangle(EglContext::proc_address);
    host::EmbeddedScene embedded(EglContext::proc_address, scene);
    for (const double time_s : {0.9, 1.2, 1.5}) {
        triangle.draw(offscreen.framebuffer(), width, height);
        embedded.draw(time_s, offscreen.framebuffer(), {width / 2, 0, width / 2, height});
    }
    viscera::io::write_png(file, triangle.read(offscreen.framebuffer(), width, height));
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) {
        std::cerr << "usage: host_egl SCENE.json OUT.png\n";
        return 2;
    }
    try {
        run(arguments[1], arguments[2]);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
