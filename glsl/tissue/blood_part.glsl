// A part of a seam: spread, drive [mm], area [mm^2], and the cell across as a number, negative in the last part of a cell. Numbers count
// by rows of 4096, whatever the texture's size: software renderers divide by what they do not know one lane at a time.
float number_of_part(ivec2 cell, bool last_one) {
    float number = float(cell.x + (cell.y << 12) + 1);
    return last_one ? -number : number;
}

ivec2 cell_of_part(vec4 part) {
    int number = int(abs(part.w)) - 1;
    return ivec2(number & 4095, number >> 12);
}
