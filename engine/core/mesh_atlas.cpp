#include "engine/core/mesh_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/mesh_adjacency.h"
#include "engine/core/mesh_charts.h"
#include "engine/core/rectangle_pack.h"
#include "engine/core/texel_raster.h"

namespace viscera {
namespace {

constexpr double far_away = std::numeric_limits<double>::max();

/// A chart laid on its plane, lower left corner at 0.
struct LaidChart {
    std::vector<std::uint32_t> vertices;  ///< of the mesh
    std::vector<glm::dvec2> places;       ///< in lengths of the mesh
    glm::dvec2 size{0.0};
};

void project(LaidChart& chart, std::span<const glm::vec3> positions, const glm::dvec3& axis) {
    const glm::dvec3 aside = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(aside, axis));
    const glm::dvec3 v = glm::cross(axis, u);
    const glm::dvec3 origin(positions[chart.vertices.front()]);
    for (const std::uint32_t vertex : chart.vertices) {
        const glm::dvec3 p = glm::dvec3(positions[vertex]) - origin;
        chart.places.emplace_back(glm::dot(p, u), glm::dot(p, v));
    }
}

/// Turns a chart so that the box around it is smallest and lies on its longer side. Directions come from a
/// walk along a diamond: sums and roots only, so that every machine finds the same one.
void turn(LaidChart& chart) {
    constexpr int directions = 48;
    const auto direction = [](int i) {
        const double way = static_cast<double>(i) / directions;
        return glm::normalize(glm::dvec2(1.0 - 2.0 * way, std::min(2.0 * way, 2.0 - 2.0 * way)));
    };
    const auto turned = [](const glm::dvec2& p, const glm::dvec2& d) {
        return glm::dvec2(d.x * p.x - d.y * p.y, d.y * p.x + d.x * p.y);
    };
    const auto box = [&](const glm::dvec2& d) {
        glm::dvec2 low(far_away);
        glm::dvec2 high(-far_away);
        for (const glm::dvec2& p : chart.places) {
            low = glm::min(low, turned(p, d));
            high = glm::max(high, turned(p, d));
        }
        return std::pair(low, high);
    };
    double least = far_away;
    glm::dvec2 best(1.0, 0.0);
    for (int i = 0; i < directions; ++i) {
        const auto [low, high] = box(direction(i));
        const glm::dvec2 size = high - low;
        if (size.x >= size.y && size.x * size.y < least) {
            least = size.x * size.y;
            best = direction(i);
        }
    }
    const auto [low, high] = box(best);
    for (glm::dvec2& p : chart.places) {
        p = turned(p, best) - low;
    }
    chart.size = high - low;
}

/// The largest scale at which all charts fit, and where they lie then.
struct Packing {
    double scale = 0.0;
    double gap = atlas_gap;
    std::vector<glm::dvec2> corners;
};

Packing pack(std::span<const LaidChart> charts) {
    Packing best;
    double area = 0.0;
    double longest = 0.0;
    for (const LaidChart& chart : charts) {
        area += chart.size.x * chart.size.y;
        longest = std::max(longest, chart.size.x);
    }
    // Thousands of charts leave no room for whole gaps.
    best.gap = std::min(atlas_gap, 0.5 / std::sqrt(static_cast<double>(charts.size())));
    std::vector<glm::dvec2> sizes(charts.size());
    const auto try_scale = [&](double scale) {
        for (std::size_t i = 0; i < charts.size(); ++i) {
            sizes[i] = scale * charts[i].size + best.gap;
        }
        if (auto corners = pack_rectangles(sizes)) {
            best.scale = scale;
            best.corners = std::move(*corners);
            return true;
        }
        return false;
    };
    double high = std::min(1.0 / std::sqrt(std::max(area, 1e-300)), 1.0 / std::max(longest, 1e-150));
    double low = high;
    constexpr int halvings = 60;
    for (int i = 0; i < halvings && !try_scale(low); ++i) {
        high = low;
        low *= 0.5;
    }
    constexpr int bisections = 12;
    for (int i = 0; i < bisections; ++i) {
        const double middle = 0.5 * (low + high);
        (try_scale(middle) ? low : high) = middle;
    }
    return best;
}

void report(const Progress& progress, double fraction) {
    if (progress && !progress(fraction)) {
        throw Error(ErrorCode::usage, "atlas", "cancelled");
    }
}

class AtlasMaker {
  public:
    AtlasMaker(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
               const MeshCharts& charts)
        : positions_(positions), indices_(indices), charts_(charts) {}

    MeshAtlas make() {
        atlas_.charts = charts_.axis.size();
        atlas_.uvs.assign(positions_.size(), glm::vec2(0.0F));
        if (!charts_.axis.empty()) {
            split_vertices();
            lay_out();
            measure();
        }
        return std::move(atlas_);
    }

