// Textures of blood_ground.frag and blood_faces.frag: what belongs to a block lies side by side, 16 blocks in a row.
const int right_faces = 72;  // 9 x 8
const int faces_of_block = 144;
