#include "tests/volume/sector_stage.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

namespace viscera::test {

std::vector<NamedShape> some_shapes() {
    constexpr double pi = std::numbers::pi;
    const auto cylinder = [](double r_min, double first, double angle, bool wrap, double height) {
        return VolumeShape{.kind = VolumeKind::cylindrical,
                           .r_min_mm = r_min,
                           .r_max_mm = 50.0,
                           .first_angle_rad = first,
                           .angle_rad = angle,
                           .wrap = wrap,
                           .height_mm = height};
    };
    const auto sphere = [](double r_min, double first, double angle, bool wrap, double latitude) {
        return VolumeShape{.kind = VolumeKind::spherical,
                           .r_min_mm = r_min,
                           .r_max_mm = 50.0,
                           .first_angle_rad = first,
                           .angle_rad = angle,
                           .wrap = wrap,
                           .latitude_rad = latitude};
    };
    return {{"ring", cylinder(0.0, 0.4, 2.0 * pi, true, 70.0)},
            {"tube", cylinder(20.0, -1.0, 2.0 * pi, true, 60.0)},
            {"open ring", cylinder(0.0, 0.0, 2.0 * pi, false, 60.0)},
            {"gap", cylinder(15.0, 0.7, 5.2, false, 50.0)},
            {"half", cylinder(0.0, 0.2, pi, false, 60.0)},
            {"fan", cylinder(10.0, -0.6, 1.2, false, 40.0)},
            {"ball", sphere(0.0, 0.3, 2.0 * pi, true, pi)},
            {"shell", sphere(25.0, 0.0, 2.0 * pi, true, pi)},
            {"belt", sphere(12.0, 0.0, 2.0 * pi, true, 1.6)},
            {"bitten", sphere(18.0, 0.5, 4.4, false, 2.2)},
            {"probe", sphere(8.0, -0.5, 1.3, false, 1.0)}};
}

Volume sector_volume(const VolumeShape& shape, const glm::ivec3& dims,
                     const std::function<double(const glm::dvec3& frame)>& value) {
    const double c = std::cos(0.4);
    const double s = std::sin(0.4);
    Volume volume{.grid = {.dims = dims,
                           .origin_mm = {7.0, -4.0, -25.0},
                           .direction = glm::dmat3({c, s, 0.0}, {-s, c, 0.0}, {0.0, 0.0, 1.0}),
                           .shape = shape},
                  .type = ScalarType::f32,
                  .voxels = {},
                  .source = "test"};
    const ShapeAxes axes = axes_of(shape, dims);
    std::vector<float> values;
    for (int k = 0; k < dims.z; ++k) {
        for (int j = 0; j < dims.y; ++j) {
            for (int i = 0; i < dims.x; ++i) {
                const glm::dvec3 at = axes.first + glm::dvec3(i, j, k) * axes.step;
                values.push_back(static_cast<float>(value(to_frame(shape, at))));
            }
        }
    }
    const auto bytes = std::as_bytes(std::span(values));
    volume.voxels.assign(bytes.begin(), bytes.end());
    return volume;
}

Volume sector_vessels(const VolumeShape& shape, const glm::ivec3& dims) {
    return sector_volume(shape, dims, [](const glm::dvec3& p) {
        const double winding =
            std::hypot(p.x - 22.0 * std::cos(0.09 * p.z), p.y - 22.0 * std::sin(0.09 * p.z));
        const double straight = std::hypot(p.y + 6.0, p.z - 12.0);
        const double axial = std::hypot(p.x, p.y);
        const double nearest = std::min({winding, straight, axial});
        return nearest < 3.0 ? 200.0 - 30.0 * nearest : 0.0;
    });
}

Volume sector_noise(const VolumeShape& shape, const glm::ivec3& dims, unsigned seed) {
    std::mt19937 random(seed);
    return sector_volume(shape, dims,
                         [&](const glm::dvec3&) { return static_cast<double>(random() >> 8U) / 16777216.0; });
}

glm::dvec3 sector_centre(const VolumeGrid& grid) {
    return grid.box_to_world() * glm::dvec4(0.5, 0.5, 0.5, 1.0);
}

ShaderTexts chords_shown() {
    constexpr std::array<std::string_view, 1> functions{"finish"};
    return {{"volume/march.glsl",
             "uniform float u_slab;\n"
             "void march(Ray ray, vec2 interval, float offset, inout State state) {\n"
             "    state.depth += max(interval.y - interval.x, 0.0);\n"
             "    state.colour.x += interval.y > interval.x ? 1.0 : 0.0;\n"
             "}\n"},
            {"volume/function_composite.glsl",
             wrapped("volume/function_composite.glsl", functions,
                     "vec4 finish(State state) { return vec4(state.depth, state.colour.x, 0.0, 1.0); }\n")}};
}

glm::ivec3 small_dims(const VolumeShape& shape) {
    return shape.kind == VolumeKind::cylindrical ? glm::ivec3(20, 40, 24) : glm::ivec3(40, 25, 20);
}

}  // namespace viscera::test
