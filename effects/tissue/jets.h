#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/blood_medium.h"
#include "effects/tissue/blood_sources.h"
#include "effects/tissue/surface_search.h"

namespace viscera::tissue {

/// Blood in the air: at first a piece of a stream, then a drop.
struct JetParticle {
    glm::dvec3 position_mm{0.0};
    glm::dvec3 velocity_mm_s{0.0};
    double volume_mm3 = 0.0;
    double age_s = 0.0;          ///< below 0: until it leaves, in the step that comes
    double leaving_s = 0.0;      ///< time in which it left the wound
    double breakup_s = 0.0;      ///< age at which the stream has become drops
    glm::vec2 sealed_at{-1.0F};  ///< UV of the wound
};

/// Length of the piece of a stream that a particle still is, as the time in which it flies that far [s]; 0
/// for a drop.
[[nodiscard]] double thread_s(const JetParticle& particle);

/// Age at which a stream of blood breaks up into drops [s]: the capillary instability of its surface has
/// grown as deep as the stream. `rate_mm3_s`, `speed_mm_s`: at which it leaves; 0 where either is not above
/// 0. Source: C. Weber, "Zum Zerfall eines Fluessigkeitsstrahles" (1931); 13 times sqrt(density d^3 /
/// tension).
[[nodiscard]] double breakup_time_s(double rate_mm3_s, double speed_mm_s);

/// Jets of blood: particles that fly freely until they meet a surface. The same steps give the same
/// particles.
class Jets {
  public:
    static constexpr std::size_t most_particles = 4096;

    void clear();
    /// Blood that leaves a wound at `uv` during the step that comes: as many particles as drops, of the same
    /// volume together, whose sizes differ. What is more than most_particles is lost.
    void leave(const WoundParams& wound, const glm::vec2& uv, const DropMeter::Drops& drops, double pulse,
               double dt_s);
    /// Moves all by one step, those that leave in it by what is left of it then. What meets the surface is
    /// taken away and comes out as new drops, with spatter around; what flies for too long is lost.
    /// `gravity_mm_s2`: acceleration.
    void step(const TriangleTree& surface, const glm::dvec3& gravity_mm_s2, double dt_s,
              std::vector<DropSpawn>& hits);

    [[nodiscard]] std::span<const JetParticle> particles() const { return particles_; }
    [[nodiscard]] double flying_mm3() const;
    [[nodiscard]] double lost_mm3() const { return lost_mm3_; }
    /// Particles for which there was no room.
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

  private:
    [[nodiscard]] double noise();

    std::vector<JetParticle> particles_;
    std::vector<double> volumes_;
    double lost_mm3_ = 0.0;
    std::uint64_t refused_ = 0;
    std::uint64_t drawn_ = 0;
};

}  // namespace viscera::tissue
