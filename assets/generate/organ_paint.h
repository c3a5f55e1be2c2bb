#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/organ_field.h"
#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// Red, green, blue and alpha in [0, 1], bottom row first.
struct ColourImage {
    int width = 0;
    int height = 0;
    std::vector<glm::vec4> pixels;

    ColourImage(int w, int h, const glm::vec4& fill)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
};

/// Where a texel lies on a surface.
struct PaintPoint {
    glm::dvec3 place{0.0};    ///< [mm]
    glm::dvec3 normal{0.0};   ///< unit length
    glm::dvec3 along_u{0.0};  ///< unit vectors in which u and v rise
    glm::dvec3 along_v{0.0};
};

/// Calls paint for every texel of a mesh's atlas, a few beyond each chart's border included, and fills what
/// is left with the mean colour.
[[nodiscard]] ColourImage paint_atlas(const MeshData& mesh, int size,
                                      const std::function<glm::vec4(const PaintPoint&)>& paint);

/// What organs look like, from noise in space: no seam shows.
class OrganPaint {
  public:
    OrganPaint(const OrganField& field, std::uint64_t seed);

    /// Colour as a monitor shows it.
    [[nodiscard]] glm::vec4 colour(const PaintPoint& point) const;
    /// Tangent-space normal of the fine relief as 8-bit colour: 128 is 0.
    [[nodiscard]] glm::vec4 normal(const PaintPoint& point) const;
    /// The line along which the gallbladder is to be cut loose.
    [[nodiscard]] glm::vec4 hint(const PaintPoint& point) const;
    /// What a cut looks like; alpha 1 along one on the front of the right lobe.
    [[nodiscard]] glm::vec4 cut(const PaintPoint& point) const;

    /// Ends of that cut.
    [[nodiscard]] const std::array<glm::dvec3, 2>& cut_line() const { return cut_line_; }

    /// Height of that relief [mm].
    [[nodiscard]] double relief(const PaintPoint& point) const {
        return relief(point.place, field_.tissue(point.place));
    }

  private:
    [[nodiscard]] double relief(const glm::dvec3& place, const OrganTissue& tissue) const;

    const OrganField& field_;
    std::uint32_t seed_;
    std::array<glm::dvec3, 2> cut_line_;
    glm::dvec3 cut_aside_;  ///< across the cut, in the surface
};

/// Peritoneum over the muscles of the wall.
[[nodiscard]] glm::vec4 abdomen_colour(const PaintPoint& point, std::uint64_t seed);
[[nodiscard]] glm::vec4 abdomen_normal(const PaintPoint& point, std::uint64_t seed);

}  // namespace viscera::assets
