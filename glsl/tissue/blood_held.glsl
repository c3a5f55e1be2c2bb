// What a block holds, as bits in a channel of 8. Drops set them all.
const int holds_blood = 1;  // that may flow, or owes some
const int goes_left = 2;    // blood may pass the edge before the next look
const int goes_right = 4;
const int goes_down = 8;
const int goes_up = 16;
const int goes_far = 32;  // several texels

int bits_of(float channel) {
    return int(channel * 255.0 + 0.5);
}
