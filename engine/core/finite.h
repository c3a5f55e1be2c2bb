#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace viscera {

/// Whether a number is one: neither NaN nor infinite.
[[nodiscard]] inline bool finite(double value) {
    return std::isfinite(value);
}

/// Whether all numbers of a vector are.
template <glm::length_t length, typename Number, glm::qualifier qualifier>
[[nodiscard]] bool finite(const glm::vec<length, Number, qualifier>& v) {
    bool all = true;
    for (glm::length_t i = 0; i < length; ++i) {
        all = all && std::isfinite(v[i]);
    }
    return all;
}

/// Whether all numbers of a matrix are.
template <glm::length_t columns, glm::length_t rows, typename Number, glm::qualifier qualifier>
[[nodiscard]] bool finite(const glm::mat<columns, rows, Number, qualifier>& m) {
    bool all = true;
    for (glm::length_t column = 0; column < columns; ++column) {
        all = all && finite(m[column]);
    }
    return all;
}

}  // namespace viscera
