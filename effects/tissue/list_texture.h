#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/gl/texture.h"

namespace viscera::tissue {

/// A list of four floats each that shaders read, as rows of an RGBA32F texture: glsl/tissue/list.glsl. Grows
/// as needed.
class ListTexture {
  public:
    /// Throws Error(limit) for more than the device's largest texture takes.
    void upload(const gl::Functions& gl, std::span<const glm::vec4> items, std::string_view label);
    [[nodiscard]] const gl::Texture& texture() const { return *texture_; }
    /// Rows that hold items, of the texture's.
    [[nodiscard]] int rows() const { return static_cast<int>(rows_.size()) / texture_->width(); }

  private:
    std::optional<gl::Texture> texture_;
    std::vector<glm::vec4> rows_;  ///< whole rows, padded
};

}  // namespace viscera::tissue
