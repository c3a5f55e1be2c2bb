#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_drop.glsl"
#include "tissue/drop_ring.glsl"
// A drop as it is seen: a point around it in texture space, and one for each of four ways in which a seam cuts it. One that is narrower than three texels is
// drawn as wide as they are, and so much flatter: texels that sample it here and there would show dots.
uniform sampler2D u_drops;
uniform sampler2D u_numbers;  // of gutters in the list, or -1
uniform sampler2D u_jumps;    // list of blood_jump.frag
uniform sampler2D u_position;
uniform sampler2D u_metric;
flat out vec4 v_cap;      // place [mm], radius [mm]
flat out float v_height;  // in the middle [mm]

const int points = 5;
const float farthest = 48.0;     // that a drop is drawn [texels]; llvmpipe draws points of up to 255
const float gutter_width = 4.0;  // at least, so that no seam lies between two looks [texels]

vec2 extent_of(ivec2 texel, float radius) {
    vec4 metric = texel_at(u_metric, texel);
    float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
    return min(radius / (max(metric.xy, vec2(1e-12)) * sine) + 1.0, vec2(farthest));
}

/// World position at a point between texels.
vec3 world_at(vec2 texel) {
    ivec2 last = textureSize(u_position, 0) - 1;
    ivec2 at = ivec2(floor(texel));
    vec2 t = texel - (vec2(at) + 0.5);
    vec3 here = texel_at(u_position, at).xyz;
    vec3 result = here;
    for (int axis = 0; axis < 2; ++axis) {
        float along = axis == 0 ? t.x : t.y;
        ivec2 unit = (axis == 0 ? ivec2(1, 0) : ivec2(0, 1)) * (along < 0.0 ? -1 : 1);
        vec4 next = texel_at(u_position, clamp(at + unit, ivec2(0), last));
        result += next.w > 0.0 ? abs(along) * (next.xyz - here) : vec3(0.0);
    }
    return result;
}

void main() {
    vec4 drop = texel_at(u_drops, drop_texel(drop_place(gl_VertexID / points)));
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
    v_cap = vec4(0.0);
    v_height = 0.0;
    if (!(drop.z > 0.0)) {
        return;
    }
    ivec2 size = textureSize(u_numbers, 0);
    vec2 centre = drop.xy * vec2(size);
    ivec2 at = clamp(ivec2(floor(centre)), ivec2(0), size - 1);
    float own = drop_radius(drop.z);
    vec2 lengths = texel_at(u_metric, at).xy;
    float radius = max(own, 1.5 * max(lengths.x, lengths.y));
    vec2 extent = extent_of(at, radius);
    vec2 middle = centre;
    int way = gl_VertexID % points - 1;
    bool drawn = way < 0;
    // Most drops lie at no seam: these look for one and no more.
    if (!drawn) {
        vec2 towards = way < 2 ? vec2(float(1 - 2 * way), 0.0) : vec2(0.0, float(5 - 2 * way));
        float far = dot(abs(towards), extent);
        float next = min(gutter_width, far);
        float gutter = -1.0;
        bool more = true;
        while (more) {
            ivec2 probed = clamp(ivec2(floor(centre + next * towards)), ivec2(0), size - 1);
            gutter = texel_at(u_numbers, probed).r;
            more = gutter < 0.0 && next < far;
            next = min(next + gutter_width, far);
        }
        drawn = gutter >= 0.0;
        centre = drawn ? list_item(u_jumps, int(gutter)).xy : centre;
        extent = 2.0 * extent_of(clamp(ivec2(floor(centre)), ivec2(0), size - 1), radius);
    }
    if (drawn) {
        v_height = u_drop.x * own * (own * own) / (radius * radius);
        v_cap = vec4(world_at(middle), radius);
        gl_PointSize = 2.0 * max(extent.x, extent.y);
        gl_Position = vec4(2.0 * centre / vec2(size) - 1.0, 0.0, 1.0);
    }
}
