#include "effects/volume/limits.h"

#include <array>

namespace viscera::volume {

std::span<const std::string_view> choice_names(Limits) {
    static constexpr std::array<std::string_view, 3> names{"analytic", "two_pass", "mesh"};
    return names;
}

}  // namespace viscera::volume
