#include "engine/context/egl_api.h"

#include <array>
#include <utility>

#include "engine/context/shared_library.h"
#include "engine/core/error.h"

namespace viscera {

namespace {

constexpr auto remedy = "install the Debian packages libegl1 and libgl1-mesa-dri, or a GPU's own driver";

}  // namespace

bool has_extension(std::string_view list, std::string_view word) {
    for (std::size_t at = list.find(word); at != std::string_view::npos; at = list.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || list[at - 1] == ' ') && (end == list.size() || list[end] == ' ')) {
            return true;
        }
    }
    return false;
}

EglApi EglApi::load(const char* where) {
    const auto library = SharedLibrary::open(where, {"libEGL.so.1"}, remedy);
    EglApi egl;
    library.require(where, "eglGetProcAddress", egl.get_proc_address);
    library.require(where, "eglQueryString", egl.query_string);
    library.require(where, "eglInitialize", egl.initialize);
    library.require(where, "eglBindAPI", egl.bind_api);
    library.require(where, "eglChooseConfig", egl.choose_config);
    library.require(where, "eglCreateContext", egl.create_context);
    library.require(where, "eglDestroyContext", egl.destroy_context);
    library.require(where, "eglMakeCurrent", egl.make_current);
    library.require(where, "eglGetCurrentContext", egl.get_current_context);
    library.require(where, "eglGetError", egl.get_error);

    const char* extensions = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    egl.client_extensions = extensions != nullptr ? extensions : "";
    const auto has = [&](std::string_view word) { return has_extension(egl.client_extensions, word); };
    if (!has("EGL_EXT_platform_base")) {
        throw Error(
            ErrorCode::context, where,
            std::string("EGL has no EGL_EXT_platform_base, as when no driver is installed: ") + remedy);
    }
    egl.get_platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl.get_proc_address("eglGetPlatformDisplayEXT"));
    if (has("EGL_EXT_device_enumeration") || has("EGL_EXT_device_base")) {
        egl.query_devices =
            reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl.get_proc_address("eglQueryDevicesEXT"));
    }
    if (has("EGL_EXT_device_query") || has("EGL_EXT_device_base")) {
        egl.query_device_string =
            reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(egl.get_proc_address("eglQueryDeviceStringEXT"));
    }
    return egl;
}

std::vector<EGLDeviceEXT> EglApi::devices(const char* where) const {
    if (query_devices == nullptr || !has_extension(client_extensions, "EGL_EXT_platform_device")) {
        throw Error(ErrorCode::context, where, std::string("EGL cannot list its devices: ") + remedy);
    }
    EGLint count = 0;
    if (query_devices(0, nullptr, &count) != EGL_TRUE) {
        throw Error(ErrorCode::context, where, "eglQueryDevicesEXT failed with " + last_error());
    }
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (query_devices(count, devices.data(), &count) != EGL_TRUE) {
        throw Error(ErrorCode::context, where, "eglQueryDevicesEXT failed with " + last_error());
    }
    devices.resize(static_cast<std::size_t>(count));
    return devices;
}

bool EglApi::is_software(EGLDeviceEXT device) const {
    const char* extensions =
        query_device_string != nullptr ? query_device_string(device, EGL_EXTENSIONS) : nullptr;
    return extensions != nullptr && has_extension(extensions, "EGL_MESA_device_software");
}

std::string EglApi::last_error() const {
    constexpr std::array<std::pair<EGLint, const char*>, 10> names{{
        {EGL_SUCCESS, "EGL_SUCCESS"},
        {EGL_NOT_INITIALIZED, "EGL_NOT_INITIALIZED"},
        {EGL_BAD_ACCESS, "EGL_BAD_ACCESS"},
        {EGL_BAD_ALLOC, "EGL_BAD_ALLOC"},
        {EGL_BAD_ATTRIBUTE, "EGL_BAD_ATTRIBUTE"},
        {EGL_BAD_CONFIG, "EGL_BAD_CONFIG"},
        {EGL_BAD_CONTEXT, "EGL_BAD_CONTEXT"},
        {EGL_BAD_DISPLAY, "EGL_BAD_DISPLAY"},
        {EGL_BAD_MATCH, "EGL_BAD_MATCH"},
        {EGL_BAD_PARAMETER, "EGL_BAD_PARAMETER"},
    }};
    const EGLint error = get_error();
    for (const auto& [value, name] : names) {
        if (value == error) {
            return name;
        }
    }
    return "EGL error " + std::to_string(error);
}

}  // namespace viscera
