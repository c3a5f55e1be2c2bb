// Iso-surfaces against the exact roots of the trilinear field, the known biases of filters, and their
// normals.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/reference/volume_exact.h"
#include "tests/reference/volume_forms.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

/// Shows where the first surface is: `what` of `place` (world [mm]) and `normal` as colour, 1 as opacity.
ShaderTexts showing(std::string_view what) {
    constexpr std::array<std::string_view, 1> metric{"metric"};
    constexpr std::array<std::string_view, 1> finish{"finish"};
    return {{"volume/coordinates_cartesian.glsl",
             wrapped("volume/coordinates_cartesian.glsl", metric,
                     "vec3 place = vec3(0.0);\nvec3 normal = vec3(0.0);\nbool found = false;\n"
                     "vec3 metric(vec3 gradient, vec3 local) {\n"
                     "    vec3 g = plain_metric(gradient, local);\n"
                     "    place = found ? place : local;\n"
                     "    normal = found ? normal : g / max(length(g), 1e-30);\n"
                     "    found = true;\n"
                     "    return g;\n"
                     "}\n")},
            {"volume/function_isosurface.glsl", wrapped("volume/function_isosurface.glsl", finish,
                                                        "vec4 finish(State state) { return found ? vec4(" +
                                                            std::string(what) + ", 1.0) : vec4(0.0); }\n")}};
}

nlohmann::json surface(double iso, std::string_view filter) {
    return {{"function", "isosurface"},
            {"isosurface", {{"values", {{{"value", iso}}}}}},
            {"transfer_function", {{"points", {{{"value", 0}, {"opacity", 0.5}}}}}},
            {"sampling", {{"scheme", "cell"}, {"filter", filter}, {"gradient", "analytic"}, {"step", 0.5}}}};
}

/// How near a ray comes to touching the surface where the picture and the reference disagree: the least
/// distance of the field's extremes along the ray, cell by cell, from the iso value.
double tangency(const reference::Field& field, const reference::Ray& ray, const reference::Interval& interval,
                double iso) {
    double least = 1e30;
    reference::visit_pieces(field, ray, interval, [&](const reference::Piece& piece) {
        const reference::Bounds b = reference::extremes(piece.value, -1.0, 1.0);
        least = std::min({least, std::abs(b.low - iso), std::abs(b.high - iso)});
        return true;
    });
    return least;
}

/// A root that float cannot tell from a touch: values in [0, 1) come out of three interpolations with places
/// good to 2^-22 of a cell, a few 1e-7 in all.
constexpr double touch = 2e-6;

TEST(Isosurface, NoRootIsMissedInAMillionRays) {
    constexpr int pictures = 16;
    constexpr int size = 256;
    VolumeStage stage(showing("place"));
    std::size_t rays = 0;
    std::size_t hits = 0;
    std::size_t touches = 0;  // left out by the criterion
    std::size_t missed = 0;
    double farthest = 0.0;
    double widest = 0.0;
    for (int picture = 0; picture < pictures; ++picture) {
        const LiveVolume volume(
            noise_volume(glm::ivec3(5), glm::dvec3(1.0), static_cast<unsigned>(100 + picture)));
        const reference::Field field(volume.volume(), reference::Filter::trilinear);
        const double iso = 0.25 + 0.5 * picture / (pictures - 1.0);
        // Three cells along each axis, seen from anywhere.
        nlohmann::json parameters = surface(iso, "linear_fp32");
        parameters["crop"] = {{"first", {1, 1, 1}}, {"size", {3, 3, 3}}};
        const double angle = 0.7 * picture;
        Look look{.eye_mm = {7.0 * std::cos(angle), 7.0 * std::sin(angle), 9.0 * std::sin(1.3 * angle)},
                  .up = {0.1, 0.2, 1.0},
                  .fov_deg = 16,
                  .near_mm = 0.1,
                  .far_mm = 100};
        look.orthographic_mm = picture % 2 == 0 ? 0.0 : 3.2;
        const Shot shot = stage.cast(volume, parameters, look, glm::ivec2(size));
        const reference::Limits limits{.crop_min = glm::dvec3(0.2), .crop_max = glm::dvec3(0.8)};
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const reference::Ray ray = shot.ray(x, y);
                const auto interval = reference::intersect(ray, field.texture_to_world(), limits);
                ++rays;
                if (!interval) {
                    continue;
                }
                const auto crossing = reference::first_crossing(field, ray, *interval, iso);
                const glm::dvec4 got = shot.at(x, y);
                const bool hit = got.a > 0.0;
                hits += crossing ? 1U : 0U;
                // Along the ray: a grazing root lies along it, so that the distance aside says nothing.
                const double error =
                    hit && crossing ? glm::length(glm::dvec3(got) - crossing->texture) * 5.0 : 0.0;
                if (hit == crossing.has_value() && error <= 1e-3) {
                    farthest = std::max(farthest, error);
                    continue;
                }
                const double distance = tangency(field, ray, *interval, iso);
                if (distance <= touch || interval->length() < 1e-5) {
                    ++touches;
                    widest = std::max(widest, distance <= touch ? distance : 0.0);
                } else {
                    ++missed;
                    if (missed < 6) {
                        ADD_FAILURE() << "picture " << picture << " pixel " << x << ", " << y << ": "
                                      << (hit ? "hit" : "none") << " for " << (crossing ? "a root" : "none")
                                      << ", off by " << error << " voxels; nearest touch " << distance;
                    }
                }
            }
        }
    }
    std::printf(
        "  isosurface: %zu rays, %zu roots, %zu missed, %zu within %.0e of a touch (worst %.1e); places %.1e "
        "voxels\n",
        rays, hits, missed, touches, touch, widest, farthest);
    EXPECT_GE(rays, 1000000U);
    EXPECT_GT(hits, 400000U);
    EXPECT_EQ(missed, 0U);
    EXPECT_LE(touches, rays / 10000);
    EXPECT_LE(farthest, 1e-3);
}

