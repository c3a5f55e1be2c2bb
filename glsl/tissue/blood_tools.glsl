#include "common/texel.glsl"
// Suction and rinsing: what they take from a place in one step.
uniform sampler2D u_position;
uniform int u_tool_count;
uniform vec4 u_tool[16];        // place [mm], radius [mm]
uniform vec2 u_tool_power[16];  // sucked off [mm per step], share that is rinsed away per step

/// Of a film of a height [mm], at a texel [mm].
float taken(ivec2 texel, float height) {
    vec3 place = texel_at(u_position, texel).xyz;
    float left = height;
    for (int i = 0; i < u_tool_count; ++i) {
        vec3 away = place - u_tool[i].xyz;
        float reach = max(1.0 - dot(away, away) / (u_tool[i].w * u_tool[i].w), 0.0);
        left = max(left - reach * u_tool_power[i].x, 0.0) * (1.0 - min(reach * 2.0, 1.0) * u_tool_power[i].y);
    }
    return height - left;
}
