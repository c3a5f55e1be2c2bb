#pragma once

#include "effects/contrast/vessel.h"
#include "engine/runtime/effect.h"

namespace viscera::contrast {

/// Where a mesh is seen: the mask for smoke.
class SilhouetteEffect final : public Effect {
  public:
    SilhouetteEffect();
    void visit(ParamVisitor& visitor) override { mesh_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    MeshFile mesh_;
    std::vector<ProgramDesc> programs_;
    std::shared_ptr<const MeshData> data_;
    std::uint64_t parameters_key_ = 0;
    std::uint64_t mesh_key_ = 0;
};

}  // namespace viscera::contrast
