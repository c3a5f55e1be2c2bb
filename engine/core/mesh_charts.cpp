#include "engine/core/mesh_charts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <set>

#include "engine/core/flat_chart.h"

namespace viscera {
namespace {

constexpr std::uint32_t none = MeshAdjacency::none;
// Charts grow up to 48 degrees; triangles that are steeper than 65 are cut out of them. Lengths shrink by the
// cosine.
constexpr double grown_cosine = 0.66913;
constexpr double kept_cosine = 0.42262;
constexpr int rounds = 12;

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : otherwise;
}

class Cutter {
  public:
    Cutter(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
           std::span<const std::uint32_t> place, const MeshAdjacency& adjacency)
        : positions_(positions), indices_(indices), place_(place), across_(adjacency.across) {
        leave_folds();
        measure();
    }

    MeshCharts cut() {
        grow_all();
        cut_out_steep();
        join_small();
        split_overlapping();
        number();
        return std::move(charts_);
    }

  private:
    [[nodiscard]] std::size_t count() const { return indices_.size() / 3; }
    [[nodiscard]] glm::dvec3 corner(std::size_t t, std::size_t k) const {
        return glm::dvec3(positions_[indices_[3 * t + k]]);
    }

    /// Triangles that run along their common edge in one direction are wound against each other, and would
    /// lie on each other in a chart that both face.
    void leave_folds() {
        for (std::uint32_t h = 0; h < across_.size(); ++h) {
            if (across_[h] != none && place_[indices_[h]] == place_[indices_[across_[h]]]) {
                across_[h] = none;
            }
        }
    }

    void measure() {
        std::vector<glm::dvec3> at_place(positions_.size(), glm::dvec3(0.0));
        for (std::size_t t = 0; t < count(); ++t) {
            const glm::dvec3 normal = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
            area_.push_back(0.5 * glm::length(normal));
            normal_.push_back(unit_or(normal, glm::dvec3(0.0)));
            centre_.push_back((corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0);
            for (std::size_t k = 0; k < 3; ++k) {
                at_place[place_[indices_[3 * t + k]]] += normal;
            }
        }
        // Smoothed over the neighbours, so that a rough surface is not cut into its single triangles.
        for (std::size_t t = 0; t < count(); ++t) {
            glm::dvec3 sum = normal_[t];
            for (std::size_t k = 0; k < 3; ++k) {
                sum += unit_or(at_place[place_[indices_[3 * t + k]]], glm::dvec3(0.0));
            }
            smooth_.push_back(unit_or(sum, normal_[t]));
        }
    }

    struct Candidate {
        double cost;
        std::uint32_t triangle;
        std::uint32_t chart;
        bool operator<(const Candidate& other) const {
            return cost != other.cost ? cost > other.cost : triangle > other.triangle;
        }
    };

    /// Grows all charts at once, each triangle to the chart whose axis it fits best.
    void flood(std::span<const glm::dvec3> normals, double least_cosine) {
        std::priority_queue<Candidate> open;
        const auto offer = [&](std::uint32_t t, std::uint32_t chart) {
            const double cosine = glm::dot(normals[t], charts_.axis[chart]);
            if (charts_.chart_of[t] == none && (cosine >= least_cosine || area_[t] == 0.0)) {
                open.push({1.0 - cosine, t, chart});
            }
        };
        for (std::uint32_t chart = 0; chart < seeds_.size(); ++chart) {
            if (seeds_[chart] != none && charts_.chart_of[seeds_[chart]] == none) {
                open.push({-1.0, seeds_[chart], chart});
            }
        }
        while (!open.empty()) {
            const Candidate best = open.top();
            open.pop();
            if (charts_.chart_of[best.triangle] != none) {
                continue;
            }
            charts_.chart_of[best.triangle] = best.chart;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t across = across_[3 * best.triangle + k];
                if (across != none) {
                    offer(across / 3, best.chart);
                }
            }
        }
    }

    /// Charts for whatever has none, one after another.
    void grow_rest(std::span<const glm::dvec3> normals, double least_cosine) {
        for (std::uint32_t t = 0; t < count(); ++t) {
            if (charts_.chart_of[t] == none) {
                add_chart(t, normals[t]);
                std::vector<std::uint32_t> only(seeds_.size(), none);
                only.back() = t;
                std::swap(seeds_, only);
                flood(normals, least_cosine);
                std::swap(seeds_, only);
            }
        }
    }

    void add_chart(std::uint32_t seed, const glm::dvec3& axis) {
        seeds_.push_back(seed);
        charts_.axis.push_back(unit_or(axis, glm::dvec3(0, 0, 1)));
    }

    void grow_all() {
        charts_.chart_of.assign(count(), none);
        grow_rest(smooth_, grown_cosine);
        for (int round = 0; round < rounds; ++round) {
            recentre(smooth_);
            std::ranges::fill(charts_.chart_of, none);
            flood(smooth_, grown_cosine);
            const std::size_t before = seeds_.size();
            grow_rest(smooth_, grown_cosine);
            if (round > rounds / 2 && seeds_.size() == before) {
                break;
            }
        }
    }

