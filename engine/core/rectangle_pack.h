#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace viscera {

/// Puts rectangles into the unit square without turning them: lowest free place of a skyline, tallest
/// rectangle first. Lower left corners in the order given; nothing when they do not fit.
[[nodiscard]] std::optional<std::vector<glm::dvec2>> pack_rectangles(std::span<const glm::dvec2> sizes);

}  // namespace viscera
