#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/seam_links.h"

namespace viscera::tissue {

/// Squares of texels across seams, by the square that they reach, as shaders read them: four numbers to an
/// item of RGBA32F. The last item of a square is filled up with one of its own numbers.
struct SeamReach {
    std::vector<glm::vec4> items;
    std::vector<glm::vec2> first;  ///< by square, row by row: where its items begin, and how many they are
};

/// A grid of squares over a texture.
struct SquareGrid {
    int size = 0;  ///< of the texture [texels]
    int side = 0;  ///< of a square [texels]

    [[nodiscard]] int count() const { return (size + side - 1) / side; }  ///< along each side
    /// The square of a texel, both row by row, `off` texels away, but on the texture.
    [[nodiscard]] int square_of(int texel, const glm::ivec2& off = glm::ivec2(0)) const;
};

/// Of each square those beside a square across a seam from it or from one beside it; numbers are x + (y <<
/// 9).
[[nodiscard]] SeamReach reach_beside_seams(const SquareGrid& grid, std::span<const SeamLink> links,
                                           std::span<const SeamJump> jumps);

/// What a square across a seam does to another one: as glsl/tissue/blood_across.frag. Of the two ways in
/// which blood comes only the lower is kept, which needs less.
enum ReachKind { reach_from_where_it_lies = 1, reach_from_where_it_runs_far = 2, reach_of_gutters = 4 };

/// Of each square those from which blood may come into it, no farther than `past_seam` [texels] beyond where
/// links and gutters lead, and those that its gutters show; numbers are kind + (x << 3) + (y << 12).
[[nodiscard]] SeamReach reach_across_seams(const SquareGrid& grid, int past_seam,
                                           std::span<const SeamLink> links, std::span<const SeamJump> jumps);

}  // namespace viscera::tissue
