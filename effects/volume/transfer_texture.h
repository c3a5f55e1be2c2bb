#pragma once

#include "effects/volume/classification.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::volume {

/// What a program shows of the entries of a transfer function: only those with extinction, so that hardware
/// need not look others up, or the colours of all.
enum class EntriesShown { with_extinction, all };

/// The table of a transfer function on the GPU, for glsl/volume/classify.glsl.
class TransferTexture {
  public:
    TransferTexture(const gl::Functions& gl, const ClassificationTable& table, EntriesShown shown);
    void bind(const Pass& pass, const gl::Program& program) const;

  private:
    gl::Texture entries_;
    glm::dvec2 place_;
    float seen_;
};

}  // namespace viscera::volume
