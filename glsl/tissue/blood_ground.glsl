/// Where a texel of the block that is drawn lies in the textures of blood_ground.frag.
flat in ivec2 v_ground;  // the block's first texel there

ivec2 on_ground(ivec2 texel) {
    return v_ground + ivec2((texel.x & 7) + ((texel.y & 7) << 3), 0);
}
