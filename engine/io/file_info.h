#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace viscera::io {

/// What a file holds, as a JSON object with "file", "kind" ("meshes", "centreline", "image") and one list per
/// kind: meshes with vertices, triangles, bounds in mm, attributes, whether closed and which way round;
/// centrelines with nodes, edges, ends and radii; images with size, format, attributes and the finite range,
/// NaN and Inf of each channel. "faults" counts what was dropped on reading. Throws Error(file), for an
/// unknown extension with what can be read and what to convert with.
[[nodiscard]] nlohmann::json describe(const std::filesystem::path& file);

}  // namespace viscera::io
