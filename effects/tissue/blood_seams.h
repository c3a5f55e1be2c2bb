#pragma once

#include <span>

#include "effects/tissue/list_texture.h"
#include "effects/tissue/seam_links.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/texture.h"

namespace viscera::tissue {

/// The seams of a surface as the shaders of the film read them.
struct BloodSeams {
    gl::Texture place_of_cell;  ///< of a texel: where its cell stands in `cells`, or -1
    ListTexture cells;          ///< at seams: x, y, where its links begin, 1
    ListTexture links;          ///< of links_by_cell()
    gl::Texture pulls;          ///< what drives a film through each link: of blood_link.frag
    gl::Framebuffer pulls_target;
    gl::Texture came;  ///< into each of `cells` in a step [mm]
    gl::Framebuffer came_target;
    int chunks = 0;  ///< of `cells`: squares of it with cells of one block each

    [[nodiscard]] bool empty() const { return chunks == 0; }
};

/// `size`: texels along each side of the bake; `block_side`: of BloodBlocks.
[[nodiscard]] BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links, int size,
                                    int block_side);

}  // namespace viscera::tissue
