// Blocks of 8 x 8 texels, the finer grid over the tiles: as many steps as there are texels along a side lie between two looks, and a
// film goes on by a texel per step. What has no blood within a block around it stays empty until the next look.
uniform sampler2D u_plan;  // r: to be stepped, g: to be shown

const int block_side = 8;
