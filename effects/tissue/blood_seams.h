#pragma once

#include <span>

#include "effects/tissue/list_texture.h"
#include "effects/tissue/seam_links.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/texture.h"

namespace viscera::tissue {

/// The seams of a surface as the shaders of the film read them.
struct BloodSeams {
    gl::Texture first_of_cell;  ///< of a texel: where the parts of its cell begin, or -1
    ListTexture links;
    ListTexture parts;
    gl::Texture pulls;  ///< what drives a film through each part: of blood_link.frag
    gl::Framebuffer pulls_target;
    bool empty = true;
};

/// `size`: texels along each side of the bake.
[[nodiscard]] BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links, int size);

}  // namespace viscera::tissue
