#include "effects/tissue/texel_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/tissue/surface_walk.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/mesh_adjacency.h"
#include "engine/core/texel_raster.h"
#include "engine/io/packed.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/surface_mesh.h"

namespace viscera::tissue {
namespace {

/// Named in the disk cache; another number when maps are made in another way.
constexpr std::string_view cached_kind = "texel-map-4";

bool read_map(const io::DiskCache& cache, std::uint64_t key, int size, TexelMap& map) {
    const auto bytes = cache.load(cached_kind, key);
    if (!bytes) {
        return false;
    }
    io::Unpacker unpacker(*bytes);
    unpacker.read(map.faults).read(map.size).read(map.texels);
    const auto side = static_cast<std::size_t>(size);
    return unpacker.complete() && map.size == size && map.texels.size() == side * side;
}

class MapMaker {
  public:
    MapMaker(const TexelSurface& mesh, int size)
        : mesh_(mesh), adjacency_(find_adjacency(mesh.indices, mesh.place)) {
        map_.size = size;
        map_.texels.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
        map_.faults.non_manifold_edges = adjacency_.non_manifold_edges;
    }

    TexelMap make(const Progress& progress) {
        report(progress, 0.0);
        for (std::uint32_t t = 0; t < mesh_.indices.size() / 3; ++t) {
            fill(t);
        }
        report(progress, 0.3);
        find_gutters();
        report(progress, 0.6);
        count_narrow_texels();
        walk_gutters();
        report(progress, 1.0);
        return std::move(map_);
    }

  private:
    /// A gutter texel's way back to the nearest border.
    struct Gutter {
        double distance2 = 0.0;  ///< [texels^2]
        double outward = 0.0;    ///< [texels] towards the outside of the half-edge
        double along = 0.0;
        glm::dvec2 away{0.0};  ///< from the border to the texel [texels]
        std::uint32_t half_edge = MeshAdjacency::none;
    };

    static void report(const Progress& progress, double fraction) {
        if (progress && !progress(fraction)) {
            throw Error(ErrorCode::usage, "texels of a surface", "cancelled");
        }
    }

    /// Where a half-edge begins in the texture [texels].
    [[nodiscard]] glm::dvec2 at(std::uint32_t half_edge) const {
        return static_cast<double>(map_.size) * glm::dvec2(mesh_.uvs[mesh_.indices[half_edge]]);
    }
    [[nodiscard]] double signed_area2(std::uint32_t t) const {
        return cross2(at(3 * t + 1) - at(3 * t), at(3 * t + 2) - at(3 * t));
    }
    [[nodiscard]] std::size_t texel_at(int x, int y) const {
        const int n = map_.size;
        const auto wrap = [n](int i) { return static_cast<std::size_t>((i % n + n) % n); };
        return wrap(y) * static_cast<std::size_t>(n) + wrap(x);
    }

    void fill(std::uint32_t t) {
        const std::array<glm::dvec2, 3> corner{at(3 * t), at(3 * t + 1), at(3 * t + 2)};
        const double area2 = signed_area2(t);
        map_.faults.flat_triangles += area2 == 0.0 ? 1 : 0;
        map_.faults.mirrored_triangles += area2 < 0.0 ? 1 : 0;
        if (is_collapsed(mesh_.indices, mesh_.place, std::size_t{3} * t)) {
            return;  // its texels would be cells without area; beside it gutters lead on
        }
        constexpr int most_textures = 4;
        const bool seen =
            for_each_texel(corner, most_textures * map_.size,
                           [&](int x, int y, double b1, double b2) { set(texel_at(x, y), t, b1, b2); });
        map_.faults.huge_triangles += seen ? 0 : 1;
    }

    void set(std::size_t index, std::uint32_t t, double b1, double b2) {
        TexelPoint& texel = map_.texels[index];
        if (texel.owner != 0.0F) {
            // On the edge that two triangles share, the centre lies in both.
            constexpr double inside = 1e-3;
            const bool overlap = std::min({b1, b2, 1.0 - b1 - b2}) > inside &&
                                 std::min({texel.b1, texel.b2, 1.0F - texel.b1 - texel.b2}) > inside;
            map_.faults.overlapping_texels += overlap ? 1 : 0;
            return;
        }
        texel = {static_cast<float>(t), static_cast<float>(b1), static_cast<float>(b2),
                 static_cast<float>(t + 1)};
    }

    /// Whether the texture ends or jumps at a half-edge: nothing beyond, other coordinates beyond, or a fold.
    [[nodiscard]] bool is_border(std::uint32_t half_edge) const {
        const std::uint32_t across = adjacency_.across[half_edge];
        if (across == MeshAdjacency::none) {
            return true;
        }
        std::uint32_t a = half_edge;
        std::uint32_t b = MeshAdjacency::next(half_edge);
        std::uint32_t c = across;
        std::uint32_t d = MeshAdjacency::next(across);
        // Triangles of one orientation run along their common edge in opposite directions.
        if (mesh_.place[mesh_.indices[a]] != mesh_.place[mesh_.indices[c]]) {
            std::swap(c, d);
        }
        const auto uv = [&](std::uint32_t h) { return mesh_.uvs[mesh_.indices[h]]; };
        if (uv(a) != uv(c) || uv(b) != uv(d)) {
            return true;
        }
        const glm::dvec2 edge = at(b) - at(a);
        const double side = cross2(edge, at(MeshAdjacency::previous(half_edge)) - at(a));
        const double other_side = cross2(edge, at(MeshAdjacency::previous(across)) - at(a));
        return side * other_side > 0.0;
    }