  private:
    /// One vertex of the atlas for each vertex of the mesh and each chart that uses it.
    void split_vertices() {
        flat_.resize(charts_.axis.size());
        slots_.resize(charts_.axis.size());
        atlas_.indices.resize(indices_.size());
        std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> known(positions_.size());
        for (std::size_t i = 0; i < indices_.size(); ++i) {
            const std::uint32_t vertex = indices_[i];
            const std::uint32_t chart = charts_.chart_of[i / 3];
            const auto found =
                std::ranges::find(known[vertex], chart, &std::pair<std::uint32_t, std::uint32_t>::first);
            if (found != known[vertex].end()) {
                atlas_.indices[i] = found->second;
                continue;
            }
            std::uint32_t slot = vertex;
            if (!known[vertex].empty()) {
                slot = static_cast<std::uint32_t>(positions_.size() + atlas_.origin.size());
                atlas_.origin.push_back(vertex);
            }
            known[vertex].emplace_back(chart, slot);
            flat_[chart].vertices.push_back(vertex);
            slots_[chart].push_back(slot);
            atlas_.indices[i] = slot;
        }
        atlas_.uvs.resize(positions_.size() + atlas_.origin.size());
    }

    void lay_out() {
        for (std::size_t chart = 0; chart < flat_.size(); ++chart) {
            project(flat_[chart], positions_, charts_.axis[chart]);
            turn(flat_[chart]);
        }
        const Packing packing = pack(flat_);
        atlas_.scale = packing.scale;
        for (std::size_t chart = 0; chart < flat_.size(); ++chart) {
            for (std::size_t i = 0; i < slots_[chart].size(); ++i) {
                atlas_.uvs[slots_[chart][i]] =
                    packing.corners[chart] + 0.5 * packing.gap + packing.scale * flat_[chart].places[i];
            }
        }
    }

    void measure() {
        double area_sum = 0.0;
        double stretch_sum = 0.0;
        for (std::size_t t = 0; t < indices_.size() / 3; ++t) {
            const glm::dvec3 p(positions_[indices_[3 * t]]);
            const glm::dvec3 normal = glm::cross(glm::dvec3(positions_[indices_[3 * t + 1]]) - p,
                                                 glm::dvec3(positions_[indices_[3 * t + 2]]) - p);
            const double area = 0.5 * glm::length(normal);
            // A projection along an axis shortens by the cosine in one direction and by nothing in the other.
            const double cosine =
                area > 0.0 ? std::abs(glm::dot(normal, charts_.axis[charts_.chart_of[t]])) / (2.0 * area)
                           : 1.0;
            const double stretch = 1.0 / std::max(cosine, 1e-6);
            atlas_.most_stretch = std::max(atlas_.most_stretch, stretch);
            area_sum += area;
            stretch_sum += area * stretch;
        }
        atlas_.mean_stretch = area_sum > 0.0 ? stretch_sum / area_sum : 1.0;
        atlas_.coverage = measure_uvs(atlas_.uvs, atlas_.indices).covered;
    }

    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    const MeshCharts& charts_;
    std::vector<LaidChart> flat_;
    std::vector<std::vector<std::uint32_t>> slots_;  ///< per chart: the atlas vertex of each of its vertices
    MeshAtlas atlas_;
};

}  // namespace

MeshAtlas make_atlas(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                     std::span<const std::uint32_t> place, const Progress& progress) {
    report(progress, 0.0);
    const MeshAdjacency adjacency = find_adjacency(indices, place);
    const MeshCharts charts = cut_into_charts(positions, indices, place, adjacency);
    report(progress, 0.6);
    MeshAtlas atlas = AtlasMaker(positions, indices, charts).make();
    report(progress, 1.0);
    return atlas;
}

UvUse measure_uvs(std::span<const glm::vec2> uvs, std::span<const std::uint32_t> indices) {
    constexpr int side = 512;
    // Texels that triangles only touch with an edge are no overlap.
    constexpr double inside = 1e-3;
    constexpr int most = 8 * side;
    std::vector<unsigned char> count(static_cast<std::size_t>(side) * side, 0);
    UvUse use;
    double area = 0.0;
    double flat = 0.0;
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        std::array<glm::dvec2, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 uv(uvs[indices[t + k]]);
            corner[k] = static_cast<double>(side) * uv;
            constexpr double slack = 1e-5;
            use.beyond = use.beyond || std::min(uv.x, uv.y) < -slack || std::max(uv.x, uv.y) > 1.0 + slack;
        }
        const double twice = std::abs(cross2(corner[1] - corner[0], corner[2] - corner[0]));
        area += 0.5 * twice;
        flat += twice > 0.0 ? 0.0 : 1.0;
        // With several times the texture's area most of it is covered twice: no need to look at every texel.
        constexpr double several = 4.0 * side * side;
        const bool seen =
            area < several && for_each_texel(corner, most, [&](int x, int y, double b1, double b2) {
                const auto wrap = [](int i) { return static_cast<std::size_t>((i % side + side) % side); };
                unsigned char& texel = count[wrap(y) * side + wrap(x)];
                const bool on_edge = std::min({b1, b2, 1.0 - b1 - b2}) < inside;
                texel =
                    static_cast<unsigned char>(std::min(on_edge ? std::max<int>(texel, 1) : texel + 1, 3));
            });
        if (!seen) {
            std::ranges::fill(count, 3);
        }
    }
    const auto covered = std::ranges::count_if(count, [](unsigned char n) { return n > 0; });
    const auto twice = std::ranges::count_if(count, [](unsigned char n) { return n > 1; });
    use.flat = indices.empty() ? 0.0 : 3.0 * flat / static_cast<double>(indices.size());
    use.covered = static_cast<double>(covered) / static_cast<double>(count.size());
    use.overlap = covered > 0 ? static_cast<double>(twice) / static_cast<double>(covered) : 0.0;
    return use;
}

}  // namespace viscera
