// Blurriness by depth, as alpha stores it.
uniform vec3 u_focus;         // near, focal plane, far: depths [mm]
uniform vec2 u_focus_clamp;   // largest blurriness before and behind the focal plane

float stored_blurriness(float depth) {
    bool before = depth < u_focus.y;
    // Planes apart by less than their last digit are one.
    float f = (depth - u_focus.y) / max(before ? u_focus.y - u_focus.x : u_focus.z - u_focus.y, 1e-30);
    float b = before ? max(-1.0 + 1.0 / (1.0 + exp(-10.0 * (f + 0.4))), -u_focus_clamp.x)
                     : min(1.0 / (1.0 + exp(-10.0 * (f - 0.4))), u_focus_clamp.y);
    return 0.5 * b + 0.5;
}