    /// Each chart's axis becomes its mean normal and its seed the triangle nearest to its middle; charts
    /// without triangles go.
    void recentre(std::span<const glm::dvec3> normals) {
        std::vector<glm::dvec3> normal_sum(seeds_.size(), glm::dvec3(0.0));
        std::vector<glm::dvec4> centre_sum(seeds_.size(), glm::dvec4(0.0));
        for (std::size_t t = 0; t < count(); ++t) {
            normal_sum[charts_.chart_of[t]] += area_[t] * normals[t];
            centre_sum[charts_.chart_of[t]] += area_[t] * glm::dvec4(centre_[t], 1.0);
        }
        std::vector<std::uint32_t> seed(seeds_.size(), none);
        std::vector<double> nearest(seeds_.size(), std::numeric_limits<double>::max());
        for (std::uint32_t t = 0; t < count(); ++t) {
            const std::uint32_t chart = charts_.chart_of[t];
            const glm::dvec4& sum = centre_sum[chart];
            const glm::dvec3 middle = sum.w > 0.0 ? glm::dvec3(sum) / sum.w : centre_[t];
            const double distance = glm::length(centre_[t] - middle);
            if (distance < nearest[chart]) {
                nearest[chart] = distance;
                seed[chart] = t;
            }
        }
        seeds_.clear();
        std::vector<glm::dvec3> axes;
        std::swap(axes, charts_.axis);
        for (std::size_t chart = 0; chart < seed.size(); ++chart) {
            if (seed[chart] != none) {
                add_chart(seed[chart], unit_or(normal_sum[chart], axes[chart]));
            }
        }
    }

    void cut_out_steep() {
        for (std::size_t t = 0; t < count(); ++t) {
            const double cosine = glm::dot(normal_[t], charts_.axis[charts_.chart_of[t]]);
            if (cosine < kept_cosine && area_[t] > 0.0) {
                charts_.chart_of[t] = none;
            }
        }
        grow_rest(normal_, grown_cosine);
        keep_connected();
    }

    /// What hangs together no more becomes charts of its own.
    void keep_connected() {
        const std::vector<std::uint32_t> old = charts_.chart_of;
        const std::vector<glm::dvec3> axes = charts_.axis;
        seeds_.clear();
        charts_.axis.clear();
        std::ranges::fill(charts_.chart_of, none);
        std::vector<std::uint32_t> open;
        for (std::uint32_t first = 0; first < count(); ++first) {
            if (charts_.chart_of[first] != none) {
                continue;
            }
            const auto chart = static_cast<std::uint32_t>(seeds_.size());
            add_chart(first, axes[old[first]]);
            charts_.chart_of[first] = chart;
            open.push_back(first);
            while (!open.empty()) {
                const std::uint32_t t = open.back();
                open.pop_back();
                for (std::uint32_t k = 0; k < 3; ++k) {
                    const std::uint32_t across = across_[3 * t + k];
                    if (across != none && charts_.chart_of[across / 3] == none && old[across / 3] == old[t]) {
                        charts_.chart_of[across / 3] = chart;
                        open.push_back(across / 3);
                    }
                }
            }
        }
    }

    [[nodiscard]] std::vector<std::vector<std::uint32_t>> triangles_by_chart() const {
        std::vector<std::vector<std::uint32_t>> result(charts_.axis.size());
        for (std::uint32_t t = 0; t < count(); ++t) {
            result[charts_.chart_of[t]].push_back(t);
        }
        return result;
    }

    /// What joining looks at.
    struct Joining {
        std::vector<std::vector<std::uint32_t>> members;
        std::vector<glm::dvec3> normal_sum;  ///< weighted by area
        std::vector<double> area;
    };

    /// Charts that share a border with a chart, longest border first.
    [[nodiscard]] std::vector<std::uint32_t> neighbours_of(std::uint32_t chart,
                                                           std::span<const std::uint32_t> members) const {
        std::map<std::uint32_t, double> shared;
        for (const std::uint32_t t : members) {
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t across = across_[3 * t + k];
                if (across != none && charts_.chart_of[across / 3] != chart) {
                    shared[charts_.chart_of[across / 3]] +=
                        glm::length(corner(t, (k + 1) % 3) - corner(t, k));
                }
            }
        }
        std::vector<std::pair<double, std::uint32_t>> order;
        order.reserve(shared.size());
        for (const auto& [other, length] : shared) {
            order.emplace_back(-length, other);
        }
        std::ranges::sort(order);
        std::vector<std::uint32_t> result;
        result.reserve(order.size());
        for (const auto& [length, other] : order) {
            result.push_back(other);
        }
        return result;
    }

