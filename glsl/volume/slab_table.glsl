// Means of extinction and of extinction times colour between two values, exact for the transfer function as it is:
// effects/volume/slab_table.h says how, and why nothing here cancels.
// A row or six rows for each transfer function: the volume's, and those of segments.
uniform sampler2D u_pieces;        // six rows, a column per piece of the function
uniform usampler2D u_piece_bins;   // first and last piece of each bin
uniform vec2 u_piece_bin;          // value -> bin: x * value + y

vec4 piece_texel(int piece, int row, int ramp) {
    return texelFetch(u_pieces, ivec2(piece, 6 * ramp + row), 0);
}

int find_piece(float value, int ramp) {
    float last_bin = float(textureSize(u_piece_bins, 0).x - 1);
    int bin = int(clamp(value * u_piece_bin.x + u_piece_bin.y, 0.0, last_bin));
    uvec2 pieces = texelFetch(u_piece_bins, ivec2(bin, ramp), 0).rg;
    int first = int(pieces.x);
    int last = int(pieces.y);
    while (first < last) {
        int middle = (first + last + 1) / 2;
        bool behind = value >= piece_texel(middle, 0, ramp).x;
        first = behind ? middle : first;
        last = behind ? last : middle - 1;
    }
    return first;
}

vec4 piece_mean(int piece, float ta, float tb, int ramp) {
    return piece_texel(piece, 1, ramp) + piece_texel(piece, 2, ramp) * (0.5 * (ta + tb)) +
           piece_texel(piece, 3, ramp) * ((ta * ta + ta * tb + tb * tb) * (1.0 / 3.0));
}

vec4 slab_mean(float a, float b, int ramp) {
    int last = textureSize(u_pieces, 0).x - 1;
    float low = piece_texel(0, 0, ramp).x;
    float high = piece_texel(last, 0, ramp).y;
    float from = clamp(min(a, b), low, high);
    float to = clamp(max(a, b), low, high);
    int i = find_piece(from, ramp);
    int j = find_piece(to, ramp);
    vec4 head_i = piece_texel(i, 0, ramp);
    vec4 head_j = piece_texel(j, 0, ramp);
    float ti = (from - head_i.x) * head_i.z;
    float tj = (to - head_j.x) * head_j.z;
    bool one = i == j;
    vec4 mean_i = piece_mean(i, ti, one ? tj : 1.0, ramp);
    int next = min(i + 1, last);
    vec4 between = (piece_texel(j, 4, ramp) - piece_texel(next, 4, ramp)) +
                   (piece_texel(j, 5, ramp) - piece_texel(next, 5, ramp));
    vec4 sum = (head_i.y - from) * mean_i + between + (to - head_j.x) * piece_mean(j, 0.0, tj, ramp);
    return one ? mean_i : sum / max(to - from, 1e-30);
}
