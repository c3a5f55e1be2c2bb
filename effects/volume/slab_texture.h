#pragma once

#include <span>

#include "effects/volume/slab_table.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::volume {

/// Tables of transfer functions over one range on the GPU, for glsl/volume/slab_table.glsl.
class SlabTexture {
  public:
    /// At least one table; all have as many bins.
    SlabTexture(const gl::Functions& gl, std::span<const SlabTable> tables);
    void bind(const Pass& pass, const gl::Program& program) const;

  private:
    gl::Texture pieces_;
    gl::Texture bins_;
    glm::vec2 bin_;
};

}  // namespace viscera::volume
