#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/runtime/renderer.h"

namespace viscera::app {

/// The user's hand on the window and level of a scene's volumes: it stretches and shifts the knots of their
/// transfer functions.
class WindowHand {
  public:
    /// Finds the passes that show volumes by transfer functions. Throws Error(file), Error(scene).
    explicit WindowHand(Renderer& renderer);

    /// x, y: of the window's height, to the right and up; x widens the window (half a height: e-fold), y
    /// raises the level (a height: by one window).
    void drag(double x, double y);
    /// As the scene has it.
    void reset();
    /// Counts the changes.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

  private:
    struct Window {
        std::string pass;
        glm::dvec2 given{0.0};  ///< values of the first and last knot
        glm::dvec2 range{0.0};  ///< the same now
    };
    void set(Window& window, const glm::dvec2& range);

    Renderer& renderer_;
    std::vector<Window> windows_;
    std::uint64_t revision_ = 0;
};

}  // namespace viscera::app
