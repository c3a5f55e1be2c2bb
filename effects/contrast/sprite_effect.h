#pragma once

#include <memory>
#include <string>
#include <vector>

#include "effects/contrast/emitter.h"
#include "engine/runtime/effect.h"

namespace viscera::contrast {

/// A picture of the smoke seen at an angle.
struct SpriteViewParams {
    double angle_deg = 90.0;
    AssetPath image;

    void visit(ParamVisitor& v);
};

struct SpriteParams {
    std::vector<EmitterParams> emitters;
    std::string host_emitters;
    std::vector<SpriteViewParams> views;
    AssetPath front;

    void visit(ParamVisitor& v);
};

/// Reflux and extravasation: smoke that leaves the vessel, as sprites that turn with their emitters.
class SpriteEffect final : public Effect {
  public:
    /// `target`: of the smoke, "contrast.reflux" or "contrast.extravasate".
    explicit SpriteEffect(std::string target);

    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    struct Pictures;
    void collect(const Frame& frame, Log& log);
    bool add_quads(Prepare& prepare);
    [[nodiscard]] double layer_of(double angle_deg) const;
    void report(EmitterFault fault, Log& log) const;

    std::string target_;
    SpriteParams params_;
    std::vector<ProgramDesc> programs_;
    std::vector<EmitterParams> emitters_;  ///< the scene's and the host's
    std::vector<SpriteQuad> quads_;        ///< those seen in this frame
    std::string_view idle_reason_;
    bool masked_ = false;
};

}  // namespace viscera::contrast
