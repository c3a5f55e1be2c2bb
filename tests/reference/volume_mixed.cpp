#include "tests/reference/volume_mixed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace viscera::reference {
namespace {

struct Axis {
    std::array<int, 4> texels{};
    std::array<double, 4> cubic{};
    std::array<double, 4> linear{};
    bool copied = false;
};

/// The texels next to the pixels of a tile along one axis, moved to where they have two neighbours.
std::set<int> corners(int tile, int n, int lines) {
    std::set<int> found;
    const int end = std::min((tile + 1) * MixedPicture::tile_size, lines);
    for (int pixel = tile * MixedPicture::tile_size; pixel < end; ++pixel) {
        for (int texel = 0; texel < n; ++texel) {
            const int line = MixedPicture::line_of(texel, n, lines);
            const bool last_before =
                line <= pixel && (texel + 1 == n || MixedPicture::line_of(texel + 1, n, lines) > pixel);
            const bool first_after =
                line > pixel && texel > 0 && MixedPicture::line_of(texel - 1, n, lines) < pixel;
            if (last_before || first_after) {
                found.insert(std::clamp(texel, 1, n - 2));
            }
        }
    }
    return found;
}

/// Second derivative at the middle one of three places, times the squared wider distance; 0 where there is no
/// pixel between them.
double second_difference(const std::array<double, 3>& at, const std::array<double, 3>& value) {
    const double unit = std::max(at[1] - at[0], at[2] - at[1]);
    const double rise = (value[1] - value[0]) / (at[1] - at[0]);
    const double next = (value[2] - value[1]) / (at[2] - at[1]);
    return unit > 1.0 ? 2.0 * unit * unit * (next - rise) / (at[2] - at[0]) : 0.0;
}

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
    if (depth_ != nullptr) {
        const double own = depth_->at(x, y, 0);
        filled.depth_gap = std::max(std::abs(depth_cubic - own), std::abs(depth_linear - own));
        if (x > 0 && x + 1 < lattice_.x) {
            const double mean =
                0.5 * (static_cast<double>(depth_->at(x - 1, y, 0)) + depth_->at(x + 1, y, 0));
            filled.depth_gap = std::max(filled.depth_gap, std::abs(mean - own));
        }
        if (y > 0 && y + 1 < lattice_.y) {
            const double mean =
                0.5 * (static_cast<double>(depth_->at(x, y - 1, 0)) + depth_->at(x, y + 1, 0));
            filled.depth_gap = std::max(filled.depth_gap, std::abs(mean - own));
        }
    }
    return filled;
}

double MixedPicture::bend(int x, int y) const {
    double most = 0.0;
    for (const int i : corners(x, coarse_.width, lattice_.x)) {
        for (const int j : corners(y, coarse_.height, lattice_.y)) {
            for (int c = 0; c < 4; ++c) {
                std::array<double, 3> columns{};
                std::array<double, 3> rows{};
                std::array<double, 3> across{};
                std::array<double, 3> up{};
                for (int k = 0; k < 3; ++k) {
                    const auto slot = static_cast<std::size_t>(k);
                    columns[slot] = line_of(i + k - 1, coarse_.width, lattice_.x);
                    rows[slot] = line_of(j + k - 1, coarse_.height, lattice_.y);
                    across[slot] = coarse_.at(i + k - 1, j, c);
                    up[slot] = coarse_.at(i, j + k - 1, c);
                }
                most = std::max(most, std::abs(second_difference(columns, across)) +
                                          std::abs(second_difference(rows, up)));
            }
        }
    }
    return most / 8.0;
}

}  // namespace viscera::reference