struct Kind {
    const char* name;
    reference::Filter reference;
    bool prefilter;
};
const std::array kinds{Kind{"linear_fp32", reference::Filter::trilinear, false},
                       Kind{"bspline_fp32", reference::Filter::bspline, false},
                       Kind{"bspline_fp32", reference::Filter::bspline_prefiltered, true},
                       Kind{"catmull_rom_fp32", reference::Filter::catmull_rom, false}};

/// f = r^2 on voxels h apart, with room around the ball for what a prefilter makes of the edges.
constexpr double h = 2.0;
constexpr double radius = 17.3;
constexpr int square_voxels = 44;

TEST(Isosurface, BallsHaveTheirFiltersRadiusAndRadialNormals) {
    // Computed in the shader: one program shows both. Sine and cosine of the angle between normal and radius.
    const double side = h * square_voxels;
    VolumeStage stage(
        showing("length(place - 0.5) * " + glsl(side) + " - " + glsl(radius) +
                ", length(cross(normal, normalize(place - 0.5))), dot(normal, normalize(place - 0.5))"));
    const LiveVolume volume(float_volume(glm::ivec3(square_voxels), glm::dvec3(h),
                                         [](const glm::dvec3& p) { return glm::dot(p, p); }));
    for (const Kind& kind : kinds) {
        SCOPED_TRACE(std::string(kind.name) + (kind.prefilter ? " prefiltered" : ""));
        nlohmann::json parameters = surface(radius * radius, kind.name);
        parameters["sampling"]["prefilter"] = kind.prefilter;
        // The surface of f + e = R^2 for e between the filter's bounds (F8), not only to leading order.
        const reference::Bounds bias = reference::square_bias(kind.reference, h);
        const double least = std::sqrt(radius * radius - bias.high) - radius;
        const double most = std::sqrt(radius * radius - bias.low) - radius;
        double low = 1e30;
        double high = -1e30;
        double angle = 0.0;
        int seen = 0;
        for (const Look& look : {Look{.eye_mm = {60, -80, 30}, .fov_deg = 24},
                                 Look{.eye_mm = {-9, 40, 80}, .orthographic_mm = 33}}) {
            const Shot shot = stage.cast(volume, parameters, look, glm::ivec2(48));
            for (int y = 0; y < 48; ++y) {
                for (int x = 0; x < 48; ++x) {
                    const glm::dvec4 c = shot.at(x, y);
                    if (c.a > 0.0) {
                        low = std::min(low, c.r);
                        high = std::max(high, c.r);
                        angle = std::max(angle, glm::degrees(std::atan2(c.g, c.b)));
                        ++seen;
                    }
                }
            }
        }
        std::printf("  %-17s radius %+.2e .. %+.2e, bounds %+.2e .. %+.2e; normals %.1e degree\n", kind.name,
                    low, high, least, most, angle);
        const double rounding = 1e-6 * radius;  // of places in texture coordinates
        EXPECT_GE(low, least - rounding);
        EXPECT_LE(high, most + rounding);
        EXPECT_GT(seen, 2000);
        if (kind.reference != reference::Filter::trilinear) {
            EXPECT_LE(angle, 0.01);
        }
    }
}

