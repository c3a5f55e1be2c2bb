#include "effects/volume/atlas.h"

#include <algorithm>
#include <array>

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 3> storage_names{"automatic", "texture_3d", "atlas"};
constexpr int fine_side = 256;

int divide_up(int n, int by) {
    return (n - 1) / by + 1;
}

}  // namespace

std::span<const std::string_view> choice_names(Storage) {
    return storage_names;
}

glm::ivec3 AtlasLayout::place_of(int slice) const {
    const int row = slice / tiles.x;
    return {(slice % tiles.x) * tile().x + border, (row % tiles.y) * tile().y + border, row / tiles.y};
}

std::optional<AtlasLayout> lay_out(const glm::ivec3& dims, int max_side, int max_layers) {
    AtlasLayout layout{.dims = dims};
    const glm::ivec2 tile = layout.tile();
    const int largest = std::max(tile.x, tile.y);
    if (largest > max_side) {
        return std::nullopt;
    }
    for (int side = std::min(std::max(largest, fine_side), max_side);; side = std::min(2 * side, max_side)) {
        layout.tiles = side / tile;
        layout.tiles.x = std::min(layout.tiles.x, dims.z);
        layout.tiles.y = std::min(layout.tiles.y, divide_up(dims.z, layout.tiles.x));
        layout.layers = divide_up(dims.z, layout.tiles.x * layout.tiles.y);
        if (layout.layers <= max_layers) {
            return layout;
        }
        if (side == max_side) {
            return std::nullopt;
        }
    }
}

}  // namespace viscera::volume
