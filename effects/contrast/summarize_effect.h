#pragma once

#include "effects/contrast/summarize_curve.h"
#include "engine/runtime/effect.h"

namespace viscera::contrast {

/// Joins contrast.main with the cloud at the injection. Without an injection the summary is the main picture,
/// without a copy.
class SummarizeEffect final : public Effect {
  public:
    SummarizeEffect();
    void visit(ParamVisitor& visitor) override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    SummarizeTransition transition_ = SummarizeTransition::smooth;
    std::vector<ProgramDesc> programs_;
};

}  // namespace viscera::contrast
