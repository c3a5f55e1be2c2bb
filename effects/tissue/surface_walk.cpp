#include "effects/tissue/surface_walk.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace viscera::tissue {
namespace {

/// The part of a triangle's plane that points from the line through `a` along the unit vector `edge` to its
/// third corner, unit length; 0 for a triangle without area.
glm::dvec3 inward(const glm::dvec3& a, const glm::dvec3& edge, const glm::dvec3& third) {
    const glm::dvec3 to_third = third - a;
    const glm::dvec3 across = to_third - glm::dot(to_third, edge) * edge;
    const double length = glm::length(across);
    // Against rounding of the difference.
    return length > 1e-12 * glm::length(to_third) ? across / length : glm::dvec3(0.0);
}

}  // namespace

/// Turns `way` about a half-edge into the plane of the triangle on the other side.
bool SurfaceWalk::cross(std::uint32_t half_edge, glm::dvec3& way, std::uint32_t& entered) const {
    entered = adjacency_.across[half_edge];
    if (entered == MeshAdjacency::none) {
        return false;
    }
    const glm::dvec3 a = corner(half_edge);
    const glm::dvec3 b = corner(MeshAdjacency::next(half_edge));
    const double length = glm::length(b - a);
    if (!(length > 0.0)) {
        return false;
    }
    const glm::dvec3 edge = (b - a) / length;
    const glm::dvec3 out = -inward(a, edge, corner(MeshAdjacency::previous(half_edge)));
    const glm::dvec3 in = inward(a, edge, corner(MeshAdjacency::previous(entered)));
    if (out == glm::dvec3(0.0) || in == glm::dvec3(0.0)) {
        return false;
    }
    way = glm::dot(way, edge) * edge + glm::dot(way, out) * in;
    return true;
}

bool SurfaceWalk::leave(std::uint32_t half_edge, double along, const glm::dvec3& way,
                        SurfacePoint& end) const {
    glm::dvec3 left = way;
    std::uint32_t entered = MeshAdjacency::none;
    if (!cross(half_edge, left, entered)) {
        return false;
    }
    glm::dvec3 place = glm::mix(corner(half_edge), corner(MeshAdjacency::next(half_edge)), along);
    // A gutter is a few texels wide: more triangles than this are finer than texels by far.
    constexpr int most_steps = 512;
    for (int step = 0; step < most_steps; ++step) {
        // Corners from the edge that was entered by: weights of the two on it, and of the third.
        const std::array<std::uint32_t, 3> side{entered, MeshAdjacency::next(entered),
                                                MeshAdjacency::previous(entered)};
        const std::array<glm::dvec3, 3> p{corner(side[0]), corner(side[1]), corner(side[2])};
        const glm::dvec3 e1 = p[1] - p[0];
        const glm::dvec3 e2 = p[2] - p[0];
        const glm::dvec3 normal = glm::cross(e1, e2);
        const double area2 = glm::dot(normal, normal);
        const auto weights = [&](const glm::dvec3& v) {
            return glm::dvec2(glm::dot(glm::cross(v, e2), normal), glm::dot(glm::cross(e1, v), normal)) /
                   area2;
        };
        const glm::dvec2 at = weights(place - p[0]);
        const glm::dvec2 rate = weights(left);
        const std::array<double, 3> w{1.0 - at.x - at.y, at.x, at.y};
        const std::array<double, 3> dw{-rate.x - rate.y, rate.x, rate.y};
        // The edge opposite to a corner whose weight falls to 0 is passed; the one opposite to the third
        // corner is where the triangle was entered.
        double part = 1.0;
        std::size_t passed = 2;
        for (std::size_t k = 0; k < 2; ++k) {
            const double until = dw[k] < 0.0 ? std::max(w[k], 0.0) / -dw[k] : 2.0;
            if (until < part) {
                part = until;
                passed = k;
            }
        }
        place += part * left;
        left *= 1.0 - part;
        std::uint32_t exit = passed == 0 ? side[1] : side[2];
        std::uint32_t next = MeshAdjacency::none;
        if (passed == 2 || !cross(exit, left, next) || step + 1 == most_steps) {
            std::array<double, 3> weight{};
            double sum = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                weight[side[k] % 3] = std::max(w[k] + part * dw[k], 0.0);
                sum += weight[side[k] % 3];
            }
            end = {entered / 3, weight[1] / sum, weight[2] / sum};
            return std::isfinite(end.b1 + end.b2);
        }
        entered = next;
    }
    return false;
}

}  // namespace viscera::tissue
