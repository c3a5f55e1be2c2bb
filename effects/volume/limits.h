#pragma once

#include <span>
#include <string_view>

namespace viscera::volume {

/// Where rays begin and end.
enum class Limits {
    analytic,  ///< at the box's planes
    two_pass,  ///< where the box's faces have been drawn
    mesh,      ///< where a mesh's faces have been drawn, within the box
};
[[nodiscard]] std::span<const std::string_view> choice_names(Limits limits);

}  // namespace viscera::volume
