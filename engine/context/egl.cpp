#include <algorithm>
#include <array>
#include <numeric>

#include "engine/context/backends.h"
#include "engine/context/context_info.h"
#include "engine/context/current_slot.h"
#include "engine/context/egl_api.h"
#include "engine/core/error.h"

namespace viscera {

namespace {

/// An EGL context without a surface. Its display stays initialised when the context goes: other contexts of
/// the process, the host's too, may use the same one.
class EglContext final : public Context {
  public:
    EglContext(EglApi egl, EGLDisplay display, EGLContext context, Backend backend)
        : egl_(std::move(egl)), display_(display), context_(context) {
        info_.backend = backend;
        try {
            make_current();
            info_ = read_context_info(backend, proc_address());
        } catch (...) {
            destroy();
            throw;
        }
    }
    ~EglContext() override { destroy(); }

    void make_current() override {
        CurrentSlot::release();
        if (egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
            throw Error(ErrorCode::context, std::string(to_string(info_.backend)),
                        "eglMakeCurrent failed with " + egl_.last_error());
        }
    }
    void release() override {
        if (egl_.get_current_context() == context_) {
            egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
    }
    [[nodiscard]] ProcAddress proc_address() const override {
        return reinterpret_cast<ProcAddress>(egl_.get_proc_address);
    }
    void set_device(int index) { info_.egl_device = index; }

  private:
    void destroy() noexcept {
        if (egl_.get_current_context() == context_) {
            egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
        egl_.destroy_context(display_, context_);
    }

    EglApi egl_;
    EGLDisplay display_;
    EGLContext context_;
};

EGLConfig choose_config(const EglApi& egl, EGLDisplay display, std::string_view extensions) {
    constexpr std::array<EGLint, 5> attributes{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                               EGL_SURFACE_TYPE,  // else windows are asked for
                                               0, EGL_NONE};
    if (has_extension(extensions, "EGL_KHR_no_config_context")) {
        return EGL_NO_CONFIG_KHR;
    }
    EGLConfig config = nullptr;
    EGLint count = 0;
    egl.choose_config(display, attributes.data(), &config, 1, &count);
    return config;
}

std::unique_ptr<EglContext> create_on(const EglApi& egl, EGLDisplay display, Backend backend,
                                      const ContextOptions& options) {
    const auto refuse = [&](const std::string& why) {
        return Error(ErrorCode::context, std::string(to_string(backend)), why);
    };
    EGLint major = 0;
    EGLint minor = 0;
    if (display == EGL_NO_DISPLAY || egl.initialize(display, &major, &minor) != EGL_TRUE) {
        throw refuse("no display: " + egl.last_error() +
                     "; its driver is missing (Debian package libgl1-mesa-dri) or /dev/dri may not be opened "
                     "(groups video and render)");
    }
    const char* text = egl.query_string(display, EGL_EXTENSIONS);
    const std::string_view extensions = text != nullptr ? text : "";
    if (!has_extension(extensions, "EGL_KHR_surfaceless_context")) {
        throw refuse("the driver lacks EGL_KHR_surfaceless_context");
    }
    if (egl.bind_api(EGL_OPENGL_API) != EGL_TRUE) {
        throw refuse("the driver knows OpenGL ES only: " + egl.last_error());
    }
    const EGLConfig config = choose_config(egl, display, extensions);
    EGLContext context = EGL_NO_CONTEXT;
    for (const std::array<int, 2>& version : {options.version, {3, 3}}) {
        const std::array<EGLint, 9> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                               version[0],
                                               EGL_CONTEXT_MINOR_VERSION,
                                               version[1],
                                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                               EGL_CONTEXT_FLAGS_KHR,
                                               options.debug ? EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR : 0,
                                               EGL_NONE};
        context = egl.create_context(display, config, EGL_NO_CONTEXT, attributes.data());
        if (context != EGL_NO_CONTEXT) {
            break;
        }
    }
    if (context == EGL_NO_CONTEXT) {
        throw refuse("no OpenGL 3.3 core context: eglCreateContext failed with " + egl.last_error());
    }
    auto made = std::make_unique<EglContext>(egl, display, context, backend);
    check_hardware(made->info(), options);
    return made;
}

std::unique_ptr<Context> create_on_device(const EglApi& egl, EGLDeviceEXT device, int index,
                                          const ContextOptions& options) {
    const EGLDisplay display = egl.get_platform_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    auto context = create_on(egl, display, Backend::egl_device, options);
    context->set_device(index);
    return context;
}

}  // namespace

int count_egl_devices() {
    return static_cast<int>(EglApi::load("egl-device").devices("egl-device").size());
}

std::unique_ptr<Context> create_egl_device(const ContextOptions& options) {
    constexpr auto where = "egl-device";
    const EglApi egl = EglApi::load(where);
    const auto devices = egl.devices(where);
    if (options.egl_device) {
        const int index = *options.egl_device;
        if (index < 0 || index >= static_cast<int>(devices.size())) {
            throw Error(ErrorCode::context, where,
                        "there is no EGL device " + std::to_string(index) + ": this machine has " +
                            std::to_string(devices.size()) + ", counted from 0");
        }
        return create_on_device(egl, devices[static_cast<std::size_t>(index)], index, options);
    }

    std::vector<std::size_t> order(devices.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_partition(order.begin(), order.end(),
                          [&](std::size_t i) { return !egl.is_software(devices[i]); });
    std::string said;
    for (const std::size_t i : order) {
        try {
            return create_on_device(egl, devices[i], static_cast<int>(i), options);
        } catch (const Error& error) {
            said += "\n  device " + std::to_string(i) + ": " + error.what();
        }
    }
    throw Error(ErrorCode::context, where,
                devices.empty() ? "EGL has no devices: install the Debian package libgl1-mesa-dri"
                                : "no EGL device gives a context:" + said);
}

std::unique_ptr<Context> create_egl_surfaceless(const ContextOptions& options) {
    constexpr auto where = "egl-surfaceless";
    const EglApi egl = EglApi::load(where);
    if (!has_extension(egl.client_extensions, "EGL_MESA_platform_surfaceless")) {
        throw Error(ErrorCode::context, where,
                    "EGL has no EGL_MESA_platform_surfaceless: install the Debian packages libegl-mesa0 and "
                    "libgl1-mesa-dri");
    }
    const EGLDisplay display = egl.get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    return create_on(egl, display, Backend::egl_surfaceless, options);
}

}  // namespace viscera
