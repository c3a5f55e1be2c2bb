#pragma once

#include <vector>

#include "engine/core/plan.h"

namespace viscera {

/// First step of compile(): every name turned into the content it means at that place, with no pass culled
/// and no texture given yet. Plan::history holds every name that is read as `previous`.
[[nodiscard]] CompileResult resolve_names(const Graph& graph, int width, int height, int max_size);

}  // namespace viscera
