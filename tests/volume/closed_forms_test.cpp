// Scenes whose pictures have a closed form, each from three cameras with three placements: fields in the
// shader, and voxels.

#include <cmath>

#include <gtest/gtest.h>

#include "engine/core/placement.h"
#include "tests/reference/volume_forms.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

using reference::Interval;
using reference::Ray;

// The box before placement, with voxels that are no cubes.
const glm::dvec3 box_mm(80.0, 96.0, 72.0);
const glm::ivec3 coarse(10, 16, 12);
constexpr double shortest = 12.0;  // side of the box in its smallest spacings

/// What is wanted along a ray in the box's own frame, which it meets in `inside`; a length there is `stretch`
/// in the world.
using Form = std::function<std::optional<glm::dvec4>(const Ray& ray, const Interval& inside, double stretch)>;
struct Case {
    std::string name;
    std::string field;     ///< `float field(vec3 p)`
    std::string classify;  ///< `vec4 classify(float v)`
    Form wanted;
    std::string function = "composite";
    std::function<double(const glm::dvec3& p)> value;  ///< the same for voxels; none: only in the shader,
                                                       ///< where it has kinks that voxels blur
    std::string interval;  ///< `vec2 object_interval(vec3 o, vec3 d, int index)` instead of the box;
                           ///< `max_intervals` before
    std::vector<glm::dvec4> half_spaces;  ///< clip planes in the box's own frame
    double samples = 600.0;               ///< along the box's shortest side
};

struct Setting {
    Look look;
    PlacementParams placement;
};
const std::array settings{
    Setting{.look = {.eye_mm = {160, -230, 110}, .target_mm = {2, 3, -1}, .fov_deg = 30}, .placement = {}},
    Setting{.look = {.eye_mm = {-190, -130, -140}, .orthographic_mm = 130},
            .placement = {.rotate_deg = {20, -35, 50}}},
    Setting{.look = {.eye_mm = {20, 260, 130}, .target_mm = {10, -5, 4}, .fov_deg = 40},
            .placement = {.move_mm = {8, -6, 3}, .rotate_deg = {-70, 15, 110}, .scale = {1.3, -0.8, 1.1}}}};

glm::dvec4 absorbed(double tau, const glm::dvec3& colour) {
    const double alpha = 1.0 - std::exp(-tau);
    return {alpha * colour, alpha};
}

/// Coordinates whose rays are bounded by quadrics instead of the box, solved about the closest approach.
std::string bounded_by(const std::string& interval) {
    return interval +
           "uniform mat3 u_metric;\n"
           "vec3 to_sample(vec3 local) { return local; }\n"
           "vec2 ray_interval(Ray ray, int index) {\n"
           "    vec2 s = object_interval((ray.origin - 0.5) * object_box, ray.direction * object_box, "
           "index);\n"
           "    return s;\n"
           "}\n"
           "vec3 metric(vec3 gradient, vec3 local) { return u_metric * gradient; }\n";
}
std::string quadric(const std::string& weights) {
    return "const vec3 object_box = " + glsl(box_mm) +
           ";\n"
           "vec2 chord(vec3 o, vec3 d, vec3 weights) {\n"
           "    o *= weights; d *= weights;\n"
           "    float middle = -dot(o, d) / dot(d, d);\n"
           "    vec3 p = o + middle * d;\n"
           "    float again = -dot(p, d) / dot(d, d);\n"
           "    p += again * d;\n"
           "    float q = 1.0 - dot(p, p);\n"
           "    float reach = sqrt(max(q, 0.0) / dot(d, d));\n"
           "    return q > 0.0 ? middle + again + vec2(-reach, reach) : vec2(0.0);\n"
           "}\n"
           "const int max_intervals = 1;\n"
           "vec2 object_interval(vec3 o, vec3 d, int index) { return chord(o, d, " +
           weights + "); }\n";
}

std::string ball_weights(const glm::dvec3& half_axes) {
    return glsl(1.0 / half_axes);
}

const std::string linear_grey = "vec4 classify(float v) { return vec4(0.8, 0.5, 0.2, 0.02 * v); }";
const glm::dvec3 grey(0.8, 0.5, 0.2);
constexpr double k = 0.02;

Form of_depth(std::function<double(const Ray&, const Interval&)> integral) {
    return [integral = std::move(integral)](const Ray& ray, const Interval& inside, double stretch) {
        return std::optional(absorbed(k * stretch * integral(ray, inside), grey));
    };
}

