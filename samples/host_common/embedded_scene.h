#pragma once

#include <filesystem>

#include "engine/core/image.h"
#include "engine/runtime/renderer.h"

namespace host {

/// viscera inside a host: the host's context is current whenever a member is called.
class EmbeddedScene {
  public:
    /// `scene`: a file whose fourth pass is smoke, as in assets/scenes/angiography.json.
    EmbeddedScene(viscera::ProcAddress proc, const std::filesystem::path& scene);

    /// Draws the scene at a time [s] into part of a framebuffer of the host's.
    void draw(double time_s, unsigned framebuffer, const viscera::PixelRect& viewport);

  private:
    viscera::Registry registry_;
    viscera::Renderer renderer_;
    viscera::HostValues values_;
};

}  // namespace host
