// Textures of blood_ground.frag and blood_faces.frag: what belongs to a block lies side by side, as do the faces of squares of 4 x 4 texels,
// which software renderers shade together.
const int blocks_in_row = 16;
const int texels_of_block = 64;
const int right_faces = 20;  // of a square: 5 x 4
const int faces_of_row = 4;  // top ones of a square
const int faces_of_square = 40;
const int faces_of_block = 160;
