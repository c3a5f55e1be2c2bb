#version 330 core
// A drop in the air, or a piece of a stream, blurred along its way while the picture is taken.
#include "tissue/list.glsl"
uniform sampler2D u_particles;  // three items for each: place [mm], radius [mm]; velocity [mm/s], time in which it flies as far as it is long [s]; UV of its wound
uniform mat4 u_to_eye;
uniform mat4 u_projection;
uniform float u_exposure;       // [s]
uniform bool u_parallel;        // orthographic
uniform float u_pixel;          // width of a pixel [mm]: per mm of depth, or, orthographic, anywhere
#ifdef ENERGY
uniform sampler2D u_energy;
uniform float u_sealed;
#endif
out vec2 v_across;              // from its middle, across and along [radius]
flat out float v_stretch;       // half its length without the round ends, over radius
flat out float v_blur;          // half the way that it flies, over radius
flat out float v_pixel;         // width of a pixel over radius
flat out float v_cover;         // share of what is drawn that is blood
flat out float v_round;         // share of its area that round ends have

void main() {
    vec4 place = list_item(u_particles, 3 * gl_InstanceID);
    vec4 motion = list_item(u_particles, 3 * gl_InstanceID + 1);
    vec3 centre = (u_to_eye * vec4(place.xyz, 1.0)).xyz;
    vec3 speed = (u_to_eye * vec4(motion.xyz, 0.0)).xyz;
    vec3 sight = u_parallel ? vec3(0.0, 0.0, -1.0) : centre / max(length(centre), 1e-6);
    vec3 along = speed - dot(speed, sight) * sight;
    float seen = length(along);
    float reach = 0.5 * motion.w * seen;
    float way = 0.5 * u_exposure * seen;
    vec3 axis = seen > 1e-6 ? along / seen : normalize(cross(sight, vec3(0.57, 0.61, 0.55)));
    vec3 side = cross(axis, sight);
    // A piece of a stream is thinner than the drop that it becomes.
    float radius = place.w * inversesqrt(1.0 + reach / max(place.w, 1e-6));
#ifdef ENERGY
    vec2 size = vec2(textureSize(u_energy, 0));
    float energy = texelFetch(u_energy, ivec2(clamp(list_item(u_particles, 3 * gl_InstanceID + 2).xy, 0.0, 0.9999) * size), 0).r;
    radius *= sqrt(1.0 - smoothstep(0.5 * u_sealed, u_sealed, energy));
#endif
    float pixel = u_pixel * (u_parallel ? 1.0 : max(-centre.z, 0.0));
    // What is thinner than a pixel is drawn as wide as one: no streak breaks up into dots.
    float drawn = max(radius, 0.5 * pixel);
    v_stretch = reach / max(drawn, 1e-6);
    v_pixel = pixel / max(drawn, 1e-6);
    v_blur = max(way / max(drawn, 1e-6), 0.5 * v_pixel);
    // And as much fainter: areas, over pi, of the streak and of what is drawn, whose edges fade along its sides where its ends are short.
    float straight = 1.2732395 * reach;
    float ends = drawn * (1.0 - 0.053 * v_pixel * v_pixel);
    v_cover = radius * (straight + radius) / max(drawn * (straight + ends), 1e-12);
    v_round = drawn / max(straight + drawn, 1e-12);
    // Half a pixel more on each side, over which the edge fades.
    vec2 extent = vec2(1.0 + 0.5 * v_pixel, v_stretch + 1.0 + v_blur);
    v_across = (vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0) * extent;
    vec3 corner = centre + drawn * (v_across.x * side + v_across.y * axis);
    gl_Position = radius > 0.0 ? u_projection * vec4(corner, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
