#version 330 core
// Evaluates a surface at the point that each texel stands for. Which point that is does not change as the
// surface moves, and comes as a texture (see TexelPoint): a triangle, the weights of its corners 1 and 2, and
// the triangle whose chart the texel belongs to. NORMAL, METRIC and SEAM: what is wanted besides positions.
uniform sampler2D u_map;
uniform sampler2D u_vertices;   // two texels per vertex: world position [mm] and u, world normal and v
uniform sampler2D u_triangles;  // three vertices
uniform float u_size;           // texels along each side
layout(location = 0) out vec4 o_position;
#ifdef NORMAL
layout(location = 1) out vec4 o_normal;
#endif
#ifdef METRIC
layout(location = 2) out vec4 o_metric;
#endif
#ifdef SEAM
layout(location = 3) out vec2 o_seam;
#endif

const int row_length = 1024;

vec4 element(sampler2D list, int i) {
    return texelFetch(list, ivec2(i % row_length, i / row_length), 0);
}

// First what changes least along the weights: exact where all corners agree.
vec3 blend(vec3 a, vec3 b, vec3 c, vec2 weight) {
    return a + (weight.x * (b - a) + weight.y * (c - a));
}

void main() {
    vec4 point = texelFetch(u_map, ivec2(gl_FragCoord.xy), 0);
    o_position = vec4(0.0);
#ifdef NORMAL
    o_normal = vec4(0.0);
#endif
#ifdef METRIC
    o_metric = vec4(0.0);
#endif
#ifdef SEAM
    o_seam = vec2(-1.0);
#endif
    if (point.w == 0.0) {
        return;
    }
    bool inside = point.w > 0.0;
    bool ends = point.x < 0.0;
    float coverage = inside ? 1.0 : 0.5;
    ivec3 corner = ivec3(element(u_triangles, int(ends ? -point.x - 1.0 : point.x)).xyz);
    vec4 p0 = element(u_vertices, 2 * corner.x);
    vec4 p1 = element(u_vertices, 2 * corner.y);
    vec4 p2 = element(u_vertices, 2 * corner.z);
    o_position = vec4(blend(p0.xyz, p1.xyz, p2.xyz, point.yz), coverage);

#if defined(NORMAL) || defined(SEAM)
    vec4 n0 = element(u_vertices, 2 * corner.x + 1);
    vec4 n1 = element(u_vertices, 2 * corner.y + 1);
    vec4 n2 = element(u_vertices, 2 * corner.z + 1);
#endif
#ifdef NORMAL
    vec3 normal = blend(n0.xyz, n1.xyz, n2.xyz, point.yz);
    if (dot(normal, normal) < 1e-12) {  // opposite normals: the triangle's own, lengthened out of denormals
        vec3 e1 = p1.xyz - p0.xyz;
        vec3 e2 = p2.xyz - p0.xyz;
        float longest = max(max(max(abs(e1.x), abs(e1.y)), abs(e1.z)), max(max(abs(e2.x), abs(e2.y)), abs(e2.z)));
        normal = longest > 0.0 ? cross(e1 / longest, e2 / longest) : vec3(0.0);
    }
    float length2 = dot(normal, normal);
    o_normal = vec4(length2 > 0.0 ? normal * inversesqrt(length2) : vec3(0.0, 0.0, 1.0), coverage);
#endif
#ifdef SEAM
    if (inside) {
        o_seam = gl_FragCoord.xy / u_size;
    } else if (!ends) {
        o_seam = blend(vec3(p0.w, n0.w, 0.0), vec3(p1.w, n1.w, 0.0), vec3(p2.w, n2.w, 0.0), point.yz).xy;
    }
#endif
#ifdef METRIC
    // A gutter is measured by the chart that it continues.
    ivec3 own = ivec3(element(u_triangles, int(abs(point.w)) - 1).xyz);
    vec4 q0 = element(u_vertices, 2 * own.x);
    vec4 q1 = element(u_vertices, 2 * own.y);
    vec4 q2 = element(u_vertices, 2 * own.z);
    float v0 = element(u_vertices, 2 * own.x + 1).w;
    vec2 d1 = u_size * vec2(q1.w - q0.w, element(u_vertices, 2 * own.y + 1).w - v0);
    vec2 d2 = u_size * vec2(q2.w - q0.w, element(u_vertices, 2 * own.z + 1).w - v0);
    float det = d1.x * d2.y - d1.y * d2.x;
    if (det != 0.0) {
        vec3 du = ((q1.xyz - q0.xyz) * d2.y - (q2.xyz - q0.xyz) * d1.y) / det;
        vec3 dv = ((q2.xyz - q0.xyz) * d1.x - (q1.xyz - q0.xyz) * d2.x) / det;
        vec2 lengths = vec2(length(du), length(dv));
        // From unit vectors: a square of a square would leave the range of a float for organs far from a millimetre's size.
        vec3 along_u = du / max(lengths.x, 1e-37);
        vec3 along_v = dv / max(lengths.y, 1e-37);
        o_metric = vec4(lengths, clamp(dot(along_u, along_v), -1.0, 1.0),
                        length(cross(along_u, along_v)) * lengths.x * lengths.y);
    }
#endif
}
