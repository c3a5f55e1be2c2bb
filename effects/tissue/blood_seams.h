#pragma once

#include <span>

#include "effects/tissue/list_texture.h"
#include "effects/tissue/seam_links.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/texture.h"

namespace viscera::tissue {

/// Squares of a texture that seams join, each pair once: x, y here, x, y across.
struct SeamPairs {
    ListTexture list;
    int count = 0;
};

/// The seams of a surface as the shaders of blood read them.
struct BloodSeams {
    SeamPairs tiles;
    SeamPairs blocks;
    gl::Texture first;  ///< by cell: where its links begin, or -1
    ListTexture links;  ///< of links_by_cell()
    gl::Texture pulls;  ///< what drives a film through each link: of blood_link.frag
    gl::Framebuffer pulls_target;

    [[nodiscard]] bool empty() const { return tiles.count == 0; }
};

/// `size`: texels along each side of the bake; `tile_side`, `block_side`: of the squares [texels].
[[nodiscard]] BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links,
                                    std::span<const SeamJump> jumps, int size, int tile_side, int block_side);

}  // namespace viscera::tissue