    [[nodiscard]] bool faces(std::span<const std::uint32_t> members, const glm::dvec3& axis) const {
        return std::ranges::all_of(members, [&](std::uint32_t t) {
            return area_[t] == 0.0 || glm::dot(normal_[t], axis) >= kept_cosine;
        });
    }

    /// The smallest charts join the neighbour they share most of their border with, as long as both together
    /// face one axis.
    void join_small() {
        Joining all{triangles_by_chart(), {}, {}};
        for (const auto& members : all.members) {
            all.normal_sum.emplace_back(0.0);
            all.area.push_back(0.0);
            for (const std::uint32_t t : members) {
                all.normal_sum.back() += area_[t] * normal_[t];
                all.area.back() += area_[t];
            }
        }
        std::set<std::pair<double, std::uint32_t>> open;
        for (std::uint32_t chart = 0; chart < all.members.size(); ++chart) {
            open.emplace(all.area[chart], chart);
        }
        while (!open.empty()) {
            const std::uint32_t chart = open.begin()->second;
            open.erase(open.begin());
            for (const std::uint32_t other : neighbours_of(chart, all.members[chart])) {
                const glm::dvec3 axis =
                    unit_or(all.normal_sum[chart] + all.normal_sum[other], charts_.axis[other]);
                if (!faces(all.members[chart], axis) || !faces(all.members[other], axis)) {
                    continue;
                }
                open.erase({all.area[other], other});
                join(all, chart, other, axis);
                open.emplace(all.area[other], other);
                break;
            }
        }
        keep_connected();
    }

    void join(Joining& all, std::uint32_t chart, std::uint32_t into, const glm::dvec3& axis) {
        for (const std::uint32_t t : all.members[chart]) {
            charts_.chart_of[t] = into;
        }
        all.members[into].insert(all.members[into].end(), all.members[chart].begin(),
                                 all.members[chart].end());
        all.members[chart].clear();
        all.normal_sum[into] += all.normal_sum[chart];
        all.area[into] += all.area[chart];
        charts_.axis[into] = axis;
    }

    [[nodiscard]] bool overlaps(std::span<const std::uint32_t> members, const glm::dvec3& axis) const {
        FlatChart flat(axis);
        for (const std::uint32_t t : members) {
            flat.add_triangle({corner(t, 0), corner(t, 1), corner(t, 2)});
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t across = across_[3 * t + k];
                if (across == none || charts_.chart_of[across / 3] != charts_.chart_of[t]) {
                    const std::uint32_t next = (k + 1) % 3;
                    flat.add_border({place_[indices_[3 * t + k]], place_[indices_[3 * t + next]]},
                                    {corner(t, k), corner(t, next)});
                }
            }
        }
        return flat.covers_itself();
    }

    /// Charts that cover themselves are cut in the middle of their longer side.
    void split_overlapping() {
        constexpr int most_rounds = 16;
        for (int round = 0; round < most_rounds; ++round) {
            const auto members = triangles_by_chart();
            bool any = false;
            for (std::uint32_t chart = 0; chart < members.size(); ++chart) {
                if (members[chart].size() < 2 || !overlaps(members[chart], charts_.axis[chart])) {
                    continue;
                }
                any = true;
                glm::dvec3 low(std::numeric_limits<double>::max());
                glm::dvec3 high(std::numeric_limits<double>::lowest());
                for (const std::uint32_t t : members[chart]) {
                    low = glm::min(low, centre_[t]);
                    high = glm::max(high, centre_[t]);
                }
                const glm::dvec3 size = high - low;
                const int along = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
                const double middle = 0.5 * (low[along] + high[along]);
                const auto other = static_cast<std::uint32_t>(charts_.axis.size());
                add_chart(members[chart].front(), charts_.axis[chart]);
                for (const std::uint32_t t : members[chart]) {
                    charts_.chart_of[t] = centre_[t][along] > middle ? other : chart;
                }
            }
            if (!any) {
                return;
            }
            keep_connected();
        }
    }

    /// Numbers without gaps.
    void number() {
        const auto members = triangles_by_chart();
        std::vector<glm::dvec3> axes;
        for (std::size_t chart = 0; chart < members.size(); ++chart) {
            for (const std::uint32_t t : members[chart]) {
                charts_.chart_of[t] = static_cast<std::uint32_t>(axes.size());
            }
            if (!members[chart].empty()) {
                axes.push_back(charts_.axis[chart]);
            }
        }
        charts_.axis = std::move(axes);
    }

    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    std::span<const std::uint32_t> place_;
    std::vector<std::uint32_t> across_;
    std::vector<double> area_;
    std::vector<glm::dvec3> normal_;
    std::vector<glm::dvec3> smooth_;
    std::vector<glm::dvec3> centre_;
    std::vector<std::uint32_t> seeds_;
    MeshCharts charts_;
};

}  // namespace

MeshCharts cut_into_charts(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                           std::span<const std::uint32_t> place, const MeshAdjacency& adjacency) {
    return Cutter(positions, indices, place, adjacency).cut();
}

}  // namespace viscera
