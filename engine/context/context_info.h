#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/context/context.h"

namespace viscera {

namespace gl {
struct Functions;
}

/// Whether a GL_RENDERER string names a rasteriser on the CPU.
[[nodiscard]] bool is_software_renderer(std::string_view renderer);

/// What the context current on this thread says of itself. Throws Error(context) where gl::Functions::load
/// does.
[[nodiscard]] ContextInfo read_context_info(Backend backend, ProcAddress proc);
[[nodiscard]] ContextInfo read_context_info(Backend backend, const gl::Functions& gl);

/// Why a machine with an NVIDIA GPU may render in software all the same: its device files are there, but no
/// vendor file tells EGL of its driver, as in containers without the graphics capability. Empty when that is
/// not so. `root`: where /dev, /etc and /usr are looked for.
[[nodiscard]] std::string nvidia_remark(const std::filesystem::path& root = "/");

}  // namespace viscera
