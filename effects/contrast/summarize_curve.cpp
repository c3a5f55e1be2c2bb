#include "effects/contrast/summarize_curve.h"

#include <array>

namespace viscera::contrast {

std::span<const std::string_view> choice_names(SummarizeTransition /*transition*/) {
    static constexpr std::array<std::string_view, 2> names{"smooth", "thesis"};
    return names;
}

}  // namespace viscera::contrast
