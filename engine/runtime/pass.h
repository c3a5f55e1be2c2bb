#pragma once

#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/core/log.h"
#include "engine/gl/buffer.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "engine/gl/sampler.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/shader_library.h"

namespace viscera {

/// Samplers that passes choose from.
class Samplers {
  public:
    explicit Samplers(const gl::Functions& gl);
    [[nodiscard]] const gl::Sampler& get(gl::Filter filter, gl::Wrap wrap) const;

  private:
    std::array<gl::Sampler, 9> samplers_;
};

/// What Effect::draw() works with: the targets are bound and cleared, the viewport is set.
class Pass {
  public:
    /// A port of this pass with what it holds; texture: null when it is empty or unbound.
    struct Input {
        std::string_view port;
        const gl::Texture* texture = nullptr;
    };
    /// What stays the same for all passes of a renderer.
    struct Shared {
        const gl::Functions& gl;
        ShaderLibrary& shaders;
        const Samplers& samplers;
        const gl::Texture& black;
        const gl::VertexArray& no_vertices;
        Assets& assets;
        Log& log;
        bool compute = false;  ///< passes that can may use compute shaders
    };
    /// A port that this pass writes; texture: null when nobody needs it.
    struct Output {
        std::string_view port;
        const gl::Texture* texture = nullptr;
    };

    Pass(const Shared& shared, const Frame& frame, std::span<ShaderLibrary::Entry* const> programs,
         std::span<const Input> inputs, std::span<const Output> outputs, const gl::Framebuffer& target,
         glm::ivec2 size, const PixelRegion& region, bool kept)
        : shared_(shared),
          frame_(frame),
          programs_(programs),
          inputs_(inputs),
          outputs_(outputs),
          target_(target),
          size_(size),
          region_(region),
          bounds_(region.bounds()),
          kept_(kept) {}

    [[nodiscard]] const gl::Functions& gl() const { return shared_.gl; }
    [[nodiscard]] const Frame& frame() const { return frame_; }
    [[nodiscard]] Assets& assets() const { return shared_.assets; }
    [[nodiscard]] Log& log() const { return shared_.log; }
    /// Size of the targets [pixels].
    [[nodiscard]] glm::ivec2 size() const { return size_; }
    /// The smallest rectangle around what is drawn: what prepare() asked for, or all.
    [[nodiscard]] const PixelRect& region() const { return bounds_; }
    /// The rectangles themselves.
    [[nodiscard]] std::span<const PixelRect> rects() const { return region_.rects(); }
    /// After Work::go_on(): the targets hold what this pass drew last; otherwise they are clear.
    [[nodiscard]] bool kept() const { return kept_; }
    /// Whether a read port has content.
    [[nodiscard]] bool has(std::string_view port) const { return texture(port) != nullptr; }
    [[nodiscard]] const gl::Texture* texture(std::string_view port) const;

    /// Puts programs()[index] in use.
    [[nodiscard]] const gl::Program& use(std::size_t index) const;
    /// Binds a read port to a sampler uniform; black where the port is empty.
    void bind(const gl::Program& program, std::string_view uniform, std::string_view port,
              gl::Filter filter = gl::Filter::nearest, gl::Wrap wrap = gl::Wrap::clamp) const;
    void bind(const gl::Program& program, std::string_view uniform, const gl::Texture& texture,
              gl::Filter filter = gl::Filter::linear, gl::Wrap wrap = gl::Wrap::clamp) const;

    /// Binds the targets again, after an effect has drawn into textures of its own.
    void bind_target() const { target_.bind(); }
    /// Sets the whole raster state, confined to region(). Before draw() it is gl::overwrite_state.
    void raster(const gl::RasterState& state) const;
    /// Shades every pixel of rects() once with the program in use (vertex shader common/fullscreen.vert).
    void draw_fullscreen() const;
    /// Draws vertices that the vertex shader makes from gl_VertexID and gl_InstanceID.
    void draw_generated(GLenum mode, int vertices, int instances) const;

    /// Whether a write port can and should be filled by dispatch() instead of a draw: the context has compute
    /// shaders, the renderer's option allows them, and the target is a colour of viscera's own (what a host
    /// lends is only known to be drawable).
    [[nodiscard]] bool compute(std::string_view port) const;
    /// Runs the compute program in use once for each pixel of rects(), in groups of its local size. The
    /// shader gets the target as image unit 0 and a rectangle as `uniform ivec4 u_region` (x, y, width,
    /// height): glsl/common/compute.glsl. Only after compute(port) said yes.
    void dispatch(const gl::Program& program, std::string_view port) const;
    /// The same for all of a texture of the effect's own, in a pass that may use compute shaders.
    void dispatch(const gl::Program& program, const gl::Texture& target) const;
    /// Whether dispatch() has been called.
    [[nodiscard]] bool dispatched() const { return dispatched_; }

  private:
    void dispatch(const gl::Program& program, const gl::Texture& target,
                  std::span<const PixelRect> rects) const;

    const Shared& shared_;
    const Frame& frame_;
    std::span<ShaderLibrary::Entry* const> programs_;
    std::span<const Input> inputs_;
    std::span<const Output> outputs_;
    const gl::Framebuffer& target_;
    glm::ivec2 size_;
    PixelRegion region_;
    PixelRect bounds_;
    bool kept_ = false;
    mutable bool dispatched_ = false;
};

}  // namespace viscera
