#include "effects/tissue/jets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace viscera::tissue {
namespace {

constexpr double longest_flight_s = 3.0;
// Volumes of drops are spread evenly over their logarithm, from the mean's quarter to its fourfold.
constexpr double size_scatter = 1.4;
// Of drops of the mean volume; smaller ones are thrown further.
constexpr double speed_scatter = 0.02;
constexpr double direction_scatter = 0.02;
constexpr double breakup_scatter = 0.3;
// Of a stream: growth until breakup, and the square root of density over surface tension (1060 kg/m^3, 0.055
// N/m).
constexpr double breakup_growth = 13.0;
constexpr double inertia_s_mm = 4.39e-3;  // [s per mm^1.5]
// A particle starts this far out, so that it does not meet the wound it comes from.
constexpr double start_mm = 0.2;
// Around the place that a particle meets, the drop that it becomes.
constexpr double splash_mm = 0.7;
// What splashes off it: drops, each with a share of its volume, further around it.
constexpr int spatter_drops = 3;
constexpr double spatter_share = 0.06;
constexpr double spatter_mm = 4.0;

}  // namespace

double thread_s(const JetParticle& particle) {
    // It draws together from three quarters of that age to five.
    const double t = particle.breakup_s > 0.0
                         ? std::clamp(2.0 * particle.age_s / particle.breakup_s - 1.5, 0.0, 1.0)
                         : 1.0;
    return particle.leaving_s * (1.0 - t * t * (3.0 - 2.0 * t));
}

double breakup_time_s(double rate_mm3_s, double speed_mm_s) {
    if (!(rate_mm3_s > 0.0 && speed_mm_s > 0.0)) {
        return 0.0;
    }
    const double diameter_mm = std::sqrt(4.0 / std::numbers::pi * rate_mm3_s / speed_mm_s);
    return breakup_growth * inertia_s_mm * diameter_mm * std::sqrt(diameter_mm);
}

void Jets::clear() {
    particles_.clear();
    particles_.reserve(most_particles);
    lost_mm3_ = 0.0;
    refused_ = 0;
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
                 double dt_s) {
    const double length = glm::length(wound.direction);
    const glm::dvec3 direction = length > 0.0 ? wound.direction / length : glm::dvec3(0.0);
    const double whole = drops.count * drops.volume_mm3;
    volumes_.clear();
    for (int i = 0; i < drops.count; ++i) {
        volumes_.push_back(std::exp(size_scatter * noise()));
    }
    const double sum = std::accumulate(volumes_.begin(), volumes_.end(), 0.0);
    const double rate = wound.rate_mm3_s * pulse;
    const double breakup = breakup_time_s(rate, wound.speed_mm_s * pulse);
    double left = 0.0;  // share of the step's blood that has left
    for (double volume : volumes_) {
        const double share = volume / sum;
        volume = share * whole;
        // One after the other, the last one at the end of the step.
        const double since = (1.0 - left - 0.5 * share) * dt_s;
        left += share;
        const double scatter = std::cbrt(drops.volume_mm3 / volume);
        const double speed = wound.speed_mm_s * pulse * (1.0 + scatter * speed_scatter * noise());
        const glm::dvec3 aside(noise(), noise(), noise());
        const glm::dvec3 velocity = speed * (direction + scatter * direction_scatter * aside);
        const double breaks = breakup * (1.0 + breakup_scatter * noise());
        if (particles_.size() >= most_particles) {
            lost_mm3_ += volume;
            ++refused_;
            continue;
        }
        particles_.push_back({.position_mm = wound.position_mm + start_mm * direction,
                              .velocity_mm_s = velocity,
                              .volume_mm3 = volume,
                              .age_s = since - dt_s,
                              .leaving_s = rate > 0.0 ? volume / rate : 0.0,
                              .breakup_s = breaks,
                              .sealed_at = uv});
    }
}

void Jets::step(const TriangleTree& surface, const glm::dvec3& gravity_mm_s2, double dt_s,
                std::vector<DropSpawn>& hits) {
    const auto flies_on = [&](JetParticle& particle) {
        const double time = std::min(dt_s, dt_s + particle.age_s);
        const glm::dvec3 to =
            particle.position_mm + time * (particle.velocity_mm_s + 0.5 * time * gravity_mm_s2);
        if (const auto hit = surface.first_hit(particle.position_mm, to)) {
            for (int i = 0; i <= spatter_drops; ++i) {
                const double share = i == 0 ? 1.0 - spatter_drops * spatter_share : spatter_share;
                hits.push_back({.uv = within_texture(hit->uv),
                                .volume_mm3 = static_cast<float>(share * particle.volume_mm3),
                                .radius_mm = static_cast<float>(i == 0 ? splash_mm : spatter_mm),
                                .sealed_at = particle.sealed_at});
            }
            return false;
        }
        particle.position_mm = to;
        particle.velocity_mm_s += time * gravity_mm_s2;
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
