#pragma once

#include <functional>
#include <string>

#include "engine/core/image.h"
#include "tests/reference/buffer.h"

namespace viscera::test {

/// Largest distance between a target and its reference.
struct Deviation {
    double max = 0.0;    ///< absolute
    int half_units = 0;  ///< steps of the half format between target and truncated reference
    int x = -1;          ///< pixel of the largest distance, in the measure of the target's format
    int y = -1;
    double got = 0.0;
    double wanted = 0.0;
    std::size_t compared = 0;  ///< pixels
    std::size_t left_out = 0;
    std::size_t not_finite = 0;
    std::size_t content = 0;  ///< pixels whose reference is not 0: what the comparison is worth
};

/// Which pixels have a counterpart; none: all.
using IsCompared = std::function<bool(int x, int y)>;

/// Compares one channel of a target with one of the reference. Half targets are held against the reference
/// truncated to half, as software renderers store it. Throws std::invalid_argument where the sizes differ.
[[nodiscard]] Deviation deviation(const Image& image, const reference::Buffer& wanted, int image_channel = 0,
                                  int wanted_channel = 0, const IsCompared& is_compared = {});

/// The largest half that is no further from 0 than a value.
[[nodiscard]] double truncate_to_half(double value);

/// A target as the reference reads it.
[[nodiscard]] reference::Buffer to_buffer(const Image& image);

/// Bounds of accuracy: absolute for float targets, one step for half ones.
inline constexpr double float_bound = 2e-6;
inline constexpr int half_bound = 1;

/// Expects a deviation within the bounds of the format, and prints it with a name.
void expect_accurate(const std::string& name, PixelFormat format, const Deviation& found,
                     std::size_t least_content = 1);

}  // namespace viscera::test
