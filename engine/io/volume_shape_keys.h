#pragma once

#include <functional>
#include <map>
#include <string>

#include "engine/core/volume_shape.h"
#include "engine/io/volume_head.h"

namespace viscera::io {

using KeyValues = std::map<std::string, std::string, std::less<>>;

/// The curvilinear geometry that key/value pairs of a header describe (docs/conventions.md lists them):
/// `viscera_geometry`, and keys named as the scene's parameter volume.geometry, with `viscera_` before.
/// Cartesian where there are none. Throws Error(file) that names the key: one that is unknown or of another
/// kind of geometry, is missing, or has a value that does not hold.
[[nodiscard]] VolumeShape shape_of_keys(const KeyValues& values, const Reading& reading);

/// Lines "key:=value" that read back as the same shape; empty for Cartesian ones.
[[nodiscard]] std::string keys_of(const VolumeShape& shape);

}  // namespace viscera::io
