#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

namespace viscera::io {

/// Direction matrix of three letters that say where i, j and k run to: "LPS" is the world's own frame, "RAS"
/// that of NIfTI. None unless each anatomical axis is named once.
[[nodiscard]] std::optional<glm::dmat3> direction_of_axes(std::string_view axes);

}  // namespace viscera::io
