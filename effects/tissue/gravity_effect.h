#pragma once

#include <vector>

#include "effects/tissue/gravity.h"
#include "engine/runtime/effect.h"

namespace viscera::tissue {

struct GravityMapParams {
    GravityParams gravity;
    int size = 512;
    bool open_edges = true;

    void visit(ParamVisitor& v);
};

/// Which way things run down a surface, texel by texel, and what drives a film of liquid from each texel to
/// the next. Depends on the surface, its relief and gravity alone.
class GravityEffect final : public Effect {
  public:
    GravityEffect();
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    GravityMapParams params_;
    std::vector<ProgramDesc> programs_;
    Gravity gravity_;
    double relief_pull_ = 0.0;
};

}  // namespace viscera::tissue
