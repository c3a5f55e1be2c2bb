#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

namespace viscera::volume {

/// automatic: a 3-D texture unless the volume exceeds what the device allows.
enum class Storage { automatic, texture_3d, atlas };
[[nodiscard]] std::span<const std::string_view> choice_names(Storage storage);

/// The slices of a volume side by side on the layers of an array of 2-D textures, each with a border of one
/// texel that repeats its edge, so that filtering in the slice takes nothing from its neighbours.
struct AtlasLayout {
    static constexpr int border = 1;  ///< [texels]

    glm::ivec3 dims{1};   ///< of the volume [voxels]
    glm::ivec2 tiles{1};  ///< slices beside and above each other on a layer
    int layers = 1;

    /// Width and height of a layer [texels].
    [[nodiscard]] glm::ivec2 page() const { return tiles * tile(); }
    /// Size of a slice with its border [texels].
    [[nodiscard]] glm::ivec2 tile() const { return glm::ivec2(dims) + 2 * border; }
    /// First texel of a slice behind its border, and its layer.
    [[nodiscard]] glm::ivec3 place_of(int slice) const;
};

/// A layout within the device's limits; none when a slice is too large or there are too many. Layers are at
/// most 256 texels wide and high where slices and their number allow it: single precision places samples the
/// more finely the smaller layers are.
[[nodiscard]] std::optional<AtlasLayout> lay_out(const glm::ivec3& dims, int max_side, int max_layers);

}  // namespace viscera::volume
