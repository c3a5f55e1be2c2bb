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

    struct Filled {
        glm::dvec4 colour{0.0};   ///< not limited to [0, 1]
        /// How much the coarse picture bends here: the second differences at the two texels between which the
        /// pixel lies, their amounts added, along rows and along columns, over 16. As large as the gap of
        /// cubic and line where both have one sign.
        double bend = 0.0;
        double depth_gap = 0.0;   ///< of the pixel's depth against both, in depth units
        bool copied = false;      ///< the pixel is one of the coarse picture's
    };
    /// None outside the pixels that the coarse picture has.
    [[nodiscard]] std::optional<Filled> at(int x, int y) const;

    /// The pixel of a texel along one axis of n texels and `lines` pixels: the one whose area holds the
    /// texel's middle.
    [[nodiscard]] static int line_of(int texel, int n, int lines);

  private:
    const Image& coarse_;
    glm::ivec2 lattice_;
    const Image* depth_;
};

}  // namespace viscera::reference
