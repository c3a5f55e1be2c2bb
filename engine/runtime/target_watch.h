#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/image.h"
#include "engine/core/pixel_region.h"
#include "engine/gl/buffer.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/texture.h"
#include "engine/runtime/executor.h"
#include "engine/runtime/renderer.h"

namespace viscera {

/// Keeps copies of targets in memory, each brought up to date after every frame that changes it, by what
/// changed, without ever making the renderer wait.
class TargetWatch {
  public:
    TargetWatch(const gl::Functions& gl, WatchPath path) : gl_(gl), path_(path) {}
    TargetWatch(const TargetWatch&) = delete;
    TargetWatch& operator=(const TargetWatch&) = delete;
    ~TargetWatch();

    /// Copies of targets that were watched before are kept.
    void set_targets(const std::vector<std::string>& targets);
    [[nodiscard]] std::vector<std::string> targets() const;
    void set_path(WatchPath path);
    /// Another scene: what the targets of this name held is no answer any more.
    void forget();

    /// After a frame: asks for what it changed. The frame's outputs are read through `executor`.
    void frame_done(Executor& executor, std::uint64_t index, double time_s);
    /// Takes what has arrived. Never waits.
    void take();
    /// The same, and asks for what the last frame changed while too much was under way, as long as its
    /// outputs are there: else a copy would stay behind when no further frame comes.
    void poll(Executor& executor);
    /// The same until there are all copies and none is older than this. Textures of the host's are asked for
    /// with their frame only.
    void wait(Executor& executor, std::uint64_t most_frames_behind);
    /// Null: not watched, or no frame of it has arrived yet.
    [[nodiscard]] const WatchedTarget* find(std::string_view target) const;

  private:
    /// A frame's part of a target on its way.
    struct Request {
        std::uint64_t key = 0;
        std::uint64_t frame_count = 0;
        std::uint64_t index = 0;
        double time_s = 0.0;
        PixelRegion region;
        std::optional<gl::Buffer> buffer;  ///< buffered; none: deferred, what is in the mirror
        GLsync fence = nullptr;
    };
    struct Entry {
        WatchedTarget shown;
        bool any = false;             ///< something has arrived
        std::uint64_t shown_key = 0;  ///< content of the copy
        std::uint64_t shown_count = 0;
        std::uint64_t asked_key = 0;    ///< content of the last request, or of the copy when there is none
        bool left_out = false;          ///< something has changed for which there is no request
        std::vector<Request> requests;  ///< the oldest first
        std::unique_ptr<gl::Texture> mirror;  ///< deferred: a copy on the GPU that frames do not draw into
        std::unique_ptr<gl::Framebuffer> mirror_frame;
    };
    [[nodiscard]] bool may_ask(const Entry& entry) const;
    void ask(Entry& entry, Executor& executor, const Executor::Output& output);
    [[nodiscard]] gl::Buffer take_buffer(std::size_t bytes);
    void copy_to_mirror(Entry& entry, const gl::Framebuffer& source, const gl::Texture& texture,
                        const PixelRegion& region);
    void ask_for_left_out(Entry& entry, Executor& executor);
    void take_arrived(Entry& entry);
    void take_first(Entry& entry);
    void arrive(Entry& entry, Request& request);
    void show(Entry& entry, const Request& request);
    void drop(Entry& entry);
    void count_age(Entry& entry) const { entry.shown.frames_behind = frames_ - entry.shown_count; }

    const gl::Functions& gl_;
    WatchPath path_;
    std::vector<std::unique_ptr<Entry>> entries_;
    std::vector<gl::Buffer> free_;
    std::uint64_t frames_ = 0;
    std::uint64_t index_ = 0;  ///< of the last frame
    double time_s_ = 0.0;
};

}  // namespace viscera
