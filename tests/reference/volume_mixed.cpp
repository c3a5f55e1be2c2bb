#include "tests/reference/volume_mixed.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace viscera::reference {
namespace {

struct Axis {
    std::array<int, 4> texels{};
    std::array<double, 4> cubic{};
    std::array<double, 4> linear{};
    std::array<double, 4> lines{};
    std::size_t left =
        0;  ///< of the two texels next to the pixel, the one before it: an index into the above
    double between = 0.0;  ///< 0 on a texel, 1 midway
    bool copied = false;

    /// Second derivative at texel i + 1 by divided differences, times the squared distance of the two next to
    /// the pixel.
    [[nodiscard]] double bend(const std::array<double, 4>& values, std::size_t i) const {
        const double unit = lines[left + 1] - lines[left];
        const double rise = (values[i + 1] - values[i]) / (lines[i + 1] - lines[i]);
        const double next = (values[i + 2] - values[i + 1]) / (lines[i + 2] - lines[i + 1]);
        return 2.0 * unit * unit * (next - rise) / (lines[i + 2] - lines[i]);
    }
};

std::optional<Axis> axis_of(int pixel, int n, int lines) {
    const auto line = [&](int texel) { return MixedPicture::line_of(texel, n, lines); };
    if (n < 4 || pixel < line(0) || pixel > line(n - 1)) {
        return std::nullopt;
    }
    int left = 0;
    while (left < n - 2 && line(left + 1) <= pixel) {
        ++left;
    }
    Axis axis;
    const int first = std::clamp(left - 1, 0, n - 4);
    for (int i = 0; i < 4; ++i) {
        axis.texels[static_cast<std::size_t>(i)] = first + i;
        double weight = 1.0;
        for (int j = 0; j < 4; ++j) {
            if (j != i) {
                weight *= static_cast<double>(pixel - line(first + j)) / (line(first + i) - line(first + j));
            }
        }
        axis.cubic[static_cast<std::size_t>(i)] = weight;
        axis.copied = axis.copied || pixel == line(first + i);
    }
    const double share = static_cast<double>(pixel - line(left)) / (line(left + 1) - line(left));
    axis.left = static_cast<std::size_t>(left - first);
    axis.between = 4.0 * share * (1.0 - share);
    for (int i = 0; i < 4; ++i) {
        axis.lines[static_cast<std::size_t>(i)] = line(first + i);
    }
    axis.linear[static_cast<std::size_t>(left - first)] = 1.0 - share;
    axis.linear[static_cast<std::size_t>(left - first + 1)] = share;
    return axis;
}

}  // namespace

int MixedPicture::line_of(int texel, int n, int lines) {
    return static_cast<int>(std::floor((texel + 0.5) * lines / n));
}

std::optional<MixedPicture::Filled> MixedPicture::at(int x, int y) const {
    const std::optional<Axis> across = axis_of(x, coarse_.width, lattice_.x);
    const std::optional<Axis> up = axis_of(y, coarse_.height, lattice_.y);
    if (!across || !up) {
        return std::nullopt;
    }
    Filled filled{.copied = across->copied && up->copied};
    double depth_cubic = 0.0;
    double depth_linear = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i) {
            const double cubic_weight = across->cubic[i] * up->cubic[j];
            const double linear_weight = across->linear[i] * up->linear[j];
            for (int c = 0; c < 4; ++c) {
                const double texel = coarse_.at(across->texels[i], up->texels[j], c);
                filled.colour[c] += cubic_weight * texel;
            }
            if (depth_ != nullptr) {
                const double depth = depth_->at(line_of(across->texels[i], coarse_.width, lattice_.x),
                                                line_of(up->texels[j], coarse_.height, lattice_.y), 0);
                depth_cubic += cubic_weight * depth;
                depth_linear += linear_weight * depth;
            }
        }
    }
    for (int c = 0; c < 4; ++c) {
        const auto texel = [&](std::size_t i, std::size_t j) {
            return static_cast<double>(coarse_.at(across->texels[i], up->texels[j], c));
        };
        double bend = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::array<double, 4> row{texel(0, k), texel(1, k), texel(2, k), texel(3, k)};
            const std::array<double, 4> column{texel(k, 0), texel(k, 1), texel(k, 2), texel(k, 3)};
            bend += across->between * up->linear[k] *
                    (std::abs(across->bend(row, 0)) + std::abs(across->bend(row, 1)));
            bend += up->between * across->linear[k] *
                    (std::abs(up->bend(column, 0)) + std::abs(up->bend(column, 1)));
        }
        filled.bend = std::max(filled.bend, bend / 16.0);
    }
    if (depth_ != nullptr) {
        const double own = depth_->at(x, y, 0);
        filled.depth_gap = std::max(std::abs(depth_cubic - own), std::abs(depth_linear - own));
    }
    return filled;
}

}  // namespace viscera::reference
