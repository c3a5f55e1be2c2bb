// Means of extinction and of extinction times colour between two values, exact for the transfer function as it is:
// effects/volume/slab_table.h says how, and why nothing here cancels.
uniform sampler2D u_pieces;        // six rows, a column per piece of the function
uniform usampler2D u_piece_bins;   // first and last piece of each bin
uniform vec2 u_piece_bin;          // value -> bin: x * value + y

int find_piece(float value) {
    float last_bin = float(textureSize(u_piece_bins, 0).x - 1);
    int bin = int(clamp(value * u_piece_bin.x + u_piece_bin.y, 0.0, last_bin));
    uvec2 pieces = texelFetch(u_piece_bins, ivec2(bin, 0), 0).rg;
    int first = int(pieces.x);
    int last = int(pieces.y);
    while (first < last) {
        int middle = (first + last + 1) / 2;
        bool behind = value >= texelFetch(u_pieces, ivec2(middle, 0), 0).x;
        first = behind ? middle : first;
        last = behind ? last : middle - 1;
    }
    return first;
}

vec4 piece_mean(int piece, float ta, float tb) {
    return texelFetch(u_pieces, ivec2(piece, 1), 0) + texelFetch(u_pieces, ivec2(piece, 2), 0) * (0.5 * (ta + tb)) +
           texelFetch(u_pieces, ivec2(piece, 3), 0) * ((ta * ta + ta * tb + tb * tb) * (1.0 / 3.0));
}

vec4 slab_mean(float a, float b) {
    int last = textureSize(u_pieces, 0).x - 1;
    float low = texelFetch(u_pieces, ivec2(0, 0), 0).x;
    float high = texelFetch(u_pieces, ivec2(last, 0), 0).y;
    float from = clamp(min(a, b), low, high);
    float to = clamp(max(a, b), low, high);
    int i = find_piece(from);
    int j = find_piece(to);
    vec4 head_i = texelFetch(u_pieces, ivec2(i, 0), 0);
    vec4 head_j = texelFetch(u_pieces, ivec2(j, 0), 0);
    float ti = (from - head_i.x) * head_i.z;
    float tj = (to - head_j.x) * head_j.z;
    bool one = i == j;
    vec4 mean_i = piece_mean(i, ti, one ? tj : 1.0);
    int next = min(i + 1, last);
    vec4 between = (texelFetch(u_pieces, ivec2(j, 4), 0) - texelFetch(u_pieces, ivec2(next, 4), 0)) +
                   (texelFetch(u_pieces, ivec2(j, 5), 0) - texelFetch(u_pieces, ivec2(next, 5), 0));
    vec4 sum = (head_i.y - from) * mean_i + between + (to - head_j.x) * piece_mean(j, 0.0, tj);
    return one ? mean_i : sum / max(to - from, 1e-30);
}
