#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

namespace viscera::reference {

/// A picture in double precision, row 0 at the bottom, channels interleaved.
struct Buffer {
    int width = 0;
    int height = 0;
    int channels = 1;
    std::vector<double> data;

    Buffer() = default;
    Buffer(int w, int h, int c = 1, double value = 0.0)
        : width(w),
          height(h),
          channels(c),
          data(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c),
               value) {}

    [[nodiscard]] std::size_t index(int x, int y, int c = 0) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                   static_cast<std::size_t>(channels) +
               static_cast<std::size_t>(c);
    }
    [[nodiscard]] double at(int x, int y, int c = 0) const { return data[index(x, y, c)]; }
    [[nodiscard]] double& at(int x, int y, int c = 0) { return data[index(x, y, c)]; }
    [[nodiscard]] bool empty() const { return data.empty(); }
    /// UV of a pixel's centre.
    [[nodiscard]] glm::dvec2 uv(int x, int y) const { return {(x + 0.5) / width, (y + 0.5) / height}; }
};

/// GL_LINEAR with GL_CLAMP_TO_EDGE (OpenGL 3.3 core, 3.8.11). An empty buffer is 0 everywhere.
[[nodiscard]] inline double sample_linear(const Buffer& texture, glm::dvec2 uv, int c = 0) {
    if (texture.empty()) {
        return 0.0;
    }
    const double u = uv.x * texture.width - 0.5;
    const double v = uv.y * texture.height - 0.5;
    const double i = std::floor(u);
    const double j = std::floor(v);
    const auto texel = [&](double x, double y) {
        return texture.at(static_cast<int>(std::clamp(x, 0.0, texture.width - 1.0)),
                          static_cast<int>(std::clamp(y, 0.0, texture.height - 1.0)), c);
    };
    const double a = u - i;
    const double b = v - j;
    return (1.0 - a) * (1.0 - b) * texel(i, j) + a * (1.0 - b) * texel(i + 1.0, j) +
           (1.0 - a) * b * texel(i, j + 1.0) + a * b * texel(i + 1.0, j + 1.0);
}

/// As sample_linear, and 0 outside the texture.
[[nodiscard]] inline double sample_inside(const Buffer& texture, glm::dvec2 uv, int c = 0) {
    const bool inside = uv.x >= 0.0 && uv.x <= 1.0 && uv.y >= 0.0 && uv.y <= 1.0;
    return inside ? sample_linear(texture, uv, c) : 0.0;
}

}  // namespace viscera::reference
