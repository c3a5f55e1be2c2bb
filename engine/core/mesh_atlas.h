#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/progress.h"

namespace viscera {

/// Gaps between charts in a made atlas: 2 gutters of 4 texels and one to spare, of a texture this wide.
inline constexpr int atlas_texels = 512;
inline constexpr double atlas_gap = 9.0 / atlas_texels;

/// Places of a surface in texture space, no two of which coincide.
struct MeshAtlas {
    std::vector<std::uint32_t> indices;  ///< the mesh's triangles, in their order
    std::vector<std::uint32_t> origin;   ///< vertices beyond the mesh's own: which of these each repeats
    std::vector<glm::vec2> uvs;          ///< one per vertex, in [0, 1]
    std::size_t charts = 0;
    double scale = 0.0;         ///< texture widths per unit of length, the same for all charts
    double coverage = 0.0;      ///< share of the texture that charts cover
    double mean_stretch = 1.0;  ///< longest over shortest texel step, mean over the area
    double most_stretch = 1.0;  ///< of any triangle
};

/// An atlas of planar charts for a mesh without usable texture coordinates. `place`: per vertex the vertex
/// that stands for its place. The result depends on the shape alone, not on its size: for lengths times a
/// power of 2 it is the same to the bit. Throws Error(usage) when cancelled.
[[nodiscard]] MeshAtlas make_atlas(std::span<const glm::vec3> positions,
                                   std::span<const std::uint32_t> indices,
                                   std::span<const std::uint32_t> place, const Progress& progress = {});

/// How texture coordinates use a texture.
struct UvUse {
    double covered = 0.0;  ///< share of the texture that triangles cover, on a grid of 512 x 512
    double overlap = 0.0;  ///< share of that which more than one triangle covers
    double flat = 0.0;     ///< share of the triangles that have no area in the texture
    bool beyond = false;   ///< some coordinates lie outside [0, 1]
};
/// Coordinates beyond [0, 1] repeat.
[[nodiscard]] UvUse measure_uvs(std::span<const glm::vec2> uvs, std::span<const std::uint32_t> indices);

}  // namespace viscera
