#pragma once

#include "engine/runtime/effect.h"

namespace viscera {

/// Every effect that viscera has.
void register_all(Registry& registry);

}  // namespace viscera
