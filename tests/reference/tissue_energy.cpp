#include "tests/reference/tissue_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace viscera::reference {

double energy_step(double e, double inc, Action action, double e_max) {
    switch (action) {
        case Action::coagulate:
            if (e < 0.0) {
                return -e;
            }
            return e + (e > 0.5 ? 0.5 * inc : inc);
        case Action::ultrasound:
            return e <= 0.9 && std::abs(e) + inc < e_max ? e + inc : e;
        case Action::dissect:
            return e <= 0.02 && std::abs(e) + inc < e_max ? e - inc : e;
    }
    return e;
}

double reach(const Source& source) {
    return source.sigma * std::sqrt(2.0 * std::log(std::max(source.rate / 60.0 * 0x1p24, 1.0)));
}

namespace {

double distance_to_way(const Source& source, const glm::dvec3& place) {
    const glm::dvec3 way = source.to - source.from;
    const double length2 = glm::dot(way, way);
    const double t = length2 > 0.0 ? glm::dot(place - source.from, way) / length2 : 0.0;
    return glm::distance(place, source.from + std::clamp(t, 0.0, 1.0) * way);
}

}  // namespace

double energy_after(double e, std::span<const Source> sources, const glm::dvec3& place, double seconds,
                    int steps, double e_max) {
    const double dt = seconds / steps;
    for (int i = 0; i < steps; ++i) {
        std::array<double, 3> sum{};
        std::array<double, 3> most{};
        for (const Source& source : sources) {
            if (distance_to_way(source, place) >= reach(source)) {
                continue;
            }
            const auto action = static_cast<std::size_t>(source.action);
            const glm::dvec3 at = glm::mix(source.from, source.to, (i + 0.5) / steps);
            const double d = glm::distance(place, at);
            sum[action] += source.rate * dt * std::exp(-d * d / (2.0 * source.sigma * source.sigma));
            most[action] = std::max(most[action], source.rate * dt);
        }
        for (std::size_t action = 0; action < 3; ++action) {
            if (sum[action] > 0.0) {
                e = energy_step(e, std::min(sum[action], most[action]), static_cast<Action>(action), e_max);
            }
        }
    }
    return e;
}

double stroke_energy(double power, double speed, double s, double length, double x, double y) {
    const double width = s * std::numbers::sqrt2;
    return power / (speed * 2.0 * std::numbers::pi * s * s) * std::exp(-y * y / (2.0 * s * s)) * s *
           std::sqrt(std::numbers::pi / 2.0) * (std::erf((length - x) / width) + std::erf(x / width));
}

double mean_gaussian(const glm::dvec3& a, const glm::dvec3& b, double s, const glm::dvec3& place) {
    const int pieces = 1 + static_cast<int>(std::ceil(glm::distance(a, b) / (0.05 * s)));
    const double offset = 0.5 / std::numbers::sqrt3;
    double sum = 0.0;
    for (int i = 0; i < pieces; ++i) {
        for (const double sign : {-1.0, 1.0}) {
            const double d = glm::distance(place, glm::mix(a, b, (i + 0.5 + sign * offset) / pieces));
            sum += 0.5 * std::exp(-d * d / (2.0 * s * s));
        }
    }
    return sum / pieces;
}

}  // namespace viscera::reference
