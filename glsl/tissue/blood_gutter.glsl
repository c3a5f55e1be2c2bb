/// Where a gutter looks for what lies across the seam. way: of the flow's right face (gravity.frag).
ivec2 cell_across(vec4 way) {
    return ivec2(way.z, -1.0 - way.w);
}
