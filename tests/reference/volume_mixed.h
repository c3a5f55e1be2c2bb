#pragma once

#include <functional>
#include <optional>

#include <glm/glm.hpp>

#include "engine/core/image.h"

namespace viscera::reference {

/// Filling in of a picture in mixed resolution, in double precision and from its definition: cubic Lagrange
/// interpolation between the pixels whose rays the coarse picture holds.
class MixedPicture {
  public:
    /// `lattice`: size of the full picture [pixels]. `depth`: of surfaces, as large; null: there are none.
    MixedPicture(const Image& coarse, glm::ivec2 lattice, const Image* depth)
        : coarse_(coarse), lattice_(lattice), depth_(depth) {}

    static constexpr int tile_size = 4;  ///< [pixels]

    struct Filled {
        glm::dvec4 colour{0.0};  ///< not limited to [0, 1]
        /// Of the pixel's depth against the cubic and the line between those of the coarse picture's pixels,
        /// and against the mean of its neighbours on either side, in depth units.
        double depth_gap = 0.0;
        bool copied = false;  ///< the pixel is one of the coarse picture's
    };
    /// None outside the pixels that the coarse picture has.
    [[nodiscard]] std::optional<Filled> at(int x, int y) const;

    /// How much the coarse picture bends, at most, at the texels about the pixels of a tile: the amounts of
    /// the second differences along rows and columns, over 8. `x`, `y`: of the tile.
    [[nodiscard]] double bend(int x, int y) const;

    /// The pixel of a texel along one axis of n texels and `lines` pixels: the one whose area holds the
    /// texel's middle.
    [[nodiscard]] static int line_of(int texel, int n, int lines);

  private:
    const Image& coarse_;
    glm::ivec2 lattice_;
    const Image* depth_;
};

}  // namespace viscera::reference
