#include "tests/reference/tissue_film.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace viscera::reference {
namespace {

using Texel = TissueSurface::Texel;

bool joined(Texel kind) {
    return kind == Texel::cell || kind == Texel::gutter;
}

struct Local {
    double conductance = 0.0;  ///< |Pv| / (|Pu| sin)
    double inverse = 0.0;      ///< |Pu| / (|Pv| sin)
    double skew = 0.0;         ///< -cos / sin
};

Local local(const glm::dvec4& metric) {
    const double sine = std::sqrt(std::max(1.0 - metric.z * metric.z, 0.0025));
    return {metric.y / (metric.x * sine), metric.x / (metric.y * sine), -metric.z / sine};
}

/// Slope of a field along an axis at a texel: central, one-sided at borders.
template <class Value>
double slope(const TissueSurface& s, int x, int y, int dx, int dy, Value value) {
    const bool before = joined(s.at(x - dx, y - dy));
    const bool after = joined(s.at(x + dx, y + dy));
    const double here = value(s.index(x, y));
    const double low = before ? value(s.index(x - dx, y - dy)) : here;
    const double high = after ? value(s.index(x + dx, y + dy)) : here;
    return before && after ? 0.5 * (high - low) : high - low;
}

struct Builder {
    const TissueSurface& s;
    const glm::dvec3 gravity;
    const bool open_edges;
    std::vector<double> height;  ///< against gravity, times its strength
    std::vector<double> up;

    Builder(const TissueSurface& surface, const glm::dvec3& g, double spreading, bool open)
        : s(surface), gravity(g), open_edges(open) {
        for (std::size_t i = 0; i < s.position.size(); ++i) {
            height.push_back(-glm::dot(gravity, s.position[i]));
            up.push_back(std::max(-glm::dot(gravity, s.normal[i]), spreading * glm::length(gravity)));
        }
    }
    double z(std::size_t i) const { return height[i]; }

    /// What the relief adds to a rise, times the strength of gravity: no more than up a wall.
    double relief_rise(std::size_t from, std::size_t to) const {
        if (s.lift.empty()) {
            return 0.0;
        }
        const double steepest = glm::length(s.position[to] - s.position[from]);
        return glm::length(gravity) * std::clamp(s.lift[to] - s.lift[from], -steepest, steepest);
    }
    /// The same per texel along an axis: central, one-sided at borders.
    double relief_slope(int x, int y, int dx, int dy) const {
        const bool before = joined(s.at(x - dx, y - dy));
        const bool after = joined(s.at(x + dx, y + dy));
        const std::size_t here = s.index(x, y);
        const double rise =
            relief_rise(before ? s.index(x - dx, y - dy) : here, after ? s.index(x + dx, y + dy) : here);
        return before && after ? 0.5 * rise : rise;
    }
    double rise(std::size_t from, std::size_t to) const { return z(to) - z(from) + relief_rise(from, to); }
    double slope_of_rise(int x, int y, int dx, int dy) const {
        return slope(s, x, y, dx, dy, [this](std::size_t i) { return z(i); }) + relief_slope(x, y, dx, dy);
    }

    /// Direction downhill in texels, up to a scale, without the relief.
    glm::dvec2 downhill(int x, int y) const {
        glm::dvec3 du;
        glm::dvec3 dv;
        for (int axis = 0; axis < 3; ++axis) {
            const auto coordinate = [&](std::size_t i) { return s.position[i][axis]; };
            du[axis] = slope(s, x, y, 1, 0, coordinate);
            dv[axis] = slope(s, x, y, 0, 1, coordinate);
        }
        const double uu = glm::dot(du, du);
        const double uv = glm::dot(du, dv);
        const double vv = glm::dot(dv, dv);
        const glm::dvec2 pull(glm::dot(gravity, du), glm::dot(gravity, dv));
        const double det = uu * vv - uv * uv;
        const glm::dvec2 flow(vv * pull.x - uv * pull.y, uu * pull.y - uv * pull.x);
        const double factor2 = glm::dot(flow, pull) / det;
        return det > 0.0 && factor2 > 1e-8 * glm::dot(gravity, gravity) ? flow / det : glm::dvec2(0.0);
    }
    /// Four times the share of a cell's content that may leave it in a step through faces across an axis.
    double share(int x, int y, int dx) const {
        const glm::dvec2 flow = glm::abs(downhill(x, y));
        const double sum = flow.x + flow.y;
        return sum > 0.0 ? 0.4 + 2.4 * (dx != 0 ? flow.x : flow.y) / sum : 1.0;
    }