Case depth_case(std::string name, std::string field, std::function<double(const glm::dvec3&)> value,
                std::function<double(const Ray&, const Interval&)> integral) {
    return {.name = std::move(name),
            .field = std::move(field),
            .classify = linear_grey,
            .wanted = of_depth(std::move(integral)),
            .value = std::move(value)};
}

/// Only where the whole chord is inside of the box, which it always is here.
Case chord_case(std::string name, std::string interval, std::function<double(const Ray&)> chord) {
    Case c = depth_case(std::move(name), "float field(vec3 p) { return 1.0; }", {},
                        [chord = std::move(chord)](const Ray& ray, const Interval&) { return chord(ray); });
    c.interval = std::move(interval);
    c.samples = 8;
    return c;
}

std::vector<Case> cases() {
    std::vector<Case> all;
    const auto one = [](const glm::dvec3&) { return 1.0; };
    const std::string field_one = "float field(vec3 p) { return 1.0; }";
    const auto length = [](const Ray&, const Interval& i) { return i.length(); };
    all.push_back(depth_case("homogeneous box", field_one, one, length));
    all.back().samples = 16;

    const glm::dvec3 zero(0.0);
    const glm::dvec3 axes(33.0, 41.0, 27.0);
    all.push_back(chord_case("sphere", quadric(ball_weights(glm::dvec3(31.0))),
                             [=](const Ray& r) { return reference::sphere_chord(r, zero, 31.0); }));
    all.push_back(chord_case("ellipsoid", quadric(ball_weights(axes)),
                             [=](const Ray& r) { return reference::ellipsoid_chord(r, zero, axes); }));
    // Two intervals of one ray.
    std::string shell = quadric(ball_weights(glm::dvec3(32.0)));
    shell.replace(shell.find("const int max_intervals"), std::string::npos,
                  "const int max_intervals = 2;\n"
                  "vec2 object_interval(vec3 o, vec3 d, int index) {\n"
                  "    vec2 outer = chord(o, d, vec3(1.0 / 32.0)), inner = chord(o, d, vec3(1.0 / 21.0));\n"
                  "    bool hollow = inner.y > inner.x;\n"
                  "    return index == 0 ? vec2(outer.x, hollow ? inner.x : outer.y) : hollow ? "
                  "vec2(inner.y, outer.y) : vec2(0.0);\n"
                  "}\n");
    all.push_back(chord_case("shell", shell,
                             [=](const Ray& r) { return reference::shell_chord(r, zero, 21.0, 32.0); }));
    // A cylinder along z, cut by the box's ends.
    std::string cylinder = quadric("vec3(1.0 / 30.0, 1.0 / 30.0, 0.0)");
    cylinder.replace(cylinder.find("vec2 object_interval"), std::string::npos,
                     "vec2 object_interval(vec3 o, vec3 d, int index) {\n"
                     "    vec2 s = chord(o, d, vec3(1.0 / 30.0, 1.0 / 30.0, 0.0));\n"
                     "    vec2 e = (vec2(-36.0, 36.0) - o.z) / d.z;\n"
                     "    return vec2(max(s.x, min(e.x, e.y)), min(s.y, max(e.x, e.y)));\n"
                     "}\n");
    all.push_back(chord_case("cylinder", cylinder, [](const Ray& r) {
        const glm::dvec2 o(r.origin_mm);
        const glm::dvec2 d(r.direction);
        const double middle = -glm::dot(o, d) / glm::dot(d, d);
        const double q = 900.0 - glm::dot(o + middle * d, o + middle * d);
        const double reach = std::sqrt(std::max(q, 0.0) / glm::dot(d, d));
        const double a = (-36.0 - r.origin_mm.z) / r.direction.z;
        const double b = (36.0 - r.origin_mm.z) / r.direction.z;
        return q > 0.0 ? std::max(0.0, std::min(middle + reach, std::max(a, b)) -
                                           std::max(middle - reach, std::min(a, b)))
                       : 0.0;
    }));

    const glm::dvec3 aside(3.0, -4.0, 2.0);
    const auto radius = [=](const glm::dvec3& p) { return glm::length(p - aside); };
    all.push_back(depth_case(
        "parabolic ball",
        "float field(vec3 p) { vec3 q = (p - " + glsl(aside) +
            ") / 31.0; return max(1.0 - dot(q, q), 0.0); }",
        {}, [=](const Ray& r, const Interval&) { return reference::parabolic_ball(r, aside, 31.0); }));
    all.push_back(depth_case(
        "cone", "float field(vec3 p) { return max(1.0 - length(p - " + glsl(aside) + ") / 31.0, 0.0); }", {},
        [=](const Ray& r, const Interval&) { return reference::conic_ball(r, aside, 31.0); }));
    for (const double sigma : {12.0, 25.0}) {
        all.push_back(depth_case(
            "Gaussian " + std::to_string(static_cast<int>(sigma)),
            "float field(vec3 p) { vec3 q = p - " + glsl(aside) + "; return 1.4 * exp(-0.5 * dot(q, q) / " +
                glsl(sigma * sigma) + "); }",
            [=](const glm::dvec3& p) { return 1.4 * std::exp(-0.5 * std::pow(radius(p) / sigma, 2)); },
            [=](const Ray& r, const Interval& i) {
                return reference::gaussian_integral(r, i, aside, 1.4, sigma);
            }));
    }
    const glm::dvec3 other(-14.0, 17.0, -9.0);
    all.push_back(depth_case(
        "two Gaussians",
        "float field(vec3 p) { vec3 q = p - " + glsl(aside) + ", w = p - " + glsl(other) +
            "; return exp(-0.5 * dot(q, q) / 400.0) + 0.7 * exp(-0.5 * dot(w, w) / 225.0); }",
        [=](const glm::dvec3& p) {
            return std::exp(-0.5 * std::pow(radius(p) / 20.0, 2)) +
                   0.7 * std::exp(-0.5 * std::pow(glm::length(p - other) / 15.0, 2));
        },
        [=](const Ray& r, const Interval& i) {
            return reference::gaussian_integral(r, i, aside, 1.0, 20.0) +
                   reference::gaussian_integral(r, i, other, 0.7, 15.0);
        }));

    // Ramps in three directions: emission and absorption (F5).
    for (const glm::dvec3& slope :
         {glm::dvec3(0.004, 0.006, 0.005), glm::dvec3(-0.007, 0.002, -0.006), glm::dvec3(0.0, 0.0, 0.012)}) {
        const auto value = [=](const glm::dvec3& p) { return 1.0 + glm::dot(slope, p); };
        all.push_back({.name = "ramp " + glsl(slope),
                       .field = "float field(vec3 p) { return 1.0 + dot(" + glsl(slope) + ", p); }",
                       .classify = "vec4 classify(float v) { return vec4(vec3(0.1 + 0.4 * v), 0.02 * v); }",
                       .wanted =
                           [=](const Ray& ray, const Interval& i, double stretch) {
                               const reference::RampLight light =
                                   reference::ramp_light({.s0 = value(ray.at(i.begin)),
                                                          .g = glm::dot(slope, ray.direction) / stretch,
                                                          .length = stretch * i.length(),
                                                          .k = k,
                                                          .c0 = 0.1,
                                                          .c1 = 0.4});
                               return std::optional(
                                   glm::dvec4(glm::dvec3(light.colour), 1.0 - std::exp(-light.tau)));
                           },
                       .value = value});
    }

    // Polyhedra by clip planes (F11).
    const auto polyhedron = [&](const char* name, std::vector<glm::dvec4> half_spaces) {
        Case c = depth_case(name, field_one, one, {});
        // Inside of the box and the half-spaces.
        std::vector<glm::dvec4> all_spaces = half_spaces;
        for (int a = 0; a < 3; ++a) {
            for (const double sign : {-1.0, 1.0}) {
                glm::dvec4 plane(0.0, 0.0, 0.0, 0.5 * box_mm[a]);
                plane[a] = sign;
                all_spaces.push_back(plane);
            }
        }
        c.wanted = of_depth([all_spaces](const Ray& r, const Interval&) {
            return reference::polyhedron_chord(r, all_spaces);
        });
        c.half_spaces = std::move(half_spaces);
        c.samples = 16;
        all.push_back(std::move(c));
    };
    polyhedron("tetrahedron", reference::tetrahedron(zero, 12.0));
    polyhedron("octahedron", reference::octahedron(aside, 18.0));
    polyhedron("wedge", {glm::dvec4(0.6, 0.8, 0.0, 7.0), glm::dvec4(-0.8, 0.0, 0.6, 11.0)});
    all.back().value = {};  // it reaches the box, of which voxels leave out a rim

    // Extremes, means and line integrals. Values as colours.
    const std::string shown = "vec4 classify(float v) { return vec4(vec3(v), 1.0); }";
    const std::string hill =
        "float field(vec3 p) { vec3 q = (p - " + glsl(aside) + ") / 60.0; return 0.9 - dot(q, q); }";
    const auto hill_value = [=](const glm::dvec3& p) { return 0.9 - std::pow(radius(p) / 60.0, 2); };
    // Along a ray, by its distance from the place nearest to the centre.
    const auto along_hill = [=](const Ray& ray, double s) { return hill_value(ray.at(s)); };
    const auto grey_value = [](double v) { return std::optional(glm::dvec4(glm::dvec3(v), 1.0)); };
    all.push_back({.name = "maximum",
                   .field = hill,
                   .classify = shown,
                   .wanted =
                       [=](const Ray& ray, const Interval& i, double) {
                           const double top = std::clamp(reference::approach(ray, aside).s, i.begin, i.end);
                           return grey_value(along_hill(ray, top));
                       },
                   .function = "mip",
                   .value = hill_value});
    all.push_back({.name = "minimum",
                   .field = hill,
                   .classify = shown,
                   .wanted =
                       [=](const Ray& ray, const Interval& i, double) {
                           return grey_value(std::min(along_hill(ray, i.begin), along_hill(ray, i.end)));
                       },
                   .function = "minip",
                   .value = hill_value});
    all.push_back({.name = "mean",
                   .field = hill,
                   .classify = shown,
                   .wanted =
                       [=](const Ray& ray, const Interval& i, double) {
                           // Simpson's rule is exact for a parabola.
                           return grey_value((along_hill(ray, i.begin) +
                                              4.0 * along_hill(ray, 0.5 * (i.begin + i.end)) +
                                              along_hill(ray, i.end)) /
                                             6.0);
                       },
                   .function = "average",
                   .value = hill_value,
                   .samples = 60.0});
    all.push_back({.name = "X-ray of a Gaussian",
                   .field = "float field(vec3 p) { vec3 q = p - " + glsl(aside) +
                            "; return 1000.0 * exp(-0.5 * dot(q, q) / 400.0) - 1000.0; }",
                   .classify = shown,
                   .wanted =
                       [=](const Ray& ray, const Interval& i, double stretch) {
                           const double tau =
                               k * stretch * reference::gaussian_integral(ray, i, aside, 1.0, 20.0);
                           return std::optional(glm::dvec4(glm::dvec3(std::exp(-tau)), 1.0));
                       },
                   .function = "xray",
                   .value =
                       [=](const glm::dvec3& p) {
                           return 1000.0 * std::exp(-0.5 * std::pow(radius(p) / 20.0, 2)) - 1000.0;
                       }});
    return all;
}

