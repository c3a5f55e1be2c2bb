#include "effects/contrast/geodesic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "effects/contrast/density.h"
#include "effects/contrast/point_grid.h"
#include "engine/core/error.h"
#include "engine/core/finite.h"
#include "engine/io/mesh.h"

namespace viscera::contrast {
namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();
// A drop smaller than this share of the distance is rounding, and not worth another visit.
constexpr double least_drop = 1.0e-9;

using Triangle = std::array<std::uint32_t, 3>;

// Distance at corner c from those at a and b, the source unfolded into the plane of the triangle.
double unfold(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double at_a, double at_b) {
    const double along_edges = std::min(at_a + glm::distance(a, c), at_b + glm::distance(b, c));
    const glm::dvec3 ab = b - a;
    const glm::dvec3 ac = c - a;
    const double base = glm::length(ab);
    const double area = glm::length(glm::cross(ab, ac));
    if (!(base > 0.0) || !(area > 1.0e-12 * base * base) || !finite(at_a + at_b)) {
        return along_edges;
    }
    // a at the origin, b at (base, 0), c above the axis, the source below it.
    const double cx = glm::dot(ab, ac) / base;
    const double cy = area / base;
    const double sx = (at_a * at_a - at_b * at_b + base * base) / (2.0 * base);
    // (at_a - sx)(at_a + sx) keeps the digits that the difference of squares loses.
    const double sy2 = (at_a - sx) * (at_a + sx);
    const double sy = sy2 > 0.0 ? std::sqrt(sy2) : 0.0;
    const double crossing = sx + (cx - sx) * (sy / (sy + cy));
    if (crossing < 0.0 || crossing > base) {
        return along_edges;
    }
    return std::min(along_edges, std::sqrt((cx - sx) * (cx - sx) + (cy + sy) * (cy + sy)));
}

// The mesh with vertices at one place joined: each vertex is stood for by the first at its place.
class Surface {
  public:
    Surface(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, Log& log)
        : positions_(positions), place_(io::first_at_same_place(positions)), part_(positions.size()) {
        std::iota(part_.begin(), part_.end(), 0U);
        std::uint64_t skipped = 0;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            const auto in_range = [&](std::uint32_t v) {
                return v < positions.size() && finite(positions[v]);
            };
            if (!in_range(indices[i]) || !in_range(indices[i + 1]) || !in_range(indices[i + 2])) {
                ++skipped;
                continue;
            }
            const Triangle t{place_[indices[i]], place_[indices[i + 1]], place_[indices[i + 2]]};
            triangles_.push_back(t);
            part_[root(t[1])] = root(t[0]);
            part_[root(t[2])] = root(t[0]);
        }
        if (skipped > 0) {
            log.fault("contrast.mesh_index", "triangles with vertices that do not exist; left out", skipped);
        }
        for (std::uint32_t v = 0; v < part_.size(); ++v) {
            part_[v] = root(place_[v]);
        }
        first_.assign(positions.size() + 1, 0);
        for (const Triangle& t : triangles_) {
            for (const std::uint32_t v : t) {
                ++first_[v + 1];
            }
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        around_.resize(3 * triangles_.size());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            for (const std::uint32_t v : triangles_[t]) {
                around_[next[v]++] = t;
            }
        }
    }

    [[nodiscard]] glm::dvec3 at(std::uint32_t v) const { return glm::dvec3(positions_[v]); }
    [[nodiscard]] std::uint32_t place(std::uint32_t v) const { return place_[v]; }
    [[nodiscard]] std::uint32_t part(std::uint32_t v) const { return part_[v]; }
    [[nodiscard]] const Triangle& triangle(std::uint32_t t) const { return triangles_[t]; }
    [[nodiscard]] bool used(std::uint32_t v) const { return first_[v + 1] > first_[v]; }
    [[nodiscard]] std::span<const std::uint32_t> triangles_around(std::uint32_t v) const {
        return std::span(around_).subspan(first_[v], first_[v + 1] - first_[v]);
    }

  private:
    std::uint32_t root(std::uint32_t v) {
        while (part_[v] != v) {
            part_[v] = part_[part_[v]];
            v = part_[v];
        }
        return v;
    }

    std::span<const glm::vec3> positions_;
    std::vector<std::uint32_t> place_;
    std::vector<std::uint32_t> part_;
    std::vector<Triangle> triangles_;
    std::vector<std::size_t> first_;
    std::vector<std::uint32_t> around_;
};

struct FrontVertex {
    double distance_mm = 0.0;
    std::uint32_t vertex = 0;
    bool operator>(const FrontVertex& other) const { return distance_mm > other.distance_mm; }
};

