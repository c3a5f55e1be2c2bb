// What a block holds. Red: film that may flow, or is owed some, as bits; green: the same, over dry tissue.
const int holds_blood = 1;
const int goes_left = 2;  // blood may pass the edge before the next look
const int goes_right = 4;
const int goes_down = 8;
const int goes_up = 16;
const int goes_far = 32;    // several texels
const int is_changed = 64;  // in green: since the last look

int bits_of(float channel) {
    return int(channel * 255.0 + 0.5);
}

// Blue: whether it shows any blood, and whether enough to matter to the edge of a film that comes to it.
const float shows_blood = 0.6;
const float is_wet = 1.0;
const float wet_share = 0.1;  // of the height up to which a film is pinned

// Alpha: drops.
const float drop_comes = 0.5;
const float drop_is_there = 1.0;

// How near blood is to a block that is stepped: what passes on across seams.
const float may_come = 0.6;  // from beside it
const float lies_there = 0.8;
const float runs_far = 1.0;  // lies there, and goes several texels
