#pragma once

#include <functional>
#include <string_view>

namespace viscera {

/// Told how far a long piece of work is, in [0, 1]. Returning false stops the work, which then throws
/// Error(usage) "cancelled".
using Progress = std::function<bool(double fraction)>;

/// As Progress, for whoever hears of many pieces of work: `what` says which, "loading head.mha".
using ProgressCallback = std::function<bool(std::string_view what, double fraction)>;

}  // namespace viscera
