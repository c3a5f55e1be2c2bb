/// The flow downhill on a surface: texels per unit of tangential length, up to a scale; 0 where the surface has no such direction.
/// down: of gravity, or 0; du, dv: steps of a texel [mm]; relief: what the relief adds to their rise [mm];
/// factor: |tangential| / |gravity|; scale: of the lengths in which the flow is measured.
vec2 flow_downhill(vec3 down, vec3 du, vec3 dv, vec2 relief, out float factor, out float scale) {
    float longest = max(dot(du, du), dot(dv, dv));
    factor = 0.0;
    scale = 0.0;
    if (!(longest > 0.0 && longest < 1e30)) {
        return vec2(0.0);
    }
    // In units of the longer step, so that neither small nor large surfaces leave the range of a float.
    scale = inversesqrt(longest);
    du *= scale;
    dv *= scale;
    float uu = dot(du, du);
    float uv = dot(du, dv);
    float vv = dot(dv, dv);
    float det = uu * vv - uv * uv;
    vec2 pull = vec2(dot(down, du), dot(down, dv)) - scale * relief;
    vec2 flow = vec2(vv * pull.x - uv * pull.y, uu * pull.y - uv * pull.x) / max(det, 1e-12);
    factor = sqrt(max(dot(flow, pull), 0.0));
    // Straight along gravity a surface has no direction downhill: what is left is rounding.
    return det > 1e-9 && factor > 1e-4 ? flow : vec2(0.0);
}