    FlowFace face(int x, int y, int dx, int dy) const {
        const Texel a = s.at(x, y);
        const Texel b = s.at(x + dx, y + dy);
        if (a == Texel::cell && b == Texel::cell) {
            const std::size_t i = s.index(x, y);
            const std::size_t j = s.index(x + dx, y + dy);
            const Local la = local(s.metric[i]);
            const Local lb = local(s.metric[j]);
            const double c = 0.5 * (dx == 1 ? la.conductance + lb.conductance : la.inverse + lb.inverse);
            const double k = 0.5 * (la.skew + lb.skew);
            const double across = 0.5 * (slope_of_rise(x, y, dy, dx) + slope_of_rise(x + dx, y + dy, dy, dx));
            const double n = 0.5 * (up[i] + up[j]);
            const double drive = -(c * rise(i, j) + k * across);
            const double portion = drive > 0.0 ? share(x, y, dx) : share(x + dx, y + dy, dx);
            return {c * n, k * n, drive, portion * std::min(s.metric[i].w, s.metric[j].w)};
        }
        if (!open_edges || (a == Texel::cell) == (b == Texel::cell) || a == Texel::gutter ||
            b == Texel::gutter) {
            return {};
        }
        // Over an open border the film goes on as the surface falls just before it.
        const int cx = a == Texel::cell ? x : x + dx;
        const int cy = a == Texel::cell ? y : y + dy;
        const std::size_t i = s.index(cx, cy);
        const glm::dvec2 flow = downhill(cx, cy);
        glm::dvec2 outer(0.0);
        for (int n = 0; n < 9; ++n) {
            const glm::ivec2 way(n % 3 - 1, n / 3 - 1);
            const Texel there = s.at(cx + way.x, cy + way.y);
            outer +=
                there == Texel::nothing || there == Texel::open_gutter ? glm::dvec2(way) : glm::dvec2(0.0);
        }
        if (glm::dot(flow, outer) < 0.3 * glm::length(flow) * glm::length(outer)) {
            return {};
        }
        const Local l = local(s.metric[i]);
        const double drive = -((dx == 1 ? l.conductance : l.inverse) * slope_of_rise(cx, cy, dx, dy) +
                               l.skew * slope_of_rise(cx, cy, dy, dx));
        const bool outward = (a == Texel::cell) == (drive > 0.0);
        return outward ? FlowFace{0.0, 0.0, drive, share(cx, cy, dx) * s.metric[i].w} : FlowFace{};
    }

