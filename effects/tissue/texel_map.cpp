#include "effects/tissue/texel_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace viscera::tissue {
namespace {

double cross2(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

class Rasteriser {
  public:
    Rasteriser(const MeshData& mesh, TexelMap& map) : mesh_(mesh), map_(map) {}

    void add(std::size_t triangle) {
        std::array<glm::dvec2, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] =
                static_cast<double>(map_.size) * glm::dvec2(mesh_.uvs[mesh_.indices[3 * triangle + k]]);
        }
        const glm::dvec2 e1 = corner[1] - corner[0];
        const glm::dvec2 e2 = corner[2] - corner[0];
        const double area = cross2(e1, e2);
        if (!(std::abs(area) > 0.0)) {
            return;
        }
        const glm::dvec2 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
        const glm::dvec2 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
        const auto first = [](double x) { return static_cast<int>(std::ceil(x - 0.5)); };
        const auto last = [](double x) { return static_cast<int>(std::floor(x - 0.5)); };
        for (int y = first(low.y); y <= last(high.y); ++y) {
            for (int x = first(low.x); x <= last(high.x); ++x) {
                const glm::dvec2 q = glm::dvec2(x + 0.5, y + 0.5) - corner[0];
                const double b1 = cross2(q, e2) / area;
                const double b2 = cross2(e1, q) / area;
                if (b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0) {
                    set(x, y, triangle, b1, b2);
                }
            }
        }
    }

  private:
    void set(int x, int y, std::size_t triangle, double b1, double b2) {
        const auto wrap = [&](int i) {
            return static_cast<std::size_t>((i % map_.size + map_.size) % map_.size);
        };
        TexelPoint& texel = map_.texels[wrap(y) * static_cast<std::size_t>(map_.size) + wrap(x)];
        if (texel.owner != 0.0F) {
            const bool on_edge = std::min({b1, b2, 1.0 - b1 - b2}) < 1e-6;
            const bool there_on_edge = std::min({texel.b1, texel.b2, 1.0F - texel.b1 - texel.b2}) < 1e-6F;
            map_.faults.overlapping_texels += on_edge && there_on_edge ? 0 : 1;
            return;
        }
        texel = {static_cast<float>(triangle), static_cast<float>(b1), static_cast<float>(b2),
                 static_cast<float>(triangle + 1)};
    }

    const MeshData& mesh_;
    TexelMap& map_;
};

}  // namespace

TexelMap make_texel_map(const MeshData& mesh, int size) {
    TexelMap map;
    map.size = size;
    map.texels.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    Rasteriser rasteriser(mesh, map);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        rasteriser.add(t);
    }
    return map;
}

}  // namespace viscera::tissue
