/// Where a gutter looks for what lies across the seam. way: of the flow's right face (gravity.frag).
ivec2 cell_across(vec4 way) {
    return ivec2(way.z, -1.0 - way.w);
}

/// A cell as a number that a float holds.
float number_of_cell(ivec2 cell) {
    return float(cell.x + (cell.y << 12));
}

ivec2 cell_of_number(float number) {
    return ivec2(int(number) & 4095, int(number) >> 12);
}