void march(const Surface& surface, const PointGrid& grid, double bridge_mm, std::uint32_t start,
           std::vector<double>& distance) {
    std::priority_queue<FrontVertex, std::vector<FrontVertex>, std::greater<>> front;
    const auto relax = [&](std::uint32_t vertex, double candidate) {
        if (candidate < distance[vertex] - least_drop * candidate) {
            distance[vertex] = candidate;
            front.push({candidate, vertex});
        }
    };
    relax(start, 0.0);
    while (!front.empty()) {
        const FrontVertex here = front.top();
        front.pop();
        if (here.distance_mm > distance[here.vertex]) {
            continue;  // has dropped since
        }
        for (const std::uint32_t t : surface.triangles_around(here.vertex)) {
            Triangle corners = surface.triangle(t);
            std::rotate(corners.begin(), std::ranges::find(corners, here.vertex), corners.end());
            const auto [a, b, c] = corners;
            const glm::dvec3 at_a = surface.at(a);
            const glm::dvec3 at_b = surface.at(b);
            const glm::dvec3 at_c = surface.at(c);
            relax(b, unfold(at_a, at_c, at_b, distance[a], distance[c]));
            relax(c, unfold(at_a, at_b, at_c, distance[a], distance[b]));
        }
        if (bridge_mm > 0.0) {
            const glm::dvec3 from = surface.at(here.vertex);
            grid.for_each_near(from, bridge_mm, [&](std::uint32_t other) {
                if (distance[other] > here.distance_mm && surface.part(other) != surface.part(here.vertex)) {
                    relax(other, here.distance_mm + glm::distance(from, surface.at(other)));
                }
            });
        }
    }
}

}  // namespace

void GeodesicParams::visit(ParamVisitor& v) {
    v.field({.name = "speed_mm_s",
             .doc = "Speed at which contrast runs over the surface.",
             .unit = "mm/s",
             .min = 0,
             .min_excluded = true},
            speed_mm_s);
    v.field({.name = "bridge_mm",
             .doc = "Widest gap between separate parts of the mesh that contrast crosses; 0: none.",
             .unit = "mm",
             .min = 0},
            bridge_mm);
}

GeodesicDistances geodesic_distances(std::span<const glm::vec3> positions_mm,
                                     std::span<const std::uint32_t> indices, const glm::dvec3& injection_mm,
                                     double bridge_mm, Log& log) {
    GeodesicDistances result;
    result.distance_mm.assign(positions_mm.size(), unreached);
    const Surface surface(positions_mm, indices, log);

    std::vector<std::uint32_t> places;
    double nearest = unreached;
    for (std::uint32_t v = 0; v < positions_mm.size(); ++v) {
        if (surface.place(v) != v || !surface.used(v)) {
            continue;
        }
        places.push_back(v);
        result.parts += surface.part(v) == v ? 1 : 0;
        const double distance = glm::distance(surface.at(v), injection_mm);
        if (distance < nearest) {
            nearest = distance;
            result.start = v;
        }
    }
    if (!finite(nearest)) {
        log.fault("contrast.no_injection_vertex",
                  "the vessel mesh has no vertex near the injection: no part is reached");
        return result;
    }
    const PointGrid grid = bridge_mm > 0.0 ? PointGrid(positions_mm, places, bridge_mm) : PointGrid();
    march(surface, grid, bridge_mm, result.start, result.distance_mm);
    for (std::uint32_t v = 0; v < positions_mm.size(); ++v) {
        result.distance_mm[v] = result.distance_mm[surface.place(v)];
        if (finite(result.distance_mm[v])) {
            ++result.vertices_reached;
            result.parts_reached += surface.used(v) && surface.part(v) == v ? 1 : 0;
        }
    }
    return result;
}

std::vector<float> geodesic_arrival(std::span<const glm::vec3> positions_mm,
                                    std::span<const std::uint32_t> indices, const glm::dvec3& injection_mm,
                                    const GeodesicParams& params, Log& log) {
    if (!(params.speed_mm_s > 0.0) || !finite(params.speed_mm_s)) {
        throw Error(ErrorCode::scene, "geodesic/speed_mm_s", "must be > 0 and finite");
    }
    if (!(params.bridge_mm >= 0.0) || !finite(params.bridge_mm)) {
        throw Error(ErrorCode::scene, "geodesic/bridge_mm", "must be >= 0 and finite");
    }
    const GeodesicDistances distances =
        geodesic_distances(positions_mm, indices, injection_mm, params.bridge_mm, log);
    std::vector<float> arrival(positions_mm.size(), unreached_s);
    for (std::size_t v = 0; v < arrival.size(); ++v) {
        const double tau = distances.distance_mm[v] / params.speed_mm_s;
        if (tau < static_cast<double>(unreached_s)) {
            arrival[v] = static_cast<float>(tau);
        }
    }
    if (distances.parts_reached < distances.parts) {
        log.fault("contrast.unreached_parts",
                  "parts of the vessel mesh are joined to the injection by no surface; they stay clear",
                  distances.parts - distances.parts_reached);
    }
    return arrival;
}

}  // namespace viscera::contrast
