#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/image.h"
#include "engine/gl/buffer.h"
#include "engine/gl/texture.h"

namespace viscera::gl {

/// The pixels of a 2-D texture in its own type, waiting until they are drawn. Throws Error(usage) when the
/// texture is not of a PixelFormat.
[[nodiscard]] Image read_texture(const Functions& gl, const Texture& texture);

/// The PixelFormat that a texture format stands for, if any.
[[nodiscard]] std::optional<PixelFormat> pixel_format(const TextureFormat& format);

/// Reads textures back without making the CPU wait: start() asks, poll() gives what has arrived, in the
/// order asked. How many are under way is the caller's choice: call wait() when in_flight() is too many.
class ReadBack {
  public:
    explicit ReadBack(const Functions& gl) : gl_(&gl) {}
    ReadBack(const ReadBack&) = delete;
    ReadBack& operator=(const ReadBack&) = delete;
    ~ReadBack();

    struct Result {
        Image image;
        std::uint64_t tag = 0;
    };

    /// The texture may be drawn into again right after. `tag` comes back with the result. Throws as
    /// read_texture().
    void start(const Texture& texture, std::uint64_t tag);
    /// The oldest, if it has arrived. Never waits.
    [[nodiscard]] std::optional<Result> poll();
    /// The same into a result whose memory is used again; false: it has not arrived.
    [[nodiscard]] bool poll(Result& result);
    /// The oldest, waiting for it; none when nothing is under way. Throws Error(gl) when the driver lost it.
    [[nodiscard]] std::optional<Result> wait();
    [[nodiscard]] std::size_t in_flight() const { return pending_.size(); }

  private:
    struct Pending {
        Buffer buffer;
        GLsync fence = nullptr;
        int width = 0;
        int height = 0;
        PixelFormat format = PixelFormat::rgba8;
        std::uint64_t tag = 0;
    };
    [[nodiscard]] Buffer take_buffer(std::size_t bytes);
    void finish(Result& result);

    const Functions* gl_;
    std::vector<Pending> pending_;
    std::vector<Buffer> free_;
};

}  // namespace viscera::gl