    void find_gutters() {
        gutters_.resize(map_.texels.size());
        const bool repeats = std::ranges::any_of(mesh_.uvs, [](const glm::vec2& uv) {
            return std::min(uv.x, uv.y) < 0.0F || std::max(uv.x, uv.y) > 1.0F;
        });
        for (std::uint32_t h = 0; h < mesh_.indices.size(); ++h) {
            if (signed_area2(h / 3) != 0.0 && is_border(h)) {
                surround(h, repeats);
            }
        }
    }

    /// By triangle a triangle that stands for its chart: all that hang together in the texture.
    [[nodiscard]] std::vector<std::uint32_t> find_charts() const {
        std::vector<std::uint32_t> chart(mesh_.indices.size() / 3, MeshAdjacency::none);
        std::vector<std::uint32_t> waiting;
        for (std::uint32_t t = 0; t < chart.size(); ++t) {
            if (chart[t] != MeshAdjacency::none) {
                continue;
            }
            chart[t] = t;
            waiting.push_back(t);
            while (!waiting.empty()) {
                const std::uint32_t here = waiting.back();
                waiting.pop_back();
                for (std::uint32_t h = 3 * here; h < 3 * here + 3; ++h) {
                    const std::uint32_t across = adjacency_.across[h];
                    if (across != MeshAdjacency::none && chart[across / 3] == MeshAdjacency::none &&
                        !is_border(h)) {
                        chart[across / 3] = t;
                        waiting.push_back(across / 3);
                    }
                }
            }
        }
        return chart;
    }

    /// Texels that two charts want for their gutters, or that one wants and the other covers.
    void count_narrow_texels() {
        const std::vector<std::uint32_t> chart = find_charts();
        const int n = map_.size;
        std::vector<std::uint32_t> chart_of(map_.texels.size(), MeshAdjacency::none);
        for (std::size_t i = 0; i < chart_of.size(); ++i) {
            if (map_.texels[i].owner != 0.0F) {
                chart_of[i] = chart[static_cast<std::size_t>(map_.texels[i].owner) - 1];
            } else if (gutters_[i].half_edge != MeshAdjacency::none) {
                chart_of[i] = chart[gutters_[i].half_edge / 3];
            }
        }
        std::vector<bool> narrow(map_.texels.size(), false);
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                if (is_rim(x, y, chart_of)) {
                    mark_narrow(x, y, chart_of, narrow);
                }
            }
        }
        map_.faults.narrow_texels = static_cast<std::uint64_t>(std::ranges::count(narrow, true));
    }

    /// Whether a chart covers this texel, and not all beside it.
    [[nodiscard]] bool is_rim(int x, int y, std::span<const std::uint32_t> chart_of) const {
        const std::size_t here = texel_at(x, y);
        const auto covers = [&](std::size_t i) {
            return map_.texels[i].owner != 0.0F && chart_of[i] == chart_of[here];
        };
        return covers(here) && !(covers(texel_at(x - 1, y)) && covers(texel_at(x + 1, y)) &&
                                 covers(texel_at(x, y - 1)) && covers(texel_at(x, y + 1)));
    }

    /// Around a texel at the rim of a chart.
    void mark_narrow(int x, int y, std::span<const std::uint32_t> chart_of, std::vector<bool>& narrow) const {
        const std::uint32_t own = chart_of[texel_at(x, y)];
        const int last = map_.size - 1;
        for (int v = std::max(y - least_gutter, 0); v <= std::min(y + least_gutter, last); ++v) {
            for (int u = std::max(x - least_gutter, 0); u <= std::min(x + least_gutter, last); ++u) {
                const std::size_t i = texel_at(u, v);
                const bool near = (u - x) * (u - x) + (v - y) * (v - y) <= least_gutter * least_gutter;
                if (near && chart_of[i] != MeshAdjacency::none && chart_of[i] != own) {
                    narrow[i] = true;
                }
            }
        }
    }

