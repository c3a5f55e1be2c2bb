#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/core/volume.h"
#include "engine/core/volume_reduce_curvilinear.h"

namespace viscera {

namespace {

/// Lengths of an array whose first axis holds the channels of a voxel.
struct Extent {
    std::size_t channels;
    std::size_t x;
    std::size_t y;
    std::size_t z;
};

Extent extent_of(const Volume& volume) {
    return {static_cast<std::size_t>(volume.channels), static_cast<std::size_t>(volume.grid.dims.x),
            static_cast<std::size_t>(volume.grid.dims.y), static_cast<std::size_t>(volume.grid.dims.z)};
}

/// Sums of the voxels that become one row of the result; voxels that are not finite count as absent.
struct RowSums {
    std::vector<double> sum;
    std::vector<std::uint32_t> count;

    explicit RowSums(std::size_t size) : sum(size), count(size) {}
    void clear() {
        std::ranges::fill(sum, 0.0);
        std::ranges::fill(count, 0U);
    }
};

template <class T>
void add_row(const T* row, const Extent& from, std::size_t factor, RowSums& sums) {
    for (std::size_t x = 0, out = 0; x < from.x; x += factor, ++out) {
        const std::size_t end = std::min(x + factor, from.x);
        for (std::size_t i = x; i < end; ++i) {
            for (std::size_t c = 0; c < from.channels; ++c) {
                const auto value = static_cast<double>(row[i * from.channels + c]);
                if (is_number(value)) {
                    sums.sum[out * from.channels + c] += value;
                    ++sums.count[out * from.channels + c];
                }
            }
        }
    }
}

template <class T>
T mean_of(double sum, std::uint32_t count) {
    if constexpr (std::is_floating_point_v<T>) {
        return count > 0 ? static_cast<T>(sum / count) : std::numeric_limits<T>::quiet_NaN();
    } else {
        return static_cast<T>(std::lround(sum / count));
    }
}

template <class T>
void average(const Volume& volume, const glm::ivec3& factor, Volume& result) {
    const Extent from = extent_of(volume);
    const Extent to = extent_of(result);
    const auto* const in = reinterpret_cast<const T*>(volume.voxels.data());
    auto* out = reinterpret_cast<T*>(result.voxels.data());
    const glm::u64vec3 step(factor);
    RowSums sums(to.x * to.channels);
    for (std::size_t z = 0; z < to.z; ++z) {
        for (std::size_t y = 0; y < to.y; ++y) {
            sums.clear();
            for (std::size_t k = z * step.z; k < std::min((z + 1) * step.z, from.z); ++k) {
                for (std::size_t j = y * step.y; j < std::min((y + 1) * step.y, from.y); ++j) {
                    add_row(in + (k * from.y + j) * from.x * from.channels, from, step.x, sums);
                }
            }
            out = std::ranges::transform(sums.sum, sums.count, out, mean_of<T>).out;
        }
    }
}

void take_first(const Volume& volume, const glm::ivec3& factor, Volume& result) {
    const std::size_t voxel_bytes = bytes_of(volume.type) * static_cast<std::size_t>(volume.channels);
    const Extent from = extent_of(volume);
    const Extent to = extent_of(result);
    const glm::u64vec3 step(factor);
    std::byte* out = result.voxels.data();
    for (std::size_t z = 0; z < to.z; ++z) {
        for (std::size_t y = 0; y < to.y; ++y) {
            const std::byte* const row =
                volume.voxels.data() + (z * step.z * from.y + y * step.y) * from.x * voxel_bytes;
            for (std::size_t x = 0; x < to.x; ++x, out += voxel_bytes) {
                std::memcpy(out, row + x * step.x * voxel_bytes, voxel_bytes);
            }
        }
    }
}

/// Everything of the result but its voxels.
Volume make_result(const Volume& volume, const glm::ivec3& factor, bool labels) {
    Volume result;
    result.grid = volume.grid;
    result.grid.dims = (volume.grid.dims + factor - 1) / factor;
    result.grid.spacing_mm = volume.grid.spacing_mm * glm::dvec3(factor);
    if (!labels) {
        const glm::dvec3 middle = 0.5 * glm::dvec3(factor - 1) * volume.grid.spacing_mm;
        result.grid.origin_mm += volume.grid.direction * middle;
    }
    result.type = volume.type;
    result.channels = volume.channels;
    result.slope = volume.slope;
    result.intercept = volume.intercept;
    result.unit = volume.unit;
    result.narrowing_error = volume.narrowing_error;
    result.source = volume.source;
    result.voxels.resize(result.grid.voxel_count() * static_cast<std::size_t>(result.channels) *
                         bytes_of(result.type));
    return result;
}

}  // namespace

Volume reduced(const Volume& volume, int factor, bool labels) {
    if (factor <= 1) {
        return volume;
    }
    if (volume.grid.curvilinear()) {
        return reduced_curvilinear(volume, factor, labels);
    }
    // An axis shorter than the factor becomes one voxel of its own length, no longer.
    const glm::ivec3 factors = glm::min(glm::ivec3(factor), volume.grid.dims);
    Volume result = make_result(volume, factors, labels);
    if (labels) {
        take_first(volume, factors, result);
        return result;
    }
    switch (volume.type) {
        case ScalarType::u8:
            average<std::uint8_t>(volume, factors, result);
            break;
        case ScalarType::i8:
            average<std::int8_t>(volume, factors, result);
            break;
        case ScalarType::u16:
            average<std::uint16_t>(volume, factors, result);
            break;
        case ScalarType::i16:
            average<std::int16_t>(volume, factors, result);
            break;
        case ScalarType::f32:
            average<float>(volume, factors, result);
            break;
    }
    return result;
}

}  // namespace viscera
