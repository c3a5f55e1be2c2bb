#pragma once

#include <memory>

#include "engine/runtime/effect.h"

namespace viscera::picture {

/// How a picture fills a target of another shape.
enum class Fit {
    cover,    ///< fills the target, the rest is cut off
    stretch,  ///< fills the target, shape is lost
    height,  ///< as high as the target and black beside it: stays under a camera that holds a vertical extent
};
[[nodiscard]] std::span<const std::string_view> choice_names(Fit fit);

struct ImageParams {
    AssetPath file;
    Fit fit = Fit::cover;
    double gain = 1.0;
    bool monochrome = true;

    void visit(ParamVisitor& v);
};

/// A picture file as a target: a background, a mask, a texture. Drawn once and kept.
class ImageEffect final : public Effect {
  public:
    ImageEffect();
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    ImageParams params_;
    std::vector<ProgramDesc> programs_;
};

}  // namespace viscera::picture
