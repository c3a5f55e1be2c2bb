#pragma once

#include <limits>

namespace viscera {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr float nan_float = std::numeric_limits<float>::quiet_NaN();
inline constexpr float infinity_float = std::numeric_limits<float>::infinity();

}  // namespace viscera