    void link(int x, int y, int dx, int dy, std::vector<FlowLink>& links) const {
        if (s.at(x, y) != Texel::cell || s.at(x + dx, y + dy) != Texel::gutter) {
            return;
        }
        const std::size_t i = s.index(x, y);
        const std::size_t g = s.index(x + dx, y + dy);
        const glm::dvec2 place = s.seam[g] * glm::dvec2(s.width, s.height) - 0.5;
        const glm::ivec2 low(glm::floor(place));
        const glm::dvec2 t = place - glm::dvec2(low);
        std::array<std::size_t, 4> to{};
        std::array<double, 4> weight{};
        double sum = 0.0;
        for (int n = 0; n < 4; ++n) {
            const glm::ivec2 corner(low.x + (n & 1), low.y + (n >> 1));
            if (s.at(corner.x, corner.y) != Texel::cell) {
                continue;
            }
            const auto slot = static_cast<std::size_t>(n);
            const double w = ((n & 1) != 0 ? t.x : 1.0 - t.x) * ((n >> 1) != 0 ? t.y : 1.0 - t.y);
            to[slot] = s.index(corner.x, corner.y);
            weight[slot] = w > 1e-3 ? w : 0.0;
            sum += weight[slot];
        }
        const Local l = local(s.metric[i]);
        const double c = dx != 0 ? l.conductance : l.inverse;
        const double sign = dx + dy;
        const double across = slope_of_rise(x, y, std::abs(dy), std::abs(dx));
        for (std::size_t n = 0; n < 4; ++n) {
            if (weight[n] > 0.0) {
                const double part = 0.5 * weight[n] / sum;
                links.push_back({i, to[n], part * c * 0.5 * (up[i] + up[to[n]]),
                                 -part * (c * rise(i, g) + sign * l.skew * across),
                                 part * share(x, y, dx) * std::min(s.metric[i].w, s.metric[to[n]].w)});
            }
        }
    }
};

/// Volume that goes from a to b in a step [mm^3], negative the other way.
double exchange(double drive, double spread, double area, double a, double b, const FilmParams& p,
                double dt) {
    const double pinned = std::max(p.pinning_mm - 4.0 * (drive > 0.0 ? b : a), 0.0);
    const double moving = std::max((drive > 0.0 ? a : b) - p.residual_mm - pinned, 0.0);
    const double pull = dt * p.mobility_per_mm_s * std::abs(drive) / 3.0;
    const double most = 0.25 * area;
    // From the height at which the derivative is `most` on, the tangent.
    const double knee = pull > 0.0 ? std::sqrt(most / (3.0 * pull)) : moving;
    const double volume =
        moving > knee ? most * (moving - 2.0 / 3.0 * knee) : pull * moving * moving * moving;
    return std::copysign(std::min(volume, std::abs(drive) * area / (8.0 * std::max(spread, 1e-6))), drive);
}

/// One link between each two cells: what faces of either side add to it.
std::vector<FlowLink> summed_by_pair(const std::vector<FlowLink>& links) {
    std::map<std::pair<std::size_t, std::size_t>, FlowLink> sums;
    for (const FlowLink& link : links) {
        const auto [low, high] = std::minmax(link.from, link.to);
        FlowLink& sum = sums[{low, high}];
        sum.from = low;
        sum.to = high;
        sum.spread += link.spread;
        sum.drive += link.from == low ? link.drive : -link.drive;
        sum.area_mm2 += link.area_mm2;
    }
    std::vector<FlowLink> all;
    for (const auto& [cells, sum] : sums) {
        all.push_back(sum);
    }
    return all;
}

}  // namespace

Flow flow_of(const TissueSurface& surface, const glm::dvec3& gravity, double spreading, bool open_edges) {
    const Builder builder(surface, gravity, spreading, open_edges);
    Flow flow;
    for (int y = 0; y < surface.height; ++y) {
        for (int x = 0; x < surface.width; ++x) {
            flow.right.push_back(builder.face(x, y, 1, 0));
            flow.top.push_back(builder.face(x, y, 0, 1));
            const bool cell = surface.at(x, y) == Texel::cell;
            flow.area_mm2.push_back(cell ? surface.metric[surface.index(x, y)].w : 0.0);
            builder.link(x, y, 1, 0, flow.links);
            builder.link(x, y, -1, 0, flow.links);
            builder.link(x, y, 0, 1, flow.links);
            builder.link(x, y, 0, -1, flow.links);
        }
    }
    flow.links = summed_by_pair(flow.links);
    return flow;
}

