// Trilinear reconstruction by the texture unit.
uniform sampler3D u_volume;

float sample_volume(vec3 place) {
    return textureLod(u_volume, place, 0.0).r;
}
