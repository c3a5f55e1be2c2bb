#pragma once

#include <memory>

#include "effects/organ/organ_params.h"
#include "engine/core/image.h"
#include "engine/core/log.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::organ {

/// Slopes (dH/du, dH/dv) of a tangent-space normal map, two channels: half floats for 8-bit maps, else
/// floats. Slopes, not normals, because their linear mix is the slope of the mixed heights. A normal that
/// does not point outwards or is not finite is flat and counts as a fault. `name`: of the file, for the
/// message.
/// Source: Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU" (2010).
[[nodiscard]] Image slopes_of(const Image& normals, const BumpParams& how, Log& log, const std::string& name);

/// Four channels as stored; grey becomes red, green and blue of the same value. What is not finite is 0.
[[nodiscard]] Image colours_of(const Image& picture, Log& log, const std::string& name);

/// The same as textures with levels, read from their files on first use and shared by all passes.
[[nodiscard]] std::shared_ptr<gl::Texture> slope_texture(const Pass& pass, const BumpParams& how);
[[nodiscard]] std::shared_ptr<gl::Texture> colour_texture(const Pass& pass, const AssetPath& file);

}  // namespace viscera::organ
