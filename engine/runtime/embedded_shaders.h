#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/shader_source.h"

namespace viscera {

/// A shader file as the build put it into the binary. Both views live as long as the program.
struct EmbeddedShader {
    std::string_view name;  ///< relative to its folder: "common/fullscreen.vert"
    std::string_view text;
};

/// The files under glsl/, sorted by name. The build generates it (cmake/embed_shaders.cmake); a project with
/// shaders of its own generates another such function with `viscera_embed_shaders`.
[[nodiscard]] std::span<const EmbeddedShader> embedded_shader_table();

/// Text of a file under glsl/, or none.
[[nodiscard]] std::optional<std::string> embedded_shader(std::string_view name);
[[nodiscard]] std::vector<std::string_view> embedded_shader_names();

/// Reads from viscera's own table.
[[nodiscard]] ShaderReader embedded_shader_reader();
/// Reads from a project's own table first, then from viscera's, so that it can include viscera's files.
[[nodiscard]] ShaderReader embedded_shader_reader(std::span<const EmbeddedShader> table);

}  // namespace viscera
