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

/// A ring of drops as shaders see it: where each lies in its texture, and which are drawn.
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
    /// Asks which drops live. `before`: the drops one step ago. Leaves a framebuffer of its own bound.
    void ask(const Pass& pass, DropRing& ring, const gl::Texture& drops, const gl::Texture& before);

    /// Drops that are listed: all that live, and some that have gone meanwhile.
    [[nodiscard]] int count() const { return drops_; }
    /// For a program with glsl/tissue/drop_ring.glsl: the listed ones.
    void bind(const Pass& pass, const gl::Program& program) const;
    /// Those in a run of the ring.
    void bind(const Pass& pass, const gl::Program& program, const DropRange& run) const;
    /// Draws over the groups of those with a program in use whose vertex shader is drop_groups.vert.
    void cover(const Pass& pass, const gl::Program& program) const;

  private:
    void bind(const Pass& pass, const gl::Program& program, int first) const;
    /// `side`: of a group in what is drawn into [texels].
    void cover(const Pass& pass, const gl::Program& program, int side) const;

    const gl::Functions* gl_;
    int capacity_ = 0;
    gl::Texture lives_;  ///< of groups that are listed: which of their drops live
    gl::Framebuffer lives_target_;
    gl::ReadBack answers_;
    gl::ReadBack::Result answer_;
    ListTexture drop_list_;   ///< places in the ring, four to an item
    ListTexture group_list_;  ///< with a listed drop
    std::vector<glm::vec4> drop_items_;
    std::vector<glm::vec4> group_items_;
    int drops_ = 0;
    std::uint64_t listed_version_ = 0;
};

}  // namespace viscera::tissue
