#pragma once

#include "engine/core/plan.h"
#include "engine/runtime/pass.h"

namespace viscera {

/// Shows a target in the framebuffer and viewport that the caller names.
class Presenter {
  public:
    explicit Presenter(const Pass::Shared& shared);

    /// viewport: in place of present.viewport, of which it may be a half. texture: null where the target
    /// holds nothing but its clear value. Throws Error(usage) for a framebuffer that cannot be drawn into.
    void present(const Present& present, const PixelRect& viewport, const gl::Texture* texture,
                 const PlanContent& content);

  private:
    Pass::Shared shared_;
    ShaderLibrary::Entry& program_;
};

}  // namespace viscera
