#include "effects/tissue/surface_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace viscera::tissue {
namespace {

constexpr std::size_t leaf_size = 4;
constexpr std::size_t deepest = 64;
constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Weights of the second and third corner at the point of a triangle that is nearest to p (C. Ericson,
/// Real-Time Collision Detection, 5.1.5).
glm::dvec2 nearest_weights(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                           const glm::dvec3& c) {
    const glm::dvec3 ab = b - a;
    const glm::dvec3 ac = c - a;
    const double d1 = glm::dot(ab, p - a);
    const double d2 = glm::dot(ac, p - a);
    if (d1 <= 0.0 && d2 <= 0.0) {
        return {0.0, 0.0};
    }
    const double d3 = glm::dot(ab, p - b);
    const double d4 = glm::dot(ac, p - b);
    if (d3 >= 0.0 && d4 <= d3) {
        return {1.0, 0.0};
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        return {d1 / (d1 - d3), 0.0};
    }
    const double d5 = glm::dot(ab, p - c);
    const double d6 = glm::dot(ac, p - c);
    if (d6 >= 0.0 && d5 <= d6) {
        return {0.0, 1.0};
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        return {0.0, d2 / (d2 - d6)};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {1.0 - w, w};
    }
    const double sum = va + vb + vc;
    return {vb / sum, vc / sum};
}

/// Share of a way at which it enters a box; none when it misses.
std::optional<double> entry(const glm::dvec3& from, const glm::dvec3& inverse, double farthest,
                            const glm::dvec3& low, const glm::dvec3& high) {
    double near = 0.0;
    double far = farthest;
    for (int axis = 0; axis < 3; ++axis) {
        double a = (low[axis] - from[axis]) * inverse[axis];
        double b = (high[axis] - from[axis]) * inverse[axis];
        // A way within the plane of a face gives 0 times infinity; such a face does not bound it.
        a = std::isnan(a) ? -unbounded : a;
        b = std::isnan(b) ? unbounded : b;
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return near <= far ? std::optional(near) : std::nullopt;
}

}  // namespace

std::optional<FoundPoint> nearest_point(const MeshData& mesh, const glm::dmat4& to_world,
                                        const glm::dvec3& place_mm) {
    std::optional<FoundPoint> best;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<glm::dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] =
                glm::dvec3(to_world * glm::dvec4(glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]), 1.0));
        }
        // A corner's distance less the longest side bounds the triangle's from below.
        const double reach =
            std::sqrt(std::max(glm::dot(p[1] - p[0], p[1] - p[0]), glm::dot(p[2] - p[0], p[2] - p[0])));
        const double corner = glm::length(place_mm - p[0]);
        if (best && corner - reach > best->distance) {
            continue;
        }
        const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
        if (!(glm::dot(normal, normal) > 0.0)) {
            continue;
        }
        const glm::dvec2 w = nearest_weights(place_mm, p[0], p[1], p[2]);
        const glm::dvec3 point = p[0] + w.x * (p[1] - p[0]) + w.y * (p[2] - p[0]);
        const double distance = glm::length(point - place_mm);
        if (!best || distance < best->distance) {
            const glm::dvec2 uv(mesh.uvs[mesh.indices[3 * t]]);
            const glm::dvec2 uv1(mesh.uvs[mesh.indices[3 * t + 1]]);
            const glm::dvec2 uv2(mesh.uvs[mesh.indices[3 * t + 2]]);
            best = {static_cast<std::uint32_t>(t), point, uv + w.x * (uv1 - uv) + w.y * (uv2 - uv), distance};
        }
    }
    return best;
}

glm::vec2 within_texture(const glm::dvec2& uv) {
    glm::vec2 within(0.0F);
    for (int axis = 0; axis < 2; ++axis) {
        const double whole = uv[axis] >= 0.0 && uv[axis] <= 1.0 ? 0.0 : std::floor(uv[axis]);
        within[axis] = std::min(static_cast<float>(uv[axis] - whole), std::nextafter(1.0F, 0.0F));
    }
    return within;
}

TriangleTree::TriangleTree(const MeshData& mesh, const glm::dmat4& to_world) {
    triangles_.reserve(mesh.triangle_count());
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto corner = [&](std::size_t k) { return mesh.indices[3 * t + k]; };
        const auto place = [&](std::size_t k) {
            return glm::dvec3(to_world * glm::dvec4(glm::dvec3(mesh.positions[corner(k)]), 1.0));
        };
        Triangle triangle;
        triangle.p = place(0);
        triangle.e1 = place(1) - triangle.p;
        triangle.e2 = place(2) - triangle.p;
        triangle.uv = mesh.uvs[corner(0)];
        triangle.d1 = glm::dvec2(mesh.uvs[corner(1)]) - triangle.uv;
        triangle.d2 = glm::dvec2(mesh.uvs[corner(2)]) - triangle.uv;
        triangle.index = static_cast<std::uint32_t>(t);
        const glm::dvec3 normal = glm::cross(triangle.e1, triangle.e2);
        if (glm::dot(normal, normal) > 0.0) {
            triangles_.push_back(triangle);
        }
    }
    if (!triangles_.empty()) {
        build(0, triangles_.size());
    }
}

