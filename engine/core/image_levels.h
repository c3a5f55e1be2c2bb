#pragma once

#include <vector>

#include "engine/core/image.h"

namespace viscera {

/// A picture and its smaller copies, each half as wide and high as the one before, rounded down, to 1 x 1.
/// A texel is the mean of the part of the picture that it covers, so that means stay what they are at any
/// size. Levels are rounded to the picture's format, which must be one of colour; none is made from rounded
/// numbers.
[[nodiscard]] std::vector<Image> image_levels(Image picture);

}  // namespace viscera
