#pragma once

#include "engine/runtime/effect.h"

namespace viscera::app {

/// Effects with another shader in place of their own, on the same geometry and into the same targets: what a
/// pass would cost at least. "bench.ray_ceiling" takes as many samples as the ray caster and only adds them
/// up; "bench.ray_count" draws how many samples the ray caster takes of each ray; "bench.organ_ceiling" draws
/// an organ in one colour.
void register_other_shaders(Registry& registry);

}  // namespace viscera::app
