/// How high a film stands [mm]; -1 where there is no surface. film: see blood_common.glsl.
float relief_of(vec4 film) {
    return film.w == 0.0 ? -1.0 : max(film.x + film.y, 0.0);
}
