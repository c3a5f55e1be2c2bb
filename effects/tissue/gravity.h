#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/gl/program.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/frame.h"

namespace viscera {
class Assets;
class Log;
class Pass;
}  // namespace viscera

namespace viscera::tissue {

inline constexpr double standard_gravity_m_s2 = 9.80665;
inline constexpr double most_gravity_m_s2 = 1000.0;  ///< along each axis

/// Which way is down, and how strongly things fall.
struct GravityParams {
    glm::dvec3 gravity_m_s2{0.0, standard_gravity_m_s2, 0.0};
    std::string host_gravity = "tissue.gravity";
    double spreading = 0.15;
    double relief_pull = 16.0;

    void visit(ParamVisitor& v);
};

/// Gravity of one frame.
struct Gravity {
    glm::dvec3 down{0.0};   ///< unit vector, or 0 where nothing falls
    double strength = 0.0;  ///< in units of standard gravity

    bool operator==(const Gravity&) const = default;
};

/// The host's gravity (3 floats [m/s^2]) where it gives one, else the scene's. What is not finite, is beyond
/// most_gravity_m_s2 or has another number of entries is a fault, and the scene's counts. None is a fault,
/// too.
[[nodiscard]] Gravity gravity_of(const GravityParams& params, const HostValues* values, Log& log);

/// What the flow over a surface is made by, besides the surface. tissue.gravity notes it, and tissue.blood
/// takes it from there for seams and jets: a film that another gravity drives at seams would stop there.
struct Flow {
    bool known = false;
    Gravity gravity;
    double spreading = 0.0;
    double relief_pull = 0.0;  ///< 0 without a relief
    bool open_edges = true;

    [[nodiscard]] std::uint64_t key() const;
};
/// Of a surface as Prepare::subject() tells it.
[[nodiscard]] std::shared_ptr<Flow> flow_over(Assets& assets, std::uint64_t surface);

/// The port that reads the relief.
[[nodiscard]] Port read_relief();
/// Its pull where a pass has one, else 0.
[[nodiscard]] double relief_pull(const GravityParams& params, const Prepare& prepare);
void bind_relief(const Pass& pass, const gl::Program& program, double pull);

}  // namespace viscera::tissue
