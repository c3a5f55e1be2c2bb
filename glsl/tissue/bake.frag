#version 330 core
// Evaluates a surface at the point that each texel stands for. Which point that is does not change as the
// surface moves, and comes as a texture: triangle, two barycentric weights, and the triangle whose chart the
// texel belongs to (see TexelPoint).
uniform sampler2D u_map;
uniform sampler2D u_vertices;   // two texels per vertex: world position [mm] and u, world normal and v
uniform sampler2D u_triangles;  // three vertices
uniform float u_size;           // texels along each side
layout(location = 0) out vec4 o_position;
layout(location = 1) out vec4 o_normal;
layout(location = 2) out vec4 o_metric;
layout(location = 3) out vec2 o_seam;

const int row_length = 1024;

vec4 element(sampler2D list, int i) {
    return texelFetch(list, ivec2(i % row_length, i / row_length), 0);
}

void main() {
    vec4 point = texelFetch(u_map, ivec2(gl_FragCoord.xy), 0);
    o_position = vec4(0.0);
    o_normal = vec4(0.0);
    o_metric = vec4(0.0);
    o_seam = vec2(-1.0);
    if (point.w == 0.0) {
        return;
    }
    bool inside = point.w > 0.0;
    ivec3 corner = ivec3(element(u_triangles, int(point.x)).xyz);
    vec4 p0 = element(u_vertices, 2 * corner.x);
    vec4 p1 = element(u_vertices, 2 * corner.y);
    vec4 p2 = element(u_vertices, 2 * corner.z);
    vec4 n0 = element(u_vertices, 2 * corner.x + 1);
    vec4 n1 = element(u_vertices, 2 * corner.y + 1);
    vec4 n2 = element(u_vertices, 2 * corner.z + 1);
    vec4 e1 = p1 - p0;
    vec4 e2 = p2 - p0;
    float coverage = inside ? 1.0 : 0.5;
    o_position = vec4(p0.xyz + (point.y * e1.xyz + point.z * e2.xyz), coverage);
    vec3 normal = n0.xyz + (point.y * (n1.xyz - n0.xyz) + point.z * (n2.xyz - n0.xyz));
    float length2 = dot(normal, normal);
    vec3 flat_normal = cross(e1.xyz, e2.xyz);
    normal = length2 > 1e-12 ? normal * inversesqrt(length2) : flat_normal * inversesqrt(max(dot(flat_normal, flat_normal), 1e-30));
    o_normal = vec4(normal, coverage);
    o_seam = inside ? gl_FragCoord.xy / u_size
                    : vec2(p0.w + (point.y * e1.w + point.z * e2.w),
                           n0.w + (point.y * (n1.w - n0.w) + point.z * (n2.w - n0.w)));

    // The map's own derivatives: of the triangle whose chart the texel belongs to.
    vec2 d1 = u_size * vec2(e1.w, n1.w - n0.w);
    vec2 d2 = u_size * vec2(e2.w, n2.w - n0.w);
    float det = d1.x * d2.y - d1.y * d2.x;
    if (det != 0.0) {
        vec3 du = (d2.y * e1.xyz - d1.y * e2.xyz) / det;
        vec3 dv = (d1.x * e2.xyz - d2.x * e1.xyz) / det;
        vec2 lengths = vec2(length(du), length(dv));
        float product = lengths.x * lengths.y;
        o_metric = vec4(lengths, product > 0.0 ? clamp(dot(du, dv) / product, -1.0, 1.0) : 0.0,
                        length(cross(du, dv)));
    }
}
