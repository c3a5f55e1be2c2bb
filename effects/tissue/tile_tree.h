#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/texel_map.h"

namespace viscera::tissue {

/// Which part of a texture may lie near a place: tiles of 16 x 16 texels, with a box around all the places
/// that the texels of each stand for, gutters included, and boxes around boxes above them.
class TileTree {
  public:
    static constexpr int tile_texels = 16;

    /// The places are the texels' own UV: (u, v, 0).
    explicit TileTree(int size);
    /// Of a surface; place() before it is asked.
    explicit TileTree(const std::shared_ptr<const TexelMap>& map);

    /// New positions of the vertices [mm in the world] of the mesh that the map is of. Cheap enough for every
    /// frame; allocates nothing.
    void place(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

    [[nodiscard]] int size() const { return size_; }  ///< texels along each side
    [[nodiscard]] int tiles_per_side() const { return side_; }

    /// Appends the tiles (y * tiles_per_side() + x) of which a texel may lie within `radius` of the way from
    /// a to b, each once, in no particular order.
    void near(const glm::dvec3& a, const glm::dvec3& b, double radius, std::vector<std::uint32_t>& tiles);

    /// Whether a tile has texels of a marked triangle. `marked`: by triangle.
    [[nodiscard]] bool holds_any(std::uint32_t tile, std::span<const char> marked) const;

  private:
    struct Box {
        glm::vec3 low{1.0F};
        glm::vec3 high{-1.0F};  ///< below `low`: nothing is in it
        [[nodiscard]] bool empty() const { return high.x < low.x; }
        void add(const Box& other);
    };
    struct Level {
        int side = 0;
        std::vector<Box> boxes;
    };
    /// The texels of a tile that lie on one triangle: the range of their weights.
    struct Share {
        std::uint32_t triangle = 0;
        glm::vec2 low{0.0F};
        glm::vec2 high{0.0F};
    };
    void make_levels();
    void merge_levels();
    void find_shares(const TexelMap& map);
    void visit(std::size_t level, int x, int y, const glm::dvec3& centre, double radius,
               std::vector<std::uint32_t>& tiles);

    int size_ = 0;
    int side_ = 0;
    std::vector<Level> levels_;  ///< tiles first, one box last
    std::vector<Share> shares_;
    std::vector<std::uint32_t> first_share_;  ///< by tile, and the end
    std::vector<std::uint32_t> seen_;         ///< by tile: number of the question that found it last
    std::uint32_t question_ = 0;
};

}  // namespace viscera::tissue