Miss worst_of(const Case& c, const Setting& setting, const LiveVolume& volume, VolumeStage& stage,
              nlohmann::json sampling, double inset) {
    const PlacementParams& place = setting.placement;
    const glm::dmat4 model = placement_matrix(place, glm::dvec3(0.0));
    const glm::dmat4 back = glm::inverse(model);
    nlohmann::json p{{"function", c.function},
                     {"transfer_function", {{"points", {{{"value", 0}, {"opacity", 0.5}}}}}},
                     {"xray", {{"negative", false}, {"water_attenuation_per_mm", k}}},
                     {"volume",
                      {{"placement",
                        {{"move_mm", {place.move_mm.x, place.move_mm.y, place.move_mm.z}},
                         {"rotate_deg", {place.rotate_deg.x, place.rotate_deg.y, place.rotate_deg.z}},
                         {"scale", {place.scale.x, place.scale.y, place.scale.z}}}}}}};
    sampling["termination"] = 0;
    sampling["skip"] = false;
    p["sampling"] = sampling;
    for (const glm::dvec4& h : c.half_spaces) {
        const glm::dvec4 world = glm::transpose(back) * h;
        const glm::dvec3 n(world);
        const glm::dvec3 at = -world.w / glm::dot(n, n) * n;
        p["clip_planes"].push_back({{"point_mm", {at.x, at.y, at.z}}, {"normal", {n.x, n.y, n.z}}});
    }
    const glm::dvec3 side = box_mm * (1.0 - 2.0 * inset);
    const glm::dmat4 box(glm::dvec4(side.x, 0, 0, 0), glm::dvec4(0, side.y, 0, 0),
                         glm::dvec4(0, 0, side.z, 0), glm::dvec4(-0.5 * side, 1));
    if (inset > 0.0) {
        const glm::dvec3 n(volume.volume().grid.dims);
        const glm::dvec3 first = inset * n;
        const glm::dvec3 size = n - 2.0 * first;
        p["crop"] = {{"first", {first.x, first.y, first.z}}, {"size", {size.x, size.y, size.z}}};
    }
    const Shot shot = stage.cast(volume, p, setting.look, glm::ivec2(40));
    const auto wanted = [&](const Ray& world) -> std::optional<glm::dvec4> {
        Ray ray{glm::dvec3(back * glm::dvec4(world.origin_mm, 1.0)),
                glm::dvec3(back * glm::dvec4(world.direction, 0.0))};
        const double stretch = 1.0 / glm::length(ray.direction);
        ray.direction *= stretch;
        const auto inside = reference::intersect(ray, box);
        return inside                 ? c.wanted(ray, *inside, stretch)
               : c.function == "xray" ? std::nullopt
                                      : std::optional(glm::dvec4(0.0));
    };
    // Texture coordinates place a ray to some 2^-23 of the box. Where so little aside makes much of a
    // difference, at silhouettes and edges that it grazes, no picture in floats can be held to the form.
    const double aside_mm = box_mm.y / 8388608.0;
    return miss(shot, [&](const Ray& world) -> std::optional<glm::dvec4> {
        const auto here = wanted(world);
        const glm::dvec3 u = glm::normalize(glm::cross(world.direction, glm::dvec3(0.31, 0.52, 0.79)));
        const glm::dvec3 v = glm::cross(world.direction, u);
        for (const glm::dvec3& shift : {u, -u, v, -v}) {
            const auto there = wanted({world.origin_mm + aside_mm * shift, world.direction});
            if (!here || !there || glm::length(*there - *here) > 2.5e-6) {
                return {};
            }
        }
        return here;
    });
}

