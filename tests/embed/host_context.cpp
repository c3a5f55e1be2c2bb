#include "tests/embed/host_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace viscera::test {

class HostContext::Library {
  public:
    virtual ~Library() = default;
    virtual bool make_current() = 0;
    virtual void release() = 0;
    [[nodiscard]] virtual ProcAddress proc() const = 0;
};

namespace {

void* open(const char* name) {
    void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        throw std::runtime_error(dlerror());
    }
    return library;
}

template <class Function>
void find(void* library, const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, name));
    if (function == nullptr) {
        throw std::runtime_error(std::string("no ") + name);
    }
}

class Egl final : public HostContext::Library {
  public:
    explicit Egl(bool debug) {
        void* const library = open("libEGL.so.1");
        decltype(&eglGetPlatformDisplay) get_display = nullptr;
        decltype(&eglInitialize) initialize = nullptr;
        decltype(&eglBindAPI) bind_api = nullptr;
        decltype(&eglCreateContext) create = nullptr;
        find(library, "eglGetPlatformDisplay", get_display);
        find(library, "eglInitialize", initialize);
        find(library, "eglBindAPI", bind_api);
        find(library, "eglCreateContext", create);
        find(library, "eglDestroyContext", destroy_);
        find(library, "eglMakeCurrent", make_current_);
        find(library, "eglGetProcAddress", proc_);
        display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
        const std::array<EGLint, 9> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                               3,
                                               EGL_CONTEXT_MINOR_VERSION,
                                               3,
                                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                               EGL_CONTEXT_OPENGL_DEBUG,
                                               debug ? EGL_TRUE : EGL_FALSE,
                                               EGL_NONE};
        if (initialize(display_, nullptr, nullptr) != EGL_TRUE || bind_api(EGL_OPENGL_API) != EGL_TRUE ||
            (context_ = create(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data())) ==
                EGL_NO_CONTEXT) {
            throw std::runtime_error("EGL gives no context");
        }
    }
    ~Egl() override { destroy_(display_, context_); }
    bool make_current() override {
        return make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
    }
    void release() override { make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
    [[nodiscard]] ProcAddress proc() const override { return reinterpret_cast<ProcAddress>(proc_); }

  private:
    decltype(&eglDestroyContext) destroy_ = nullptr;
    decltype(&eglMakeCurrent) make_current_ = nullptr;
    decltype(&eglGetProcAddress) proc_ = nullptr;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

class Osmesa final : public HostContext::Library {
  public:
    Osmesa() {
        void* const library = open("libOSMesa.so.8");
        decltype(&OSMesaCreateContextAttribs) create = nullptr;
        find(library, "OSMesaCreateContextAttribs", create);
        find(library, "OSMesaDestroyContext", destroy_);
        find(library, "OSMesaMakeCurrent", make_current_);
        find(library, "OSMesaGetProcAddress", proc_);
        constexpr std::array<int, 9> attributes{OSMESA_FORMAT,
                                                OSMESA_RGBA,
                                                OSMESA_PROFILE,
                                                OSMESA_CORE_PROFILE,
                                                OSMESA_CONTEXT_MAJOR_VERSION,
                                                3,
                                                OSMESA_CONTEXT_MINOR_VERSION,
                                                3,
                                                0};
        context_ = create(attributes.data(), nullptr);
        if (context_ == nullptr) {
            throw std::runtime_error("OSMesa gives no context");
        }
    }
    ~Osmesa() override { destroy_(context_); }
    bool make_current() override {
        return make_current_(context_, pixels_.data(), GL_UNSIGNED_BYTE, side, side) == GL_TRUE;
    }
    void release() override { make_current_(nullptr, nullptr, 0, 0, 0); }
    [[nodiscard]] ProcAddress proc() const override { return reinterpret_cast<ProcAddress>(proc_); }

  private:
    static constexpr int side = 64;
    decltype(&OSMesaDestroyContext) destroy_ = nullptr;
    decltype(&OSMesaMakeCurrent) make_current_ = nullptr;
    decltype(&OSMesaGetProcAddress) proc_ = nullptr;
    OSMesaContext context_ = nullptr;
    std::vector<unsigned char> pixels_ = std::vector<unsigned char>(std::size_t{4} * side * side);
};

}  // namespace

HostContext::HostContext(Kind kind) {
    if (kind == Kind::osmesa) {
        library_ = std::make_unique<Osmesa>();
    } else {
        library_ = std::make_unique<Egl>(kind == Kind::egl_debug);
    }
    make_current();
}

HostContext::~HostContext() {
    library_->release();
}

void HostContext::make_current() {
    if (!library_->make_current()) {
        throw std::runtime_error("the host's context cannot be made current");
    }
}

void HostContext::release() {
    library_->release();
}

ProcAddress HostContext::proc() const {
    return library_->proc();
}

}  // namespace viscera::test
