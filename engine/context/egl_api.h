#pragma once

#define EGL_NO_X11  // keeps X11's macros out
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <string>
#include <string_view>
#include <vector>

namespace viscera {

/// EGL's functions, found in libEGL.so.1 at run time.
struct EglApi {
    decltype(&eglGetProcAddress) get_proc_address = nullptr;
    decltype(&eglQueryString) query_string = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglBindAPI) bind_api = nullptr;
    decltype(&eglChooseConfig) choose_config = nullptr;
    decltype(&eglCreateContext) create_context = nullptr;
    decltype(&eglDestroyContext) destroy_context = nullptr;
    decltype(&eglMakeCurrent) make_current = nullptr;
    decltype(&eglGetCurrentContext) get_current_context = nullptr;
    decltype(&eglGetError) get_error = nullptr;
    PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;             ///< null without device enumeration
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;  ///< null without device query
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
    std::string client_extensions;

    /// Throws Error(context) naming `where` and what to install when there is no EGL.
    static EglApi load(const char* where);

    [[nodiscard]] std::vector<EGLDeviceEXT> devices(const char* where) const;
    /// Whether Mesa says of a device that it is the CPU.
    [[nodiscard]] bool is_software(EGLDeviceEXT device) const;
    /// "EGL_NOT_INITIALIZED"; clears it.
    [[nodiscard]] std::string last_error() const;
};

/// Whether a space-separated list holds a word.
[[nodiscard]] bool has_extension(std::string_view list, std::string_view word);

}  // namespace viscera
