#include "effects/contrast/summarize_curve.h"

#include <array>

namespace viscera::contrast {

std::span<const std::string_view> choice_names(SummarizeTransition /*transition*/) {
    static constexpr std::array<std::string_view, 3> names{"smooth", "thesis", "densest"};
    return names;
}

}  // namespace viscera::contrast
