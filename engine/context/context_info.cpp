#include "engine/context/context_info.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>

#include "engine/gl/functions.h"

namespace viscera {

namespace {

namespace fs = std::filesystem;

bool has_nvidia_vendor_file(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (it->path().filename().string().find("nvidia") != std::string::npos) {
            return true;
        }
    }
    return false;
}

}  // namespace

bool is_software_renderer(std::string_view renderer) {
    constexpr std::array<std::string_view, 7> names{
        "llvmpipe", "softpipe", "swrast", "Software Rasterizer", "SwiftShader", "SWR", "GDI Generic"};
    return std::ranges::any_of(
        names, [&](std::string_view name) { return renderer.find(name) != std::string_view::npos; });
}

ContextInfo read_context_info(Backend backend, ProcAddress proc) {
    return read_context_info(backend, *gl::Functions::load(proc));
}

ContextInfo read_context_info(Backend backend, const gl::Functions& gl) {
    const auto text = [&](GLenum name) {
        const auto* value = reinterpret_cast<const char*>(gl.GetString(name));
        return std::string(value != nullptr ? value : "");
    };
    ContextInfo info;
    info.backend = backend;
    info.vendor = text(GL_VENDOR);
    info.renderer = text(GL_RENDERER);
    info.version = text(GL_VERSION);
    gl.GetIntegerv(GL_MAJOR_VERSION, &info.major);
    gl.GetIntegerv(GL_MINOR_VERSION, &info.minor);
    info.software = is_software_renderer(info.renderer);
    if (info.software && backend != Backend::osmesa) {  // OSMesa renders on the CPU on purpose
        info.remark = nvidia_remark();
    }
    return info;
}

std::string nvidia_remark(const fs::path& root) {
    std::error_code error;
    if (!fs::exists(root / "dev/nvidiactl", error)) {
        return {};
    }
    // Whoever sets these has told EGL himself where to look.
    for (const char* variable : {"__EGL_VENDOR_LIBRARY_FILENAMES", "__EGL_VENDOR_LIBRARY_DIRS"}) {
        if (std::getenv(variable) != nullptr) {
            return {};
        }
    }
    for (const char* folder : {"etc/glvnd/egl_vendor.d", "usr/share/glvnd/egl_vendor.d"}) {
        if (has_nvidia_vendor_file(root / folder)) {
            return {};
        }
    }
    return "NVIDIA device files are present but no EGL vendor file names their driver: install the driver's "
           "EGL "
           "part (Debian package nvidia-egl-icd), or start the container with "
           "NVIDIA_DRIVER_CAPABILITIES=graphics,compute";
}

}  // namespace viscera