    /// Offers the border at a half-edge to the texels near it.
    void surround(std::uint32_t half_edge, bool repeats) {
        const glm::dvec2 a = at(half_edge);
        const glm::dvec2 b = at(MeshAdjacency::next(half_edge));
        const glm::dvec2 edge = b - a;
        const double length2 = glm::dot(edge, edge);
        // A triangle that fill() left out has no gutter either.
        if (!(length2 > 0.0) || std::sqrt(length2) > 6.0 * map_.size) {
            return;
        }
        const double turn = signed_area2(half_edge / 3) > 0.0 ? 1.0 : -1.0;
        const glm::dvec2 outward = turn * glm::dvec2(edge.y, -edge.x) / std::sqrt(length2);
        const double reach = gutter_texels + 0.5;
        const glm::dvec2 low = glm::min(a, b) - reach;
        const glm::dvec2 high = glm::max(a, b) + reach;
        const auto first = [&](double x) {
            return static_cast<int>(std::ceil(repeats ? x : std::max(x, 0.0)));
        };
        const auto last = [&](double x) {
            return static_cast<int>(std::floor(repeats ? x : std::min<double>(x, map_.size))) - 1;
        };
        for (int y = first(low.y); y <= last(high.y); ++y) {
            for (int x = first(low.x); x <= last(high.x); ++x) {
                const std::size_t index = texel_at(x, y);
                if (map_.texels[index].owner != 0.0F) {
                    continue;
                }
                const glm::dvec2 q(x + 0.5, y + 0.5);
                const double along = std::clamp(glm::dot(q - a, edge) / length2, 0.0, 1.0);
                const glm::dvec2 away = q - (a + along * edge);
                const double distance2 = glm::dot(away, away);
                if (distance2 <= reach * reach) {
                    offer(gutters_[index], {distance2, glm::dot(away, outward), along, away, half_edge});
                }
            }
        }
    }

    /// The nearest border has a texel; at a corner, where two are equally near, the one that faces it more.
    static void offer(Gutter& gutter, const Gutter& candidate) {
        constexpr double same = 1e-9;
        const double difference = candidate.distance2 - gutter.distance2;
        const bool nearer = difference < -same * (1.0 + gutter.distance2);
        const bool as_near = difference <= same * (1.0 + gutter.distance2);
        if (gutter.half_edge == MeshAdjacency::none || nearer ||
            (as_near && candidate.outward > gutter.outward)) {
            gutter = candidate;
        }
    }

    void walk_gutters() {
        const SurfaceWalk walk(mesh_.positions, mesh_.indices, adjacency_);
        for (std::size_t i = 0; i < gutters_.size(); ++i) {
            if (gutters_[i].half_edge != MeshAdjacency::none) {
                map_.texels[i] = point_of(gutters_[i], walk);
            }
        }
    }

    [[nodiscard]] TexelPoint point_of(const Gutter& gutter, const SurfaceWalk& walk) const {
        const std::uint32_t t = gutter.half_edge / 3;
        const glm::dvec2 d1 = at(3 * t + 1) - at(3 * t);
        const glm::dvec2 d2 = at(3 * t + 2) - at(3 * t);
        const double area2 = cross2(d1, d2);
        const auto corner = [&](std::uint32_t k) {
            return glm::dvec3(mesh_.positions[mesh_.indices[3 * t + k]]);
        };
        const glm::dvec3 way = (cross2(gutter.away, d2) * (corner(1) - corner(0)) +
                                cross2(d1, gutter.away) * (corner(2) - corner(0))) /
                               area2;
        // Not from a corner itself, where it would be open which triangle is entered first.
        constexpr double off_corner = 1e-6;
        const double along = std::clamp(gutter.along, off_corner, 1.0 - off_corner);
        const auto owner = -static_cast<float>(t + 1);
        SurfacePoint end;
        if (std::isfinite(way.x + way.y + way.z) && walk.leave(gutter.half_edge, along, way, end)) {
            return {static_cast<float>(end.triangle), static_cast<float>(end.b1), static_cast<float>(end.b2),
                    owner};
        }
        std::array<double, 3> weight{0.0, 0.0, 0.0};
        weight[gutter.half_edge % 3] = 1.0 - gutter.along;
        weight[MeshAdjacency::next(gutter.half_edge) % 3] = gutter.along;
        return {owner, static_cast<float>(weight[1]), static_cast<float>(weight[2]), owner};
    }

    const TexelSurface& mesh_;
    MeshAdjacency adjacency_;
    std::vector<Gutter> gutters_;
    TexelMap map_;
};

}  // namespace

TexelSurface texel_surface(const SurfaceMesh& mesh) {
    return {.positions = mesh.file_positions(),
            .uvs = mesh.data().uvs,
            .indices = mesh.data().indices,
            .place = mesh.places()};
}

TexelMap make_texel_map(const TexelSurface& surface, int size, const Progress& progress) {
    return MapMaker(surface, size).make(progress);
}

std::shared_ptr<const TexelMap> shared_texel_map(Assets& assets, const SurfaceMesh& mesh, int size,
                                                 const std::string& where) {
    const std::uint64_t key = Hash().add(mesh.key()).add(size).add(gutter_texels).value();
    return assets.shared<TexelMap>(key, [&] {
        auto map = std::make_shared<TexelMap>();
        const io::DiskCache& cache = assets.disk_cache();
        if (!read_map(cache, key, size, *map)) {
            *map =
                make_texel_map(texel_surface(mesh), size, assets.progress("finding the texels of " + where));
            cache.store(cached_kind, key,
                        io::Packer().add(map->faults).add(map->size).add(map->texels).bytes());
        }
        return map;
    });
}

}  // namespace viscera::tissue
