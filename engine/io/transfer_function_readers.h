#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/transfer_function.h"
#include "engine/io/json_cursor.h"
#include "engine/io/vtk_curve.h"

namespace viscera::io {

// The formats behind load_transfer_functions. Each throws Error(file) naming file, key and what is wrong.
// Functions without a name in the file come without one.

/// 3D Slicer's text: a line each for interpolation, shade, diffuse, ambient, specular, specular power, then
/// scalar opacity, gradient opacity and colour, each a count of numbers and the numbers.
[[nodiscard]] TransferFunction read_slicer_text(const std::filesystem::path& file, std::string_view text);
/// 3D Slicer's volume-property-schema-v1; of several components the first.
[[nodiscard]] std::vector<TransferFunction> read_slicer_json(const JsonCursor& root, Log& log);
/// A list of ParaView's colour maps, or one.
[[nodiscard]] std::vector<TransferFunction> read_paraview(const JsonCursor& root, Log& log);

/// Gradient opacity as the second axis; empty where it changes nothing.
[[nodiscard]] std::vector<GradientPoint> gradient_axis(std::vector<VtkNode> nodes);

}  // namespace viscera::io
