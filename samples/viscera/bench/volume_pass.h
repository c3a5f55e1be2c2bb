#pragma once

#include "engine/runtime/effect.h"

namespace viscera::app {

/// The ray caster with another shader in place of its own, on the same rays: "bench.ray_ceiling" takes as
/// many samples and only adds them up; "bench.ray_count" draws how many samples the ray caster takes of each
/// ray.
void register_volume_passes(Registry& registry);

}  // namespace viscera::app
