#pragma once

#include <memory>
#include <string>
#include <vector>

#include "effects/tissue/blood_state.h"
#include "engine/runtime/effect.h"

namespace viscera::tissue {

/// Where the blood is: how much the wounds gave, and how much of it is film, drops or gone.
class BloodAccountEffect final : public Effect {
  public:
    BloodAccountEffect();
    void visit(ParamVisitor& visitor) override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    std::string state_name_ = "blood";
    std::vector<ProgramDesc> programs_;
    std::shared_ptr<BloodState> state_;
};

}  // namespace viscera::tissue
