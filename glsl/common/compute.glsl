// A compute shader in place of a full-screen fragment shader: one invocation for each pixel of the region. The file that
// includes this has `layout(local_size_x = ..., local_size_y = ...) in;`.
layout(binding = 0) uniform writeonly image2D u_target;
uniform ivec4 u_region;  // x, y, width, height [pixels]

// Pixel of this invocation; false for those that fill up the last groups.
bool own_pixel(out ivec2 pixel) {
    pixel = u_region.xy + ivec2(gl_GlobalInvocationID.xy);
    return all(lessThan(ivec2(gl_GlobalInvocationID.xy), u_region.zw));
}
