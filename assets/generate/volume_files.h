#pragma once

#include <filesystem>

#include "engine/core/volume.h"

namespace viscera::assets {

/// Writes a volume as compressed MetaImage (.mha) or NRRD (.nrrd), by extension. Rescale is not written.
/// Throws std::runtime_error.
void write_volume(const Volume& volume, const std::filesystem::path& path);

}  // namespace viscera::assets
