#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace viscera {

/// Returns the text of a shader file named relative to glsl/ ("common/fullscreen.vert"), or none.
using ShaderReader = std::function<std::optional<std::string>(std::string_view name)>;

/// Reads from a folder on disk.
[[nodiscard]] ShaderReader shader_reader_from_folder(std::filesystem::path folder);

/// A file that an expanded source came from, and for each of its lines where that line stands.
struct SourceLine {
    std::size_t file = 0;  ///< index into ShaderSource::files
    int line = 0;          ///< 1-based
};

/// A shader with its includes and defines in one text, ready for the driver.
struct ShaderSource {
    std::string text;
    std::vector<std::string> files;  ///< names relative to glsl/, the main file first
    std::vector<SourceLine>
        lines;  ///< lines[i] says where line i + 1 of `text` stands; file == npos: made here

    static constexpr std::size_t npos = static_cast<std::size_t>(-1);
};

/// Expands `#include "name"` (relative to glsl/, each file once, whatever `#if` stands around it) and writes
/// `#define`s ("NAME" or "NAME value") after the `#version` line, which must be the first line of the main
/// file. Throws Error(gl) naming file and line for a missing or cyclic include, or a missing #version.
[[nodiscard]] ShaderSource expand_shader(std::string_view name, std::span<const std::string> defines,
                                         const ShaderReader& reader);

/// Rewrites a driver's log so that each line number of the expanded text becomes "file:line"; a line made
/// here becomes "<defines>:n" for the nth define. Understands Mesa ("0:12(5): error"), NVIDIA ("0(12) :
/// error"), glslang and AMD ("ERROR: 0:12:").
[[nodiscard]] std::string map_shader_log(std::string_view log, const ShaderSource& source);

/// What one program is made of. Every variant that an effect may use is listed by it, so that all can be
/// validated.
struct ProgramDesc {
    std::string vertex;                ///< file relative to glsl/
    std::string fragment;              ///< file relative to glsl/; empty for transform feedback only
    std::vector<std::string> defines;  ///< "NAME" or "NAME value"
    std::string compute;  ///< file relative to glsl/, for OpenGL 4.3; then the other two are empty

    bool operator==(const ProgramDesc&) const = default;
};

/// "contrast/geometry.frag[CLOUD,DISTANCE]", for labels and messages.
[[nodiscard]] std::string to_string(const ProgramDesc& program);

}  // namespace viscera
