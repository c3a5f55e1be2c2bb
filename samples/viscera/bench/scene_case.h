#pragma once

#include "engine/core/scene.h"
#include "samples/viscera/bench/lab.h"

namespace viscera::app {

/// Times whole frames of any scene, without files: one row of the group "scene". A single repeat is not
/// warmed up: for pictures that take long. `pixels`: where the first output is written as float32, top row
/// first, channels interleaved; empty: nowhere. Throws Error(file).
void run_scene(Lab& lab, const Scene& scene, const std::filesystem::path& pixels);

}  // namespace viscera::app
