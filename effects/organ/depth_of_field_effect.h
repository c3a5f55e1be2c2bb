#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "engine/runtime/effect.h"

namespace viscera::organ {

struct DepthOfFieldParams {
    double radius = 0.012;
    int taps = 48;
    double largest_blurriness = 1.0;

    void visit(ParamVisitor& v);
};

/// Vogel's spiral, one golden angle from place to place: the first n fill a disc of radius sqrt(n) evenly,
/// for every n up to `count`.
[[nodiscard]] std::vector<glm::dvec2> disc_spiral(int count);

/// Blurs a picture by the blurriness in its alpha. What is sharp in front of it gives it nothing.
class DepthOfFieldEffect final : public Effect {
  public:
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override;
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    DepthOfFieldParams params_;
    mutable std::vector<ProgramDesc> programs_;
    std::vector<glm::vec2> spiral_;
};

}  // namespace viscera::organ
