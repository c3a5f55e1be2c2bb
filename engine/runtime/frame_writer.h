#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "engine/io/exr.h"
#include "engine/runtime/renderer.h"

namespace viscera {

struct FrameWriterOptions {
    std::filesystem::path folder;  ///< made when missing
    io::ExrCompression compression = io::ExrCompression::zip;
    bool multipart = false;  ///< one file per frame, one part per target, in place of one file per target
    std::vector<std::string> png;              ///< targets also written as PNG for a look
    std::vector<io::ExrAttribute> attributes;  ///< of every part: scene hash, camera, renderer
    std::size_t queue = 4;  ///< frames that may wait; submit() blocks beyond, so that memory stays bounded
};

/// Counts what is not finite and finds the range of the rest.
[[nodiscard]] TargetReport summarise(const std::string& name, const Image& image);

/// Writes captured frames on a thread of its own: `0007.contrast.main.exr` and `0007.final.png`. A target
/// that repeats its last frame's pixels is written all the same: every frame is whole.
class FrameWriter {
  public:
    /// `done` receives each frame's report, with file names and ranges, on the writer's thread.
    /// Throws Error(file) when the folder cannot be made or written.
    FrameWriter(FrameWriterOptions options, std::function<void(FrameReport&&)> done);
    ~FrameWriter();
    FrameWriter(const FrameWriter&) = delete;
    FrameWriter& operator=(const FrameWriter&) = delete;

    /// Queues a frame. Throws what the thread ran into with an earlier one.
    void submit(CapturedFrame&& frame);
    /// Waits until all is written. Throws the first error; frames queued behind it are not written.
    void finish();

  private:
    void run();
    void write(CapturedFrame& frame) const;
    void rethrow_locked();

    FrameWriterOptions options_;
    std::function<void(FrameReport&&)> done_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<CapturedFrame> frames_;
    std::exception_ptr error_;
    bool busy_ = false;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace viscera
