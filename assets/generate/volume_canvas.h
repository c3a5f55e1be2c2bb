#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/volume.h"

namespace viscera::assets {

/// Part of the patient [mm].
struct PaintedBox {
    glm::vec3 low{-1e4F};
    glm::vec3 high{1e4F};
};

/// Values and labels of a volume that bodies are painted into, one over the other, each with an edge one
/// voxel wide. The patient is a little crooked: what is painted at p shows up to 2 mm beside it.
class Canvas {
  public:
    /// Axes along the world's. Starts as `background` with label 0.
    Canvas(const VolumeGrid& grid, float background, std::uint64_t seed);

    /// Paints where distance(p) < 0 (half-way at 0) what value(p, distance) tells. Blocks of voxels that
    /// the distance shows to be far outside are passed over: it may be wrong by 40 %, not more.
    template <typename Distance, typename Value>
    void paint(const PaintedBox& bounds, std::uint8_t label, const Distance& distance, const Value& value) {
        glm::ivec3 block;
        for (block.z = 0; block.z < dims_.z; block.z += block_size) {
            for (block.y = 0; block.y < dims_.y; block.y += block_size) {
                for (block.x = 0; block.x < dims_.x; block.x += block_size) {
                    const glm::vec3 middle = position(block + block_size / 2);
                    const glm::vec3 reach = block_reach_;
                    if (glm::any(glm::lessThan(middle + reach, bounds.low)) ||
                        glm::any(glm::greaterThan(middle - reach, bounds.high)) ||
                        distance(middle) > 1.7F * glm::length(reach)) {
                        continue;
                    }
                    paint_block(block, label, distance, value);
                }
            }
        }
    }
    template <typename Distance>
    void paint(const PaintedBox& bounds, std::uint8_t label, const Distance& distance, float value) {
        paint(bounds, label, distance, [value](const glm::vec3&, float) { return value; });
    }

    /// Multiplies each voxel by factor(p).
    template <typename Factor>
    void scale(const Factor& factor) {
        std::size_t i = 0;
        glm::ivec3 v;
        for (v.z = 0; v.z < dims_.z; ++v.z) {
            for (v.y = 0; v.y < dims_.y; ++v.y) {
                for (v.x = 0; v.x < dims_.x; ++v.x) {
                    values_[i++] *= factor(position(v));
                }
            }
        }
    }

    /// What a scanner's point spread leaves, by its standard deviation: at most 0.7 voxels on each axis.
    /// Three weights of that variance; border voxels count as going on outside.
    void blur(double sigma_mm);

    /// Adds noise of a normal-like distribution to each voxel; sum of four uniform numbers.
    void add_noise(float sigma, std::uint32_t seed);

    [[nodiscard]] Volume values(ScalarType type) const;  ///< i16 or u16, rounded; f32 as they are
    [[nodiscard]] Volume labels() const;
    [[nodiscard]] const VolumeGrid& grid() const { return grid_; }
    /// Where the patient is at a voxel [mm].
    [[nodiscard]] glm::vec3 position(const glm::ivec3& voxel) const;

  private:
    static constexpr int block_size = 8;

    template <typename Distance, typename Value>
    void paint_block(const glm::ivec3& first, std::uint8_t label, const Distance& distance,
                     const Value& value) {
        const glm::ivec3 end = glm::min(first + block_size, dims_);
        glm::ivec3 v;
        for (v.z = first.z; v.z < end.z; ++v.z) {
            for (v.y = first.y; v.y < end.y; ++v.y) {
                for (v.x = first.x; v.x < end.x; ++v.x) {
                    const glm::vec3 p = position(v);
                    const float d = distance(p);
                    const float cover = std::clamp(0.5F - d / edge_mm_, 0.0F, 1.0F);
                    if (cover > 0.0F) {
                        const std::size_t i = index(v);
                        values_[i] += cover * (value(p, d) - values_[i]);
                        labels_[i] = cover >= 0.5F ? label : labels_[i];
                    }
                }
            }
        }
    }
    [[nodiscard]] std::size_t index(const glm::ivec3& v) const {
        return static_cast<std::size_t>(v.x) +
               static_cast<std::size_t>(dims_.x) *
                   (static_cast<std::size_t>(v.y) +
                    static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(v.z));
    }

    VolumeGrid grid_;
    glm::ivec3 dims_;
    float edge_mm_;
    glm::vec3 block_reach_;
    glm::ivec3 warp_dims_;
    std::vector<glm::vec3> warp_;  ///< displacement at the corners of the blocks
    std::vector<float> values_;
    std::vector<std::uint8_t> labels_;
};

}  // namespace viscera::assets
