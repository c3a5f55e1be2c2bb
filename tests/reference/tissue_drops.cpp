#include "tests/reference/tissue_drops.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace viscera::reference {
namespace {

using Texel = TissueSurface::Texel;

constexpr double longest_step_px = 2.0;
constexpr double giving_up_s = 0.05;
constexpr double longest_end_s = 1.0;
constexpr double slowest_mm_s = 0.02;

glm::ivec2 texel_of(const glm::dvec2& px) {
    return {glm::floor(px)};
}

}  // namespace

double DropWay::radius_mm(double volume_mm3) const {
    return std::cbrt(2.0 * volume_mm3 / (std::numbers::pi * params_.aspect));
}

glm::dvec4 DropWay::gravity(const glm::dvec2& px) const {
    const glm::ivec2 at = texel_of(px);
    return gravity_[surface_.index(at.x, at.y)];
}

/// Where the centre of a gutter's texel lies [texels].
glm::dvec2 DropWay::jump(const glm::ivec2& gutter) const {
    return surface_.seam[surface_.index(gutter.x, gutter.y)] * glm::dvec2(surface_.width, surface_.height);
}

DropWay::Place DropWay::place(const glm::dvec2& px) const {
    const glm::ivec2 at = texel_of(px);
    const Texel kind = surface_.at(at.x, at.y);
    if (kind != Texel::gutter) {
        return {px, kind == Texel::cell ? Where::here : Where::nowhere};
    }
    const glm::dvec2 centre = jump(at);
    const glm::dvec2 offset = px - (glm::dvec2(at) + 0.5);
    glm::dvec2 to = centre;
    for (int axis = 0; axis < 2; ++axis) {
        const glm::ivec2 unit(1 - axis, axis);
        for (const int side : {1, -1}) {
            const glm::ivec2 next = at + side * unit;
            if (surface_.at(next.x, next.y) != Texel::gutter) {
                continue;
            }
            const glm::dvec2 slope = (jump(next) - centre) * static_cast<double>(side);
            if (glm::dot(slope, slope) < 9.0) {
                to += offset[axis] * slope;
                break;
            }
        }
    }
    const auto lies = [&](const glm::dvec2& candidate) {
        const glm::ivec2 texel = texel_of(candidate);
        return surface_.at(texel.x, texel.y) == Texel::cell;
    };
    if (lies(to)) {
        return {to, Where::across};
    }
    if (lies(centre)) {
        return {centre, Where::across};
    }
    for (int i = 0; i < 9; ++i) {
        const glm::dvec2 candidate = centre + glm::dvec2(i % 3 - 1, i / 3 - 1);
        if (lies(candidate)) {
            return {candidate, Where::across};
        }
    }
    return {centre, Where::nowhere};
}

DropStep DropWay::step(const Drop& drop, double dt) const {
    const glm::dvec2 size(surface_.width, surface_.height);
    const glm::dvec2 from = drop.uv * size;
    const double radius = radius_mm(drop.volume_mm3);
    const double height = params_.aspect * radius;
    const double fastest = params_.mobility_per_mm_s / 3.0 * height * height * params_.strength;
    const auto velocity = [&](const glm::dvec4& g) { return glm::dvec2(g) * (g.z * g.w * fastest) * size; };
    const auto cap = [&](const glm::dvec2& v) {
        return std::min(1.0, longest_step_px / std::max(glm::length(v) * dt, 1e-20));
    };
    const glm::dvec2 v0 = velocity(gravity(from));
    const Place middle = place(from + 0.5 * dt * cap(v0) * v0);
    const glm::dvec4 g1 = middle.where == Where::nowhere ? gravity(from) : gravity(middle.px);
    const glm::dvec2 v1 = velocity(g1);
    const bool crossed = middle.where == Where::across;
    const Place to = crossed ? place(middle.px + 0.5 * dt * cap(v1) * v1) : place(from + dt * cap(v1) * v1);
    const double speed = fastest * g1.z * cap(v1);

    DropStep result;
    const bool falls = to.where == Where::nowhere;
    double deposit = params_.trail_mm * 2.0 * radius * speed * dt;
    if (speed < slowest_mm_s || drop.age_s > params_.life_s || (falls && !params_.open_edges)) {
        deposit = std::max(deposit, -drop.volume_mm3 * std::expm1(-dt / giving_up_s));
    }
    result.fell = falls && params_.open_edges;
    double left = result.fell ? 0.0 : std::max(drop.volume_mm3 - deposit, 0.0);
    if (left < params_.smallest_mm3 || drop.age_s > params_.life_s + longest_end_s) {
        left = 0.0;
    }
    result.left_mm3 = drop.volume_mm3 - left;
    result.across_seam = crossed || to.where == Where::across;
    if (left > 0.0) {
        result.drop = {(falls ? from : to.px) / size, left, drop.age_s + dt};
    }
    return result;
}

}  // namespace viscera::reference
