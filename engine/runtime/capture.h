#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "engine/gl/pixel_transfer.h"
#include "engine/runtime/executor.h"
#include "engine/runtime/renderer.h"

namespace viscera {

/// A target that nothing was drawn into, as a picture.
[[nodiscard]] Image clear_image(const PlanContent& content);

/// Reads whole frames back without making the renderer wait: each frame's targets are asked for at its end
/// and handed over together when the last of them has arrived.
class Capture {
  public:
    explicit Capture(const gl::Functions& gl) : read_back_(gl) {}

    void set_sink(CaptureSink sink) { sink_ = std::move(sink); }
    /// Asks for the outputs of the frame just run. Targets that hold nothing but their clear value are made
    /// here.
    void start(const FrameReport& report, const std::vector<std::string>& names, const Executor& executor);
    /// Hands over what has arrived. wait: everything.
    void poll(bool wait);

  private:
    struct Pending {
        CapturedFrame frame;
        std::size_t missing = 0;
    };
    void place(gl::ReadBack::Result&& result);
    void hand_over();

    gl::ReadBack read_back_;
    CaptureSink sink_;
    std::deque<Pending> pending_;
    std::uint64_t first_frame_ = 0;  ///< number of pending_.front()
};

}  // namespace viscera