void Film::step(const TissueSurface& s, const Flow& flow, const FilmParams& p, double dt) {
    std::vector<double> change(height_mm.size(), 0.0);  // [mm^3]
    std::vector<double> gone(height_mm.size(), 0.0);
    const auto at = [&](std::size_t i) { return height_mm[i]; };
    const auto pass = [&](int x, int y, int dx, int dy, const FlowFace& face) {
        if (face.area_mm2 <= 0.0) {
            return;
        }
        const bool from_cell = s.at(x, y) == Texel::cell;
        const bool to_cell = s.at(x + dx, y + dy) == Texel::cell;
        const std::size_t i = from_cell ? s.index(x, y) : s.index(x + dx, y + dy);
        const std::size_t j = to_cell ? s.index(x + dx, y + dy) : i;
        double drive = face.drive - face.spread * (at(j) - at(i));
        if (face.skew != 0.0) {
            drive -= face.skew * 0.5 * (slope(s, x, y, dy, dx, at) + slope(s, x + dx, y + dy, dy, dx, at));
        }
        const double volume = exchange(drive, face.spread, face.area_mm2, at(i), at(j), p, dt);
        if (from_cell) {
            change[i] -= volume;
        }
        if (to_cell) {
            change[j] += volume;
        }
        if (from_cell != to_cell) {
            gone[i] += std::abs(volume);
        }
    };
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            if (x + 1 < s.width) {
                pass(x, y, 1, 0, flow.right[s.index(x, y)]);
            }
            if (y + 1 < s.height) {
                pass(x, y, 0, 1, flow.top[s.index(x, y)]);
            }
        }
    }
    std::vector<double> came(height_mm.size(), 0.0);
    for (const FlowLink& link : flow.links) {
        const double drive = link.drive - link.spread * (at(link.to) - at(link.from));
        const double volume = exchange(drive, link.spread, link.area_mm2, at(link.from), at(link.to), p, dt);
        came[link.from] -= volume;
        came[link.to] += volume;
    }
    // Gutters show what lay across the seam before the step.
    std::vector<double> across(height_mm.size(), 0.0);
    for (std::size_t i = 0; i < height_mm.size(); ++i) {
        if (s.kind[i] == Texel::gutter) {
            // The nearest cell, which beside a border need not be that at the place.
            const glm::dvec2 place = s.seam[i] * glm::dvec2(s.width, s.height) - 0.5;
            const glm::ivec2 middle(glm::floor(place + 0.5));
            double nearest = 1e9;
            for (int n = 0; n < 9; ++n) {
                const glm::ivec2 to = middle + glm::ivec2(n % 3 - 1, n / 3 - 1);
                const double distance = glm::length(glm::dvec2(to) - place);
                if (s.at(to.x, to.y) == Texel::cell && distance < nearest) {
                    nearest = distance;
                    across[i] = height_mm[s.index(to.x, to.y)];
                }
            }
        }
    }
    for (std::size_t i = 0; i < height_mm.size(); ++i) {
        if (s.kind[i] == Texel::gutter) {
            height_mm[i] = across[i];
        }
        if (flow.area_mm2[i] > 0.0) {
            double h = height_mm[i] + change[i] / flow.area_mm2[i] + owed_mm[i];
            const double dried = std::min(std::max(h, 0.0), p.drying_mm_s * dt);
            gone_mm[i] += gone[i] / flow.area_mm2[i] + dried;
            height_mm[i] = h - dried;
            owed_mm[i] = came[i] / flow.area_mm2[i];
        }
    }
}

double Film::volume_mm3(const Flow& flow) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < height_mm.size(); ++i) {
        sum += (height_mm[i] + owed_mm[i]) * flow.area_mm2[i];
    }
    return sum;
}

double Film::gone_mm3(const Flow& flow) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < gone_mm.size(); ++i) {
        sum += gone_mm[i] * flow.area_mm2[i];
    }
    return sum;
}

}  // namespace viscera::reference