ShaderTexts classified(const Case& c) {
    return {{"volume/classify.glsl", classify_text(c.classify)}};
}

TEST(ClosedFormPictures, OfFieldsInTheShader) {
    const std::vector<Case> all = cases();
    EXPECT_GE(all.size(), 20U);
    const LiveVolume volume(noise_volume(coarse, box_mm / glm::dvec3(coarse), 1));
    double worst = 0.0;
    for (const Case& c : all) {
        SCOPED_TRACE(c.name);
        ShaderTexts texts = classified(c);
        texts["volume/sample.glsl"] = field_text(c.field, box_mm);
        if (!c.interval.empty()) {
            texts["volume/coordinates_cartesian.glsl"] = bounded_by(c.interval);
        }
        VolumeStage stage(texts);
        for (const Setting& setting : settings) {
            const bool extreme = c.function == "mip" || c.function == "minip";
            const Miss m =
                worst_of(c, setting, volume, stage,
                         {{"scheme", extreme ? "cell" : "gauss"}, {"step", shortest / c.samples}}, 0.0);
            EXPECT_LE(m.worst, 5e-6) << "pixel " << m.x << ", " << m.y;
            EXPECT_GT(m.most, 0.2);
            EXPECT_GT(m.pixels, c.function == "xray" ? 350 : 1520);
            worst = std::max(worst, m.worst);
            if (m.worst > 2e-6) {
                std::printf("  %s: %.1e\n", c.name.c_str(), m.worst);
            }
        }
        EXPECT_EQ(stage.stage().complaints(), std::vector<std::string>{});
    }
    std::printf("  %zu scenes, 3 cameras: worst %.2e\n", all.size(), worst);
}

