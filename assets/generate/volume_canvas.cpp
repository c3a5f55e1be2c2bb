#include "assets/generate/volume_canvas.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "assets/generate/noise.h"

namespace viscera::assets {
namespace {

constexpr double warp_feature_mm = 70.0;
constexpr double warp_mm = 2.0;

template <typename T>
Volume volume_of(const VolumeGrid& grid, ScalarType type, const std::vector<T>& values) {
    Volume volume;
    volume.grid = grid;
    volume.type = type;
    volume.voxels.resize(values.size() * sizeof(T));
    std::memcpy(volume.voxels.data(), values.data(), volume.voxels.size());
    return volume;
}

template <typename T>
std::vector<T> rounded_to(const std::vector<float>& values) {
    std::vector<T> rounded(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        rounded[i] =
            static_cast<T>(std::clamp(std::floor(values[i] + 0.5F), float{std::numeric_limits<T>::min()},
                                      float{std::numeric_limits<T>::max()}));
    }
    return rounded;
}

std::uint32_t scrambled(std::uint32_t h) {
    h ^= h >> 16;
    h *= 0x7feb352dU;
    h ^= h >> 15;
    h *= 0x846ca68bU;
    return h ^ (h >> 16);
}

}  // namespace

Canvas::Canvas(const VolumeGrid& grid, float background, std::uint64_t seed)
    : grid_(grid),
      dims_(grid.dims),
      edge_mm_(static_cast<float>((grid.spacing_mm.x + grid.spacing_mm.y + grid.spacing_mm.z) / 3.0)),
      block_reach_(glm::vec3(grid.spacing_mm) * (0.5F * block_size) + static_cast<float>(warp_mm)),
      warp_dims_(dims_ / block_size + 2) {
    const std::size_t count = static_cast<std::size_t>(dims_.x) * static_cast<std::size_t>(dims_.y) *
                              static_cast<std::size_t>(dims_.z);
    values_.assign(count, background);
    labels_.assign(count, 0);
    for (int z = 0; z < warp_dims_.z; ++z) {
        for (int y = 0; y < warp_dims_.y; ++y) {
            for (int x = 0; x < warp_dims_.x; ++x) {
                const glm::dvec3 p = grid.origin_mm + grid.spacing_mm * (static_cast<double>(block_size) *
                                                                         glm::dvec3(x, y, z));
                warp_.emplace_back(
                    warp_mm * fractal_warp(p / warp_feature_mm, 2, static_cast<std::uint32_t>(seed) + 17U));
            }
        }
    }
}

glm::vec3 Canvas::position(const glm::ivec3& voxel) const {
    const glm::vec3 in_blocks = glm::vec3(voxel) / static_cast<float>(block_size);
    const glm::ivec3 block = voxel / block_size;
    const glm::vec3 f = in_blocks - glm::vec3(block);
    const auto corner = [&](int y, int z) {
        const std::size_t at =
            static_cast<std::size_t>(block.x + warp_dims_.x * (block.y + y + warp_dims_.y * (block.z + z)));
        return warp_[at] + f.x * (warp_[at + 1] - warp_[at]);
    };
    const glm::vec3 below = corner(0, 0) + f.y * (corner(1, 0) - corner(0, 0));
    const glm::vec3 above = corner(0, 1) + f.y * (corner(1, 1) - corner(0, 1));
    return glm::vec3(grid_.origin_mm) + glm::vec3(grid_.spacing_mm) * glm::vec3(voxel) + below +
           f.z * (above - below);
}

void Canvas::blur(double sigma_mm) {
    std::size_t stride = 1;
    std::vector<float> row;
    for (int axis = 0; axis < 3; ++axis) {
        const auto length = static_cast<std::size_t>(dims_[axis]);
        const double voxels = sigma_mm / grid_.spacing_mm[axis];
        const auto beside = static_cast<float>(0.5 * voxels * voxels);
        const float middle = 1.0F - 2.0F * beside;
        row.resize(length + 2);
        for (std::size_t first = 0; first < values_.size(); ++first) {
            if ((first / stride) % length != 0) {
                continue;
            }
            for (std::size_t i = 0; i < length; ++i) {
                row[i + 1] = values_[first + i * stride];
            }
            row.front() = row[1];
            row.back() = row[length];
            for (std::size_t i = 0; i < length; ++i) {
                values_[first + i * stride] = beside * (row[i] + row[i + 2]) + middle * row[i + 1];
            }
        }
        stride *= length;
    }
}

void Canvas::add_noise(float sigma, std::uint32_t seed) {
    // Four bytes add up to a mean of 510 with variance 4 (256^2 - 1) / 12.
    const float scale = sigma / std::sqrt(4.0F * 65535.0F / 12.0F);
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const std::uint32_t h = scrambled(static_cast<std::uint32_t>(i) + scrambled(seed));
        const std::uint32_t sum = (h & 255U) + ((h >> 8U) & 255U) + ((h >> 16U) & 255U) + (h >> 24U);
        values_[i] += scale * (static_cast<float>(sum) - 510.0F);
    }
}

Volume Canvas::values(ScalarType type) const {
    switch (type) {
        case ScalarType::i16:
            return volume_of(grid_, type, rounded_to<std::int16_t>(values_));
        case ScalarType::u16:
            return volume_of(grid_, type, rounded_to<std::uint16_t>(values_));
        default:
            return volume_of(grid_, ScalarType::f32, values_);
    }
}

Volume Canvas::labels() const {
    return volume_of(grid_, ScalarType::u8, labels_);
}

}  // namespace viscera::assets
