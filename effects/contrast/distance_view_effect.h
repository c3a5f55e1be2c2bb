#pragma once

#include "engine/runtime/effect.h"

namespace viscera::contrast {

/// Draws contrast.distance for inspection: cyan near the injection, green on the rest of the vessels.
class DistanceViewEffect final : public Effect {
  public:
    DistanceViewEffect();
    void visit(ParamVisitor&) override {}
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    std::vector<ProgramDesc> programs_;
};

}  // namespace viscera::contrast
