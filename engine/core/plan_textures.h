#pragma once

#include <vector>

#include "engine/core/plan.h"

namespace viscera {

/// Last step of compile(): says how long each content lives and lets contents share textures. `needed` tells
/// which contents must exist, one flag per content; the others get no texture.
void assign_textures(Plan& plan, const std::vector<bool>& needed);

}  // namespace viscera
