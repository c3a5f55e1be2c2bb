#pragma once

#include <cstddef>
#include <vector>

namespace viscera::assets {

/// One-channel picture, row 0 at the TOP as files have it.
struct GrayImage {
    int width = 0;
    int height = 0;
    std::vector<float> pixels;  ///< width * height values

    GrayImage(int w, int h)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    [[nodiscard]] float& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
    [[nodiscard]] float at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

/// Convolution with a Gaussian of standard deviation sigma [pixels], >= 0; the border is repeated.
void blur(GrayImage& image, double sigma);

}  // namespace viscera::assets
