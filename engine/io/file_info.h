#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "engine/core/log.h"

namespace viscera::io {

/// What a file holds, as a JSON object with "file", "kind" ("meshes", "centreline", "image", "volume") and
/// one list or object per kind: meshes with vertices, triangles, bounds in mm, attributes, whether closed and
/// which way round; centrelines with nodes, edges, ends and radii; images with size, format, attributes and
/// the finite range, NaN and Inf of each channel; volumes with dims, spacing, origin, direction (rows),
/// stored type, rescale, unit, and of each channel the rescaled finite range, mean, NaN and Inf, and a
/// histogram of 32 equal bins over that range. "faults" counts what was dropped on reading; `tell` gets what
/// readers say in words, such as what they took for granted. Throws Error(file), for an unknown extension
/// with what can be read and what to convert with.
[[nodiscard]] nlohmann::json describe(const std::filesystem::path& file, const LogCallback& tell = {});

}  // namespace viscera::io
