#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace viscera::reference {

/// A surface in texture space as tissue.bake describes it, x fastest, bottom row first.
struct TissueSurface {
    enum class Texel : std::uint8_t { nothing, open_gutter, gutter, cell };
    int width = 0;
    int height = 0;
    std::vector<Texel> kind;
    std::vector<glm::dvec3> position;  ///< [mm]
    std::vector<glm::dvec3> normal;    ///< unit
    std::vector<glm::dvec4> metric;    ///< mm per texel in u, in v, cosine between them, mm^2
    std::vector<glm::dvec2> seam;      ///< UV where the surface goes on
    std::vector<double> lift;          ///< of the relief, times its pull [mm]; empty: flat

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] Texel at(int x, int y) const {
        return x < 0 || y < 0 || x >= width || y >= height ? Texel::nothing : kind[index(x, y)];
    }
};

/// What drives a film through the face between a texel and its right or upper neighbour: positive to the
/// right and up.
struct FlowFace {
    double spread = 0.0;    ///< conductance times the normal's upward part
    double skew = 0.0;      ///< the same for the slope along the face
    double drive = 0.0;     ///< of gravity along the surface [mm]
    double area_mm2 = 0.0;  ///< the smaller cell's, times 4 times the face's share; 0: closed
};

/// A part of a seam: what flows between a cell and one across it, as if they were neighbours.
struct FlowLink {
    std::size_t from = 0;
    std::size_t to = 0;
    double spread = 0.0;
    double drive = 0.0;
    double area_mm2 = 0.0;
};

struct Flow {
    std::vector<FlowFace> right;
    std::vector<FlowFace> top;
    std::vector<double> area_mm2;  ///< of cells; 0 for other texels
    std::vector<FlowLink> links;
};

/// `gravity`: in units of standard gravity; `spreading`: least share of gravity that levels a film;
/// `open_edges`: film runs off open borders.
[[nodiscard]] Flow flow_of(const TissueSurface& surface, const glm::dvec3& gravity, double spreading,
                           bool open_edges);

struct FilmParams {
    double mobility_per_mm_s = 2600.0;  ///< density times standard gravity over viscosity [1/(mm s)]
    double residual_mm = 0.0;           ///< what stays behind
    double pinning_mm = 0.0;            ///< over that, from which on dry cells are wetted
    double drying_mm_s = 0.0;
};

/// A film of liquid on a surface, in finite volumes.
struct Film {
    std::vector<double> height_mm;
    std::vector<double> owed_mm;  ///< came across seams in the last step, joins the height in the next
    std::vector<double> gone_mm;  ///< run off or dried, per cell

    explicit Film(std::size_t cells) : height_mm(cells, 0.0), owed_mm(cells, 0.0), gone_mm(cells, 0.0) {}
    void step(const TissueSurface& surface, const Flow& flow, const FilmParams& params, double dt_s);
    [[nodiscard]] double volume_mm3(const Flow& flow) const;
    [[nodiscard]] double gone_mm3(const Flow& flow) const;
};

}  // namespace viscera::reference