void TriangleTree::build(std::size_t first, std::size_t count) {
    const std::size_t self = nodes_.size();
    nodes_.emplace_back();
    glm::dvec3 low(std::numeric_limits<double>::max());
    glm::dvec3 high(std::numeric_limits<double>::lowest());
    for (std::size_t i = first; i < first + count; ++i) {
        const Triangle& t = triangles_[i];
        low = glm::min(low, glm::min(t.p, glm::min(t.p + t.e1, t.p + t.e2)));
        high = glm::max(high, glm::max(t.p, glm::max(t.p + t.e1, t.p + t.e2)));
    }
    nodes_[self].low = low;
    nodes_[self].high = high;
    if (count <= leaf_size) {
        nodes_[self].first = static_cast<std::uint32_t>(first);
        nodes_[self].count = static_cast<std::uint32_t>(count);
        return;
    }
    const glm::dvec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = triangles_.begin() + static_cast<std::ptrdiff_t>(first + count / 2);
    std::nth_element(triangles_.begin() + static_cast<std::ptrdiff_t>(first), middle,
                     triangles_.begin() + static_cast<std::ptrdiff_t>(first + count),
                     [axis](const Triangle& a, const Triangle& b) {
                         const double x = a.p[axis] + (a.e1[axis] + a.e2[axis]) / 3.0;
                         const double y = b.p[axis] + (b.e1[axis] + b.e2[axis]) / 3.0;
                         return x != y ? x < y : a.index < b.index;
                     });
    build(first, count / 2);
    nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
    build(first + count / 2, count - count / 2);
}

std::optional<FoundPoint> TriangleTree::nearest(const glm::dvec3& place_mm) const {
    std::optional<FoundPoint> best;
    const auto away = [&](std::uint32_t at) {
        return glm::length(place_mm - glm::clamp(place_mm, nodes_[at].low, nodes_[at].high));
    };
    std::array<std::uint32_t, deepest> stack{};
    std::size_t held = nodes_.empty() ? 0 : 1;
    while (held > 0) {
        const std::uint32_t at = stack[--held];
        const Node& node = nodes_[at];
        if (best && away(at) > best->distance) {
            continue;
        }
        if (node.count == 0) {
            const std::uint32_t next = at + 1;
            const bool first_is_near = away(next) < away(node.first);
            stack[held++] = first_is_near ? node.first : next;
            stack[held++] = first_is_near ? next : node.first;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Triangle& t = triangles_[i];
            const glm::dvec2 w = nearest_weights(place_mm, t.p, t.p + t.e1, t.p + t.e2);
            const glm::dvec3 point = t.p + w.x * t.e1 + w.y * t.e2;
            const double distance = glm::length(point - place_mm);
            // Of equals the first of the file.
            if (!best || distance < best->distance ||
                (distance == best->distance && t.index < best->triangle)) {
                best = {t.index, point, t.uv + w.x * t.d1 + w.y * t.d2, distance};
            }
        }
    }
    return best;
}

std::optional<FoundPoint> TriangleTree::first_hit(const glm::dvec3& from, const glm::dvec3& to) const {
    if (nodes_.empty()) {
        return std::nullopt;
    }
    const glm::dvec3 way = to - from;
    const glm::dvec3 inverse = 1.0 / way;
    std::optional<FoundPoint> best;
    double farthest = 1.0;
    std::array<std::uint32_t, deepest> stack{};
    std::size_t held = 1;
    while (held > 0) {
        const std::uint32_t at = stack[--held];
        const Node& node = nodes_[at];
        if (!entry(from, inverse, farthest, node.low, node.high)) {
            continue;
        }
        if (node.count == 0) {
            stack[held++] = node.first;
            stack[held++] = at + 1;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Triangle& t = triangles_[i];
            const glm::dvec3 h = glm::cross(way, t.e2);
            const double det = glm::dot(t.e1, h);
            if (det == 0.0) {
                continue;
            }
            const glm::dvec3 s = from - t.p;
            const double u = glm::dot(s, h) / det;
            const glm::dvec3 q = glm::cross(s, t.e1);
            const double v = glm::dot(way, q) / det;
            const double share = glm::dot(t.e2, q) / det;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && share >= 0.0 && share <= farthest) {
                farthest = share;
                best = {t.index, from + share * way, t.uv + u * t.d1 + v * t.d2, share};
            }
        }
    }
    return best;
}

}  // namespace viscera::tissue
