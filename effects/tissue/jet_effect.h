#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "effects/tissue/blood_state.h"
#include "effects/tissue/list_texture.h"
#include "engine/gl/texture.h"
#include "engine/runtime/effect.h"

namespace viscera::tissue {

struct JetParams {
    std::string state = "blood";
    double exposure_s = 0.01;
    glm::dvec3 colour{0.45, 0.02, 0.02};
    double sealed_energy = 0.5;

    void visit(ParamVisitor& v);
};

/// Jets of blood in the air, drawn over a picture.
class JetEffect final : public Effect {
  public:
    JetEffect();
    ~JetEffect() override;
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    JetParams params_;
    std::vector<ProgramDesc> programs_;
    std::shared_ptr<BloodState> state_;
    ListTexture list_;
    std::vector<glm::vec4> items_;
};

}  // namespace viscera::tissue
