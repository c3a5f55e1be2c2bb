#pragma once

#include "engine/core/plan.h"
#include "engine/runtime/pass.h"

namespace viscera {

class Executor;

/// Shows outputs in the framebuffers and viewports that a frame names.
class Presenter {
  public:
    explicit Presenter(const Pass::Shared& shared);

    /// What the frame that the executor has just run asks to be shown; `first_output`: where it does not say
    /// which output. Throws Error(usage) for a framebuffer that cannot be drawn into and for an output that
    /// the scene has not.
    void present(const Frame& frame, const std::string& first_output, const Executor& executor);

  private:
    /// eye: the one of two that is shown; -1: whatever there is.
    void show(const Present& present, const std::string& name, int eye, const Executor& executor);
    /// texture: null where the target holds nothing but its clear value.
    void draw(const Present& present, const PixelRect& viewport, const gl::Texture* texture,
              const PlanContent& content);

    Pass::Shared shared_;
    ShaderLibrary::Entry& program_;
};

}  // namespace viscera