TEST(ClosedFormPictures, OfVoxels) {
    const glm::ivec3 fine = 9 * coarse;
    double worst = 0.0;
    int scenes = 0;
    for (const Case& c : cases()) {
        if (!c.value) {
            continue;
        }
        SCOPED_TRACE(c.name);
        ++scenes;
        const LiveVolume volume(float_volume(fine, box_mm / glm::dvec3(fine), c.value));
        VolumeStage stage(classified(c));
        for (const Setting& setting : settings) {
            // Inside of the outermost centres: beyond them their values go on, which is not the field.
            const Miss m = worst_of(c, setting, volume, stage,
                                    {{"scheme", "cell"}, {"filter", "linear_fp32"}}, 1.0 / 90.0);
            EXPECT_LE(m.worst, 3.9e-4) << "pixel " << m.x << ", " << m.y;
            EXPECT_GT(m.most, 0.2);
            worst = std::max(worst, m.worst);
            if (m.worst > 3e-4) {
                std::printf("  %s: %.1e\n", c.name.c_str(), m.worst);
            }
        }
    }
    std::printf("  %d scenes of %d x %d x %d voxels, 3 cameras: worst %.2e\n", scenes, fine.x, fine.y, fine.z,
                worst);
    EXPECT_GE(scenes, 13);
}

}  // namespace
}  // namespace viscera::test
