#pragma once

#include <string>
#include <string_view>

#include "engine/context/window.h"

namespace viscera::app {

/// Tells in a window's title what is loaded; stops the work when the window is closed.
class TitleProgress {
  public:
    TitleProgress(WindowContext& window, std::string title) : window_(window), title_(std::move(title)) {}

    /// As ProgressCallback. Handles what the user does meanwhile, of which only closing counts.
    bool operator()(std::string_view what, double fraction);
    [[nodiscard]] bool cancelled() const { return cancelled_; }

  private:
    WindowContext& window_;
    std::string title_;
    long percent_ = -1;
    bool cancelled_ = false;
};

}  // namespace viscera::app
