#include "engine/core/volume_reduce_curvilinear.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace viscera {
namespace {

/// Samples of an axis that make one of the result: voxel `first + n`, around a ring from its beginning again,
/// has weight[n].
struct Window {
    int first = 0;
    std::vector<double> weight;
};

/// Integral over (-infinity, x] of the weight that linear interpolation gives a sample at 0.
double hat_integral(double x) {
    const double a = std::clamp(x, -1.0, 1.0);
    return a < 0.0 ? 0.5 * (1.0 + a) * (1.0 + a) : 1.0 - 0.5 * (1.0 - a) * (1.0 - a);
}

/// The mean of what linear interpolation makes of the samples over [centre - half, centre + half].
Window mean_window(double centre, double half) {
    Window window{.first = static_cast<int>(std::floor(centre - half))};
    const int last = static_cast<int>(std::ceil(centre + half));
    double sum = 0.0;
    for (int i = window.first; i <= last; ++i) {
        const double at = centre - i;
        const double weight = half > 0.0 ? hat_integral(at + half) - hat_integral(at - half)
                                         : std::max(0.0, 1.0 - std::abs(at));
        window.weight.push_back(weight);
        sum += weight;
    }
    for (double& weight : window.weight) {
        weight /= sum;
    }
    return window;
}

std::vector<Window> windows_of(int from, int to, bool ring, bool labels) {
    std::vector<Window> windows;
    const double step = ring     ? static_cast<double>(from) / to
                        : to > 1 ? static_cast<double>(from - 1) / (to - 1)
                                 : 0.0;
    for (int i = 0; i < to; ++i) {
        const double centre = i * step;
        // Symmetric, so that a ramp stays the ramp that it is: towards an end the window narrows.
        const double half = ring ? 0.5 * step : std::min({0.5 * step, centre, from - 1 - centre});
        windows.push_back(labels ? Window{static_cast<int>(std::lround(centre)), {1.0}}
                                 : mean_window(centre, std::max(half, 0.0)));
    }
    return windows;
}

template <class T>
T rounded(double value) {
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else {
        return static_cast<T>(std::lround(value));
    }
}

template <class T>
void resample(const Volume& volume, const std::array<std::vector<Window>, 3>& windows, Volume& result) {
    const glm::ivec3 from = volume.grid.dims;
    const auto channels = static_cast<std::size_t>(volume.channels);
    const auto* const in = reinterpret_cast<const T*>(volume.voxels.data());
    auto* out = reinterpret_cast<T*>(result.voxels.data());
    // Windows leave [0, n) only around a ring.
    const auto inside = [](int index, int count) {
        return static_cast<std::size_t>((index % count + count) % count);
    };
    for (const Window& z : windows[2]) {
        for (const Window& y : windows[1]) {
            for (const Window& x : windows[0]) {
                std::array<double, 4> sum{};
                std::array<double, 4> whole{};
                for (std::size_t k = 0; k < z.weight.size(); ++k) {
                    for (std::size_t j = 0; j < y.weight.size(); ++j) {
                        const double row_weight = z.weight[k] * y.weight[j];
                        if (row_weight == 0.0) {
                            continue;
                        }
                        const std::size_t row =
                            inside(z.first + static_cast<int>(k), from.z) * static_cast<std::size_t>(from.y) +
                            inside(y.first + static_cast<int>(j), from.y);
                        for (std::size_t i = 0; i < x.weight.size(); ++i) {
                            const std::size_t voxel = row * static_cast<std::size_t>(from.x) +
                                                      inside(x.first + static_cast<int>(i), from.x);
                            for (std::size_t c = 0; c < channels; ++c) {
                                const auto value = static_cast<double>(in[voxel * channels + c]);
                                const double weight = is_number(value) ? row_weight * x.weight[i] : 0.0;
                                sum[c] += weight > 0.0 ? weight * value : 0.0;
                                whole[c] += weight;
                            }
                        }
                    }
                }
                for (std::size_t c = 0; c < channels; ++c) {
                    *out++ = rounded<T>(whole[c] > 0.0 ? sum[c] / whole[c]
                                                       : std::numeric_limits<double>::quiet_NaN());
                }
            }
        }
    }
}

/// Samples of an axis after reduction; an extent keeps its two ends. No more than a box's axis would have, by
/// which it is judged whether a reduction fits.
int reduced_count(int count, int factor, bool ring) {
    if (count == 1) {
        return 1;
    }
    return ring ? std::max(1, (count + factor / 2) / factor) : std::max(1, (count - 1) / factor) + 1;
}

}  // namespace

Volume reduced_curvilinear(const Volume& volume, int factor, bool labels) {
    Volume result{.grid = volume.grid,
                  .type = volume.type,
                  .channels = volume.channels,
                  .voxels = {},
                  .slope = volume.slope,
                  .intercept = volume.intercept,
                  .unit = volume.unit,
                  .narrowing_error = volume.narrowing_error,
                  .source = volume.source};
    std::array<std::vector<Window>, 3> windows;
    for (int axis = 0; axis < 3; ++axis) {
        const int from = volume.grid.dims[axis];
        const bool ring = axis == volume.grid.shape.wrap_axis();
        const int to = reduced_count(from, factor, ring);
        windows[static_cast<std::size_t>(axis)] = windows_of(from, to, ring, labels);
        result.grid.dims[axis] = to;
        result.grid.spacing_mm[axis] *= static_cast<double>(from) / to;
    }
    result.voxels.resize(result.grid.voxel_count() * static_cast<std::size_t>(result.channels) *
                         bytes_of(result.type));
    switch (volume.type) {
        case ScalarType::u8:
            resample<std::uint8_t>(volume, windows, result);
            break;
        case ScalarType::i8:
            resample<std::int8_t>(volume, windows, result);
            break;
        case ScalarType::u16:
            resample<std::uint16_t>(volume, windows, result);
            break;
        case ScalarType::i16:
            resample<std::int16_t>(volume, windows, result);
            break;
        case ScalarType::f32:
            resample<float>(volume, windows, result);
            break;
    }
    return result;
}

}  // namespace viscera
