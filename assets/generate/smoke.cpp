#include "assets/generate/smoke.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "assets/generate/noise.h"

namespace viscera::assets {
namespace {

// The grid that the field is sampled on.
constexpr glm::dvec3 grid_low(-0.42, -0.06, -0.42);
constexpr glm::ivec3 grid_size(126, 138, 126);
constexpr double grid_step = 1.0 / 150.0;

double smoothstep(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// Axis of the plume at height y: it leans and sways a little.
glm::dvec2 axis_at(double y) {
    return {-0.07 * y + 0.018 * std::sin(9.0 * y), 0.02 * std::sin(7.0 * y + 1.0) - 0.02 * std::sin(1.0)};
}

/// Half width of the plume at height y.
double half_width(double y) {
    return 0.022 + 0.4 * std::pow(std::max(0.0, y), 0.9);
}

/// Density of the plume at p, >= 0.
double plume(const glm::dvec3& p, std::uint32_t seed) {
    const double grown = smoothstep(0.0, 0.3, p.y);
    if (glm::length(glm::dvec2(p.x, p.z) - axis_at(p.y)) > half_width(p.y) + 0.13) {
        return 0.0;
    }
    // Curling: the domain is warped, more so the further the smoke has travelled.
    const glm::dvec3 q = p + (0.015 + 0.06 * grown) * fractal_warp(p * 5.0, 3, seed);
    const glm::dvec2 off_axis = glm::dvec2(q.x, q.z) - axis_at(q.y);
    const double rim = 1.0 - glm::length(off_axis) / half_width(q.y);
    const double head = 1.0 - std::max(0.0, q.y - 0.22) / 0.5;
    const double billowing = 0.2 + 0.45 * grown;
    constexpr double calm = 0.46;  // noise above it carves into the plume, below it bulges
    if (std::min(rim, head) + billowing * calm <= 0.0) {
        return 0.0;
    }
    const double start = smoothstep(-0.03, 0.012, q.y);
    // Billows: folded noise, round outside and creased between.
    const glm::dvec3 fine = q * 8.5 + 0.5 * fractal_warp(q * 9.0, 2, seed + 7U);
    const double billow = std::abs(gradient_noise(fine, seed + 11U)) +
                          0.5 * std::abs(gradient_noise(fine * 2.1, seed + 12U)) +
                          0.25 * std::abs(gradient_noise(fine * 4.3, seed + 13U));
    const double body = std::min(rim, head) + billowing * (calm - billow);
    // The same dye spreads over a growing section.
    const double thinned = std::pow(half_width(0.05) / half_width(std::max(q.y, 0.05)), 1.25);
    return start * smoothstep(0.0, 0.75, body) * thinned;
}

/// 1 inside, exactly 0 along the border of the unit square.
double border_window(double u, double v, double width) {
    const double nearest = std::min({u, v, 1.0 - u, 1.0 - v});
    return smoothstep(0.0, width, nearest);
}

/// Where a line enters and leaves the grid; enter > leave when it misses.
std::pair<double, double> through_grid(const glm::dvec3& origin, const glm::dvec3& direction) {
    const glm::dvec3 grid_high = grid_low + glm::dvec3(grid_size - 1) * grid_step;
    double enter = -2.0;
    double leave = 2.0;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(direction[axis]) < 1e-12) {
            const bool outside = origin[axis] < grid_low[axis] || origin[axis] > grid_high[axis];
            leave = outside ? enter - 1.0 : leave;
            continue;
        }
        const double a = (grid_low[axis] - origin[axis]) / direction[axis];
        const double b = (grid_high[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return {enter, leave};
}

/// UV of a pixel, running from 0 at the first pixel to 1 at the last, so that border pixels are the border.
glm::dvec2 pixel_uv(int x, int y, int size) {
    return glm::dvec2(x, size - 1 - y) / static_cast<double>(size - 1);
}

}  // namespace

Smoke::Smoke(std::uint32_t seed) {
    density_.reserve(static_cast<std::size_t>(grid_size.x * grid_size.y * grid_size.z));
    for (int z = 0; z < grid_size.z; ++z) {
        for (int y = 0; y < grid_size.y; ++y) {
            for (int x = 0; x < grid_size.x; ++x) {
                density_.push_back(
                    static_cast<float>(plume(grid_low + glm::dvec3(x, y, z) * grid_step, seed)));
            }
        }
    }
}

float Smoke::sample(const glm::dvec3& p) const {
    const glm::dvec3 g = (p - grid_low) / grid_step;
    const glm::ivec3 i(glm::floor(g));
    if (glm::any(glm::lessThan(i, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(i, grid_size - 1))) {
        return 0.0F;
    }
    const glm::vec3 f(g - glm::dvec3(i));
    const auto row = [&](int dy, int dz) {
        const std::size_t at =
            static_cast<std::size_t>(i.x + grid_size.x * (i.y + dy + grid_size.y * (i.z + dz)));
        return glm::mix(density_[at], density_[at + 1], f.x);
    };
    return glm::mix(glm::mix(row(0, 0), row(1, 0), f.y), glm::mix(row(0, 1), row(1, 1), f.y), f.z);
}

GrayImage Smoke::project(const SmokeView& view, int size) const {
    constexpr double step = 1.25 * grid_step;
    constexpr double opacity = 26.0;                           // per unit length at density 1
    const double angle = glm::radians(90.0 - view.angle_deg);  // away from the side view
    const glm::dvec3 up(0.0, std::cos(angle), std::sin(angle));
    const glm::dvec3 sight(0.0, std::sin(angle), -std::cos(angle));
    GrayImage image(size, size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const glm::dvec2 uv = pixel_uv(x, y, size);
            const glm::dvec2 offset = (uv - view.base_uv) / view.magnification;
            const glm::dvec3 origin = glm::dvec3(offset.x, 0.0, 0.0) + offset.y * up;
            const auto [enter, leave] = through_grid(origin, sight);
            double thickness = 0.0;
            for (double t = std::ceil(enter / step) * step; t <= leave; t += step) {
                thickness += static_cast<double>(sample(origin + t * sight));
            }
            image.at(x, y) = static_cast<float>((1.0 - std::exp(-opacity * step * thickness)) *
                                                border_window(uv.x, uv.y, 0.1));
        }
    }
    return image;
}

}  // namespace viscera::assets
