#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include <glm/glm.hpp>

namespace viscera::reference {

struct RasterOptions {
    int width = 1;   ///< [pixels]
    int height = 1;  ///< [pixels]
    /// Vertices are snapped to 1 / 2^snap_bits of a pixel before coverage is decided, as GPUs do (8 is
    /// usual); negative: not at all. Attributes always come from the unsnapped triangle.
    int snap_bits = -1;
};

/// One pixel centre that a triangle covers.
struct Fragment {
    int x = 0;
    int y = 0;
    std::uint32_t triangle = 0;
    std::array<std::uint32_t, 3> vertices{};
    glm::dvec3 weights{0.0};  ///< perspective-correct, of the three vertices; their sum is 1
    double depth = 0.0;       ///< in [0, 1]

    /// A vertex attribute at this fragment.
    template <class Values>
    [[nodiscard]] auto interpolate(const Values& values) const {
        return values[vertices[0]] * weights[0] + values[vertices[1]] * weights[1] +
               values[vertices[2]] * weights[2];
    }
};

/// Rasterises triangles as OpenGL does: clipped against near and far plane, pixel centres, top-left rule,
/// both orientations alike. Calls visit for each fragment, triangle by triangle.
/// view_projection takes positions to OpenGL clip space. Triangles with a vertex that is not finite are left
/// out.
void rasterise(std::span<const glm::dvec3> positions, std::span<const std::uint32_t> indices,
               const glm::dmat4& view_projection, const RasterOptions& options,
               const std::function<void(const Fragment&)>& visit);

}  // namespace viscera::reference
