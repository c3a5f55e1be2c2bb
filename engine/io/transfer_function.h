#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/transfer_function.h"

namespace viscera::io {

/// Reads transfer functions with the technique, lighting and interpolation that the file asks for:
/// .vp (3D Slicer, text), .vp.json (3D Slicer, vtkMRMLVolumePropertyNode JSON), .json (ParaView colour maps:
/// an array of
/// {"Name", "RGBPoints", "Points", "ColorSpace", ...}, or viscera's own: an object with "points"). One per
/// preset in the file. ParaView maps over [0, 1] are kept so; `range` of the scene stretches them. Colour
/// spaces other than RGB are converted to RGB knots dense enough that the error is below 1/255. Throws
/// Error(file) naming file, key and what is wrong with it.
[[nodiscard]] std::vector<TransferFunction> load_transfer_functions(const std::filesystem::path& file,
                                                                    Log& log);

}  // namespace viscera::io
