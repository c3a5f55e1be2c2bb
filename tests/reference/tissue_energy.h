#pragma once

#include <span>

#include <glm/glm.hpp>

/// Energy that tissue takes up, in double precision, as the published rules have it: in steps.
namespace viscera::reference {

enum class Action { coagulate, ultrasound, dissect };

/// A contact that moves at an even speed from one place to another.
struct Source {
    glm::dvec3 from{0.0};
    glm::dvec3 to{0.0};
    double rate = 1.0;   ///< P G: energy per second under it
    double sigma = 1.0;  ///< in the unit of the places
    Action action = Action::coagulate;
};

/// One step: `inc` is what the sources of an action give, already cut off.
[[nodiscard]] double energy_step(double e, double inc, Action action, double e_max);

/// Beyond this distance from its way a source adds less than half a unit in the last place of 1 in a frame of
/// 1/60 s, and is taken to add nothing.
[[nodiscard]] double reach(const Source& source);

/// After `seconds`, during which all sources go all their way, in `steps` steps. Sources of one action are
/// summed, and cut off at what the strongest of them gives under itself; in a step the actions come in their
/// order.
[[nodiscard]] double energy_after(double e, std::span<const Source> sources, const glm::dvec3& place,
                                  double seconds, int steps, double e_max);

/// F13: a source of power P and width s that ran at speed v along x from 0 to `length`, at (x, y) of the
/// plane.
[[nodiscard]] double stroke_energy(double power, double speed, double s, double length, double x, double y);

/// exp(-d^2 / 2 s^2) averaged over the way from a to b, by Gauss-Legendre steps far shorter than s.
[[nodiscard]] double mean_gaussian(const glm::dvec3& a, const glm::dvec3& b, double s,
                                   const glm::dvec3& place);

}  // namespace viscera::reference
