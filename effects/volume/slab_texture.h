#pragma once

#include "effects/volume/slab_table.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::volume {

/// A SlabTable on the GPU, for glsl/volume/slab_table.glsl.
class SlabTexture {
  public:
    SlabTexture(const gl::Functions& gl, const SlabTable& table);
    void bind(const Pass& pass, const gl::Program& program) const;

  private:
    gl::Texture pieces_;
    gl::Texture bins_;
    glm::vec2 bin_;
};

}  // namespace viscera::volume
