#pragma once

#include "engine/runtime/effect.h"

namespace viscera::app {

/// Effects that only the bench draws: ceilings that real passes are held against.
void register_bench_effects(Registry& registry);

/// Shaders of the bench first, then viscera's.
[[nodiscard]] ShaderReader bench_shaders();

}  // namespace viscera::app
