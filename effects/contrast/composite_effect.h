#pragma once

#include "engine/runtime/effect.h"

namespace viscera::contrast {

/// How contrast darkens the background.
enum class Tone {
    beer_lambert,  ///< I0 exp(-mu ratio): monotone and smooth
    thesis,        ///< as published: jumps at ratio 0.5 and grows lighter beyond
};
[[nodiscard]] std::span<const std::string_view> choice_names(Tone tone);

struct CompositeParams {
    Tone tone = Tone::beer_lambert;
    double darkest = 0.08;
    double background = 0.75;

    void visit(ParamVisitor& v);
};

/// What the detector shows.
class CompositeEffect final : public Effect {
  public:
    CompositeEffect();
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    CompositeParams params_;
    std::vector<ProgramDesc> programs_;  ///< index: bit i for input i, then the tone
};

}  // namespace viscera::contrast
