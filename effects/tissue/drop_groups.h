#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/drop_ring.h"
#include "effects/tissue/list_texture.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/program.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::tissue {

/// A ring of drops as shaders see it: where each lies in its texture, and which groups are drawn.
class DropGroups {
  public:
    /// `capacity`: drops that there must be room for.
    DropGroups(const gl::Functions& gl, int capacity);

    [[nodiscard]] std::int64_t capacity() const { return capacity_; }
    /// Of a texture with a texel for each drop.
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;

    /// Takes over what the GPU has told meanwhile, and what the ring then lists.
    void update(DropRing& ring);
    /// Asks which groups hold a living drop. `before`: the drops one step ago. Leaves a framebuffer of its
    /// own bound.
    void ask(const Pass& pass, DropRing& ring, const gl::Texture& drops, const gl::Texture& before);

    /// Drops in the listed groups.
    [[nodiscard]] int count() const { return listed_ * static_cast<int>(DropRing::group_size); }
    /// For a program with glsl/tissue/drop_ring.glsl: the listed ones.
    void bind(const Pass& pass, const gl::Program& program) const;
    /// Those in a run of the ring.
    void bind(const Pass& pass, const gl::Program& program, const DropRange& run) const;
    /// Draws over the listed groups with a program in use whose vertex shader is drop_groups.vert.
    void cover(const Pass& pass, const gl::Program& program) const;

  private:
    void bind(const Pass& pass, const gl::Program& program, int first) const;

    const gl::Functions* gl_;
    int capacity_ = 0;
    gl::Texture lives_;  ///< of groups: a drop lives
    gl::Framebuffer lives_target_;
    gl::ReadBack answers_;
    gl::ReadBack::Result answer_;
    ListTexture list_;
    std::vector<glm::vec4> items_;
    int listed_ = 0;
    std::uint64_t listed_version_ = 0;
};

}  // namespace viscera::tissue