/// Maximum along each ray, as value.
nlohmann::json maximum() {
    return {{"function", "mip"},
            {"transfer_function", {{"points", {{{"value", 0}, {"opacity", 1.0}}}}}},
            {"sampling", {{"scheme", "cell"}, {"filter", "linear_fp32"}, {"skip", false}}}};
}
constexpr std::string_view value_as_colour = "vec4 classify(float v) { return vec4(vec3(v), 1.0); }";

// Places are good to half a unit of the last bit of texture coordinates, values to what that makes of their
// slope, so the volume is small.
TEST(Maximum, IsTheExactOneOfTheTrilinearField) {
    VolumeStage stage({{"volume/classify.glsl", std::string(value_as_colour)}});
    const LiveVolume volume(noise_volume(glm::ivec3(8), glm::dvec3(2.0, 3.0, 1.6), 5));
    const reference::Field field(volume.volume(), reference::Filter::trilinear);
    const Look look{.eye_mm = {40, -60, 25}, .fov_deg = 24};
    for (const bool least : {false, true}) {
        nlohmann::json parameters = maximum();
        parameters["function"] = least ? "minip" : "mip";
        const Miss m = miss(stage.cast(volume, parameters, look),
                            [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
                                const auto interval = reference::intersect(ray, field.texture_to_world());
                                if (!interval) {
                                    return glm::dvec4(0.0);
                                }
                                // What a ray sees while it cuts a corner depends on where exactly.
                                if (interval->length() < 1e-3) {
                                    return {};
                                }
                                const double value = (least ? reference::minimum(field, ray, *interval)
                                                            : reference::maximum(field, ray, *interval))
                                                         .value();
                                return glm::dvec4(glm::dvec3(value), 1.0);
                            });
        std::printf("  extremes of noise: worst %.2e\n", m.worst);
        EXPECT_LE(m.worst, 2e-6);
        EXPECT_GT(m.pixels, 4000);
    }
}

TEST(Maximum, OfAQuadraticInTheShaderIsF7) {
    // S0 - x'Qx/2 about a centre aside.
    const glm::dmat3 q(glm::dvec3(8e-4, 1e-4, -2e-4), glm::dvec3(1e-4, 5e-4, 3e-5),
                       glm::dvec3(-2e-4, 3e-5, 1.1e-3));
    const glm::dvec3 centre(3.0, -4.0, 2.5);
    VolumeStage stage(
        {{"volume/classify.glsl", std::string(value_as_colour)},
         {"volume/sample.glsl", field_text("const mat3 q = mat3(" + glsl(q[0]) + ", " + glsl(q[1]) + ", " +
                                               glsl(q[2]) + ");\nfloat field(vec3 p) { vec3 x = p - " +
                                               glsl(centre) + "; return 0.9 - 0.5 * dot(x, q * x); }",
                                           glm::dvec3(64.0))}});
    const LiveVolume volume(noise_volume(glm::ivec3(16), glm::dvec3(4.0), 5));
    for (const Look& look : {Look{.eye_mm = {90, -120, 50}, .fov_deg = 20},
                             Look{.eye_mm = {-50, 30, 90}, .orthographic_mm = 50}}) {
        const Miss m = miss(
            stage.cast(volume, maximum(), look), [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
                // F7 is the whole line's; rays whose maximum lies outside of the box end at its faces
                // instead.
                const glm::dvec3 o = ray.origin_mm - centre;
                const double s = -glm::dot(ray.direction, q * o) / glm::dot(ray.direction, q * ray.direction);
                const glm::dvec3 p = ray.at(s);
                if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 31.99) {
                    return {};
                }
                return glm::dvec4(glm::dvec3(reference::quadratic_maximum(ray, centre, q, 0.9)), 1.0);
            });
        std::printf("  maximum of a quadratic: worst %.2e of %d rays\n", m.worst, m.pixels);
        EXPECT_LE(m.worst, 2e-6);
        EXPECT_GT(m.pixels, 2000);
    }
}

}  // namespace
}  // namespace viscera::test
