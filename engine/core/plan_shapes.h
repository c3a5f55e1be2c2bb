#pragma once

#include <map>
#include <string_view>

#include "engine/core/plan.h"

namespace viscera {

/// What a target is made of once the frame's size is known.
struct TargetShape {
    PixelFormat format = PixelFormat::rgba16f;
    int width = 1;   ///< [pixels]
    int height = 1;  ///< [pixels]
    std::array<float, 4> clear{};
    std::optional<std::size_t> imported;  ///< index into Graph::imported
    bool writable = true;
};

/// Shapes by name. The names are views into the graph.
using TargetShapes = std::map<std::string_view, TargetShape>;

/// Shapes of all described and imported targets; what is wrong with their descriptions goes to `faults`.
[[nodiscard]] TargetShapes resolve_shapes(const Graph& graph, int width, int height, int max_size,
                                          std::vector<Fault>& faults);

}  // namespace viscera
