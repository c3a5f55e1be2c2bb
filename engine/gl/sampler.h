#pragma once

#include <array>

#include "engine/gl/handle.h"

namespace viscera::gl {

/// trilinear: linear, also between the levels of a texture that has several.
enum class Filter { nearest, linear, trilinear };
enum class Wrap { clamp, repeat, border };

struct SamplerDesc {
    Filter filter = Filter::linear;
    Wrap wrap = Wrap::clamp;  ///< in all directions
    std::array<float, 4> border{0.0F, 0.0F, 0.0F, 0.0F};

    bool operator==(const SamplerDesc&) const = default;
};

/// How textures are read, kept apart from them, so that a texture (perhaps the host's) is never changed for
/// being sampled.
class Sampler {
  public:
    Sampler(const Functions& gl, const SamplerDesc& desc);

    [[nodiscard]] GLuint id() const { return handle_.id(); }
    void bind(GLuint unit) const { handle_.gl().BindSampler(unit, id()); }

  private:
    SamplerHandle handle_;
};

}  // namespace viscera::gl
