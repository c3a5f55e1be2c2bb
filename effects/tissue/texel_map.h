#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/progress.h"

namespace viscera {
class Assets;
class SurfaceMesh;
}  // namespace viscera

namespace viscera::tissue {

/// Texels around each chart that name where the surface goes on.
inline constexpr int gutter_texels = 5;
/// What reads across seams counts on so many.
inline constexpr int least_gutter = 4;

/// Which point of a surface a texel stands for, as the bake's shader reads it from an RGBA32F texture: on a
/// triangle, at the weights (1 - b1 - b2, b1, b2) of its corners.
struct TexelPoint {
    float triangle = 0.0F;  ///< i; -(i + 1): the surface ends at the chart's border, and this is the border
    float b1 = 0.0F;
    float b2 = 0.0F;
    /// 0: the texel stands for nothing. i + 1: it lies in triangle i. -(i + 1): it lies in the gutter beside
    /// triangle i, whose map continues there.
    float owner = 0.0F;
};

/// What was found while a map was made.
struct TexelMapFaults {
    std::uint64_t overlapping_texels = 0;  ///< that more than one triangle covers; the first one has them
    std::uint64_t flat_triangles = 0;      ///< without area in the texture: nothing can be painted on them
    std::uint64_t huge_triangles = 0;      ///< that span more than 4 textures, left out
    std::uint64_t non_manifold_edges = 0;  ///< where seams end, since more than two triangles meet
    std::uint64_t mirrored_triangles = 0;  ///< clockwise in the texture; harmless
    std::uint64_t narrow_texels = 0;       ///< within least_gutter texels of two charts
};

struct TexelMap {
    int size = 0;                    ///< texels along each side
    std::vector<TexelPoint> texels;  ///< size * size, the bottom row first
    TexelMapFaults faults;
};

/// What a map is made of. All of it stays as it is while a host moves the surface.
struct TexelSurface {
    std::span<const glm::vec3> positions;  ///< in any unit: gutters go by this shape
    std::span<const glm::vec2> uvs;
    std::span<const std::uint32_t> indices;
    std::span<const std::uint32_t> place;  ///< per vertex the vertex that stands for its place
};

/// Of a mesh, in the file's shape.
[[nodiscard]] TexelSurface texel_surface(const SurfaceMesh& mesh);

/// Every texel whose centre lies in a triangle, and gutter_texels around each chart, unless they lie in
/// another one. Texture coordinates beyond [0, 1] repeat. Triangle numbers must be below 2^24. Throws
/// Error(usage) when cancelled.
[[nodiscard]] TexelMap make_texel_map(const TexelSurface& surface, int size, const Progress& progress = {});

/// Of a mesh, found once for all passes that paint on it at this size, or kept in the disk cache by an
/// earlier run. `where` names the mesh for whoever waits.
[[nodiscard]] std::shared_ptr<const TexelMap> shared_texel_map(Assets& assets, const SurfaceMesh& mesh,
                                                               int size, const std::string& where);

}  // namespace viscera::tissue
