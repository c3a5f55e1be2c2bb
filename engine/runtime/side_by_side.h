#pragma once

#include <array>

#include "engine/runtime/effect.h"

namespace viscera {

/// Puts the pictures of two eyes next to each other, the left one on the left, texel by texel. The engine
/// adds it to a scene whose camera asks for it; scenes do not name it.
class SideBySideEffect final : public Effect {
  public:
    /// `clear`: of each eye's target, which an empty one stands for.
    SideBySideEffect(PixelFormat format, const std::array<float, 4>& clear)
        : format_(format), clear_(clear) {}

    void visit(ParamVisitor& /*visitor*/) override {}
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    PixelFormat format_;
    std::array<float, 4> clear_;
    std::array<ProgramDesc, 1> programs_{{{"common/fullscreen.vert", "common/side_by_side.frag", {}}}};
};

}  // namespace viscera
