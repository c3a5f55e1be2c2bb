#pragma once

#include <filesystem>

#include "assets/generate/organ_paint.h"

namespace viscera::assets {

/// 8-bit PNG, with alpha where asked. Throws std::runtime_error.
void write_png(const ColourImage& image, bool with_alpha, const std::filesystem::path& path);

}  // namespace viscera::assets
