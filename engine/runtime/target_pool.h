#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/plan.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/texture.h"
#include "engine/runtime/frame.h"

namespace viscera {

/// The texture objects of a plan, the content key each one holds, and the framebuffers made of them.
class TargetPool {
  public:
    explicit TargetPool(const gl::Functions& gl) : gl_(gl) {}

    /// A texture of the plan before that goes on as one of the new plan, with what it holds.
    struct Kept {
        std::size_t before = 0;  ///< indices
        std::size_t now = 0;
    };
    /// Makes the textures of a plan; those that fit are kept, but no content is, save that of `kept` where
    /// format and size are the same. Throws Error(limit).
    void reset(const Plan& plan, std::span<const Kept> kept);

    [[nodiscard]] const gl::Texture& texture(std::size_t index) const { return textures_[index]; }
    /// Gives the texture of this OpenGL name to the caller, who then deletes it; the pool makes a new one in
    /// its place. 0: not ours.
    [[nodiscard]] GLuint release(GLuint id);
    /// What is known of a texture's pixels: all but those of `drawn` have the value `clear`, and who drew
    /// last.
    struct Backdrop {
        bool known = false;
        std::array<float, 4> clear{};
        PixelRect drawn;
        std::uint64_t key = 0;  ///< of the content that was drawn into it last
    };
    [[nodiscard]] Backdrop& backdrop(std::size_t index) { return backdrops_[index]; }
    /// Nothing is known of any texture any more but of those `kept`.
    void forget_content(std::span<const Kept> kept);
    /// Content keys, by texture; 0: nothing.
    [[nodiscard]] std::span<std::uint64_t> keys() { return keys_; }
    /// Exchanges two textures with what they hold: how a history target turns over.
    void swap(std::size_t a, std::size_t b);

    /// Framebuffer of some colours (null entries discard their output) and a depth; made once.
    [[nodiscard]] const gl::Framebuffer& framebuffer(std::span<const gl::Texture* const> colours,
                                                     const gl::Texture* depth, std::string_view label);
    /// Drops the framebuffers that hold a texture.
    void forget_framebuffers(GLuint texture);

  private:
    static constexpr std::size_t attachments = gl::draw_buffers + 1;
    using Ids = std::array<GLuint, attachments>;
    struct Entry {
        Ids ids{};
        std::unique_ptr<gl::Framebuffer> framebuffer;
    };

    const gl::Functions& gl_;
    std::vector<PlanTexture> descriptions_;
    std::vector<gl::Texture> textures_;
    std::vector<std::uint64_t> keys_;
    std::vector<Backdrop> backdrops_;
    std::vector<Entry> framebuffers_;
};

}  // namespace viscera
