#include "effects/tissue/jets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace viscera::tissue {
namespace {

constexpr std::size_t most_particles = 4096;
constexpr double longest_flight_s = 3.0;
constexpr double speed_scatter = 0.06;
constexpr double direction_scatter = 0.04;
// A particle starts this far out, so that it does not meet the wound it comes from.
constexpr double start_mm = 0.2;
// Around the place that a particle meets, the drop that it becomes.
constexpr double splash_mm = 0.7;

}  // namespace

void Jets::clear() {
    particles_.clear();
    particles_.reserve(most_particles);
    lost_mm3_ = 0.0;
    drawn_ = 0;
}

/// In [-1, 1), from the number of those drawn before (splitmix64).
double Jets::noise() {
    std::uint64_t x = ++drawn_ * 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    x ^= x >> 31;
    return static_cast<double>(x >> 11) * 0x1p-52 - 1.0;
}

void Jets::leave(const WoundParams& wound, const glm::vec2& uv, const DropMeter::Drops& drops, double pulse,
                 const glm::dvec3& gravity_mm_s2, double dt_s) {
    const double length = glm::length(wound.direction);
    const glm::dvec3 direction = length > 0.0 ? wound.direction / length : glm::dvec3(0.0);
    for (int i = 0; i < drops.count; ++i) {
        const double speed = wound.speed_mm_s * pulse * (1.0 + speed_scatter * noise());
        const glm::dvec3 scatter(noise(), noise(), noise());
        const glm::dvec3 velocity = speed * (direction + direction_scatter * scatter);
        const double since = 0.5 * (1.0 + noise()) * dt_s;
        if (particles_.size() >= most_particles) {
            lost_mm3_ += drops.volume_mm3;
            continue;
        }
        const glm::dvec3 flown = since * (velocity + 0.5 * since * gravity_mm_s2);
        particles_.push_back({.position_mm = wound.position_mm + start_mm * direction + flown,
                              .velocity_mm_s = velocity + since * gravity_mm_s2,
                              .volume_mm3 = drops.volume_mm3,
                              .sealed_at = uv});
    }
}

void Jets::step(const TriangleTree& surface, const glm::dvec3& gravity_mm_s2, double dt_s,
                std::vector<DropSpawn>& hits) {
    const auto flies_on = [&](JetParticle& particle) {
        const glm::dvec3 to =
            particle.position_mm + dt_s * (particle.velocity_mm_s + 0.5 * dt_s * gravity_mm_s2);
        if (const auto hit = surface.first_hit(particle.position_mm, to)) {
            hits.push_back({.uv = glm::vec2(hit->uv - glm::floor(hit->uv)),
                            .volume_mm3 = static_cast<float>(particle.volume_mm3),
                            .radius_mm = static_cast<float>(splash_mm),
                            .sealed_at = particle.sealed_at});
            return false;
        }
        particle.position_mm = to;
        particle.velocity_mm_s += dt_s * gravity_mm_s2;
        particle.age_s += dt_s;
        if (particle.age_s > longest_flight_s) {
            lost_mm3_ += particle.volume_mm3;
            return false;
        }
        return true;
    };
    // In order, so that the same drops come in the same order everywhere.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < particles_.size(); ++i) {
        JetParticle particle = particles_[i];
        if (flies_on(particle)) {
            particles_[kept++] = particle;
        }
    }
    particles_.resize(kept);
}

double Jets::flying_mm3() const {
    double sum = 0.0;
    for (const JetParticle& particle : particles_) {
        sum += particle.volume_mm3;
    }
    return sum;
}

}  // namespace viscera::tissue
