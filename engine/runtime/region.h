#pragma once

#include <glm/glm.hpp>

#include "engine/core/mesh_data.h"
#include "engine/runtime/frame.h"

namespace viscera {

/// The part of a target [pixels] that a box can cover, one pixel of margin included; all of it when the box
/// reaches before the near plane; empty when it lies outside the view, behind the eye included.
[[nodiscard]] PixelRect project_bounds(const Bounds& bounds, const glm::dmat4& view_projection,
                                       glm::ivec2 size);

}  // namespace viscera
