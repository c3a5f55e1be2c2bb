// Line integrals through cylindrical and spherical volumes: polynomials that cross seam, axis and poles,
// voxels beside double precision, and what turning the data changes.

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/reference/volume_field.h"
#include "tests/reference/volume_sector.h"
#include "tests/volume/sector_stage.h"

namespace viscera::test {
namespace {

constexpr double radius_mm = 50.0;
constexpr double attenuation = 0.02;  // of the value 0, per mm

/// An X-ray of the value: attenuation (1 + value / 1000).
nlohmann::json xray(double step, std::string_view filter = "linear_fp32") {
    return {{"function", "xray"},
            {"xray", {{"water_attenuation_per_mm", attenuation}, {"negative", false}}},
            {"sampling", {{"step", step}, {"filter", filter}, {"skip", false}}}};
}

/// The picture that double precision gives for a value along the ray.
WantedColour wanted(const VolumeGrid& grid, const Shot& shot, double near_mm,
                    const std::function<double(const glm::dvec3& frame)>& value, int parts) {
    const reference::SectorRange all = reference::whole(grid.shape);
    const glm::dmat4 to_frame = glm::inverse(grid.frame_to_world());
    const double aside_mm = radius_mm / 4194304.0;
    return [=, &shot](const reference::Ray& ray) -> std::optional<glm::dvec4> {
        const auto length = [&](const reference::Ray& r) {
            double sum = 0.0;
            for (const reference::Interval& s :
                 reference::intersect(grid.shape, all, grid.frame_to_world(), r)) {
                sum += std::max(s.end - std::max(s.begin, shot.along(ray, near_mm)), 0.0);
            }
            return sum;
        };
        // At silhouettes floats do not hold the ray well enough.
        const double here = length(ray);
        const glm::dvec3 u = glm::normalize(glm::cross(ray.direction, glm::dvec3(0.31, 0.52, 0.79)));
        const glm::dvec3 v = glm::cross(ray.direction, u);
        for (const glm::dvec3& shift : {u, -u, v, -v}) {
            if (std::abs(length({ray.origin_mm + aside_mm * shift, ray.direction}) - here) > 1e-4) {
                return {};
            }
        }
        if (here == 0.0) {
            return std::nullopt;
        }
        double sum = 0.0;
        for (const reference::Interval& s :
             reference::intersect(grid.shape, all, grid.frame_to_world(), ray)) {
            const reference::Interval seen{std::max(s.begin, shot.along(ray, near_mm)), s.end};
            if (seen.end > seen.begin) {
                sum += reference::integral(seen, parts, [&](double t) {
                    return attenuation * (1.0 + value(to_frame * glm::dvec4(ray.at(t), 1.0)) / 1000.0);
                });
            }
        }
        const double intensity = std::exp(-sum);
        return glm::dvec4(intensity, intensity, intensity, 1.0);
    };
}

/// Polynomials of a place in units of the radius, in GLSL over curvilinear coordinates and in the frame.
struct Polynomial {
    const char* name;
    VolumeKind kind;
    std::string glsl;  ///< of `vec3 c`, in the order of the axes
    std::function<double(const glm::dvec3&)> value;
};
std::vector<Polynomial> polynomials() {
    const auto x = [](const glm::dvec3& p) { return 900.0 * p.x; };
    const auto saddle = [](const glm::dvec3& p) { return 900.0 * (p.x * p.x - p.y * p.y); };
    const auto axial = [](const glm::dvec3& p) { return 450.0 * (2.0 * p.z * p.z - p.x * p.x - p.y * p.y); };
    return {{"r cos(theta)", VolumeKind::cylindrical, "900.0 * c.x * cos(c.y)", x},
            {"r^2 cos(2 theta)", VolumeKind::cylindrical, "900.0 * c.x * c.x * cos(2.0 * c.y)", saddle},
            {"x", VolumeKind::spherical, "900.0 * c.z * cos(c.y) * cos(c.x)", x},
            {"(2 z^2 - x^2 - y^2) / 2", VolumeKind::spherical,
             "450.0 * c.z * c.z * (3.0 * sin(c.y) * sin(c.y) - 1.0)", axial}};
}

std::vector<Look> looks(const VolumeGrid& grid) {
    const glm::dvec3 centre = sector_centre(grid);
    const glm::dvec3 axis = grid.direction[2];
    return {{.eye_mm = centre + glm::dvec3(120, -150, 90), .target_mm = centre, .fov_deg = 34},
            {.eye_mm = grid.origin_mm + 200.0 * axis,
             .target_mm = grid.origin_mm,
             .up = {0, 1, 0},
             .fov_deg = 30},
            {.eye_mm = centre + 150.0 * grid.direction[1], .target_mm = centre, .orthographic_mm = 90.0},
            {.eye_mm = grid.origin_mm + 1e-3 * axis,
             .target_mm = centre + glm::dvec3(30, 5, 8),
             .fov_deg = 70,
             .near_mm = 0.01}};
}

TEST(SectorFields, PolynomialsAcrossSeamAxisAndPoles) {
    // The field in the shader: what is tested are places, limits and the integral.
    double worst = 0.0;
    for (const Polynomial& p : polynomials()) {
        SCOPED_TRACE(p.name);
        VolumeStage stage({{"volume/sample.glsl",
                            "#include \"volume/storage.glsl\"\n"
                            "float sample_volume(vec3 place) {\n"
                            "    vec3 c = (place - u_sample_offset) / u_sample_scale;\n"
                            "    return " +
                                p.glsl +
                                ";\n"
                                "}\n"
                                "vec3 sample_gradient(vec3 place) { return vec3(0.0); }\n"}});
        for (const NamedShape& named : some_shapes()) {
            if (named.shape.kind != p.kind || named.shape.angle_rad < 6.0) {
                continue;
            }
            VolumeShape shape = named.shape;
            shape.first_angle_rad = -0.5 * shape.angle_rad;  // the shader's angles are those of the frame
            const LiveVolume volume(sector_noise(shape, {16, 16, 16}, 1));
            const VolumeGrid& grid = volume.volume().grid;
            for (const Look& look : looks(grid)) {
                const Shot shot = stage.cast(volume, xray(0.05), look, glm::ivec2(24));
                const Miss m =
                    miss(shot, wanted(
                                   grid, shot, look.orthographic_mm > 0.0 ? 0.0 : look.near_mm,
                                   [&](const glm::dvec3& f) { return p.value(f / radius_mm); }, 6));
                EXPECT_LE(m.worst, 1e-5) << named.name << " pixel " << m.x << ", " << m.y;
                EXPECT_GT(m.pixels, 100) << named.name;
                worst = std::max(worst, m.worst);
            }
        }
    }
    std::printf("  worst %.1e\n", worst);
}

TEST(SectorFields, VoxelsAsDoublePrecisionInterpolatesThem) {
    double worst = 0.0;
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        VolumeStage stage;
        Volume noise = sector_noise(named.shape, {9, 11, 8}, 3);
        auto* const values = reinterpret_cast<float*>(noise.voxels.data());
        std::for_each(values, values + noise.grid.voxel_count(), [](float& v) { v = 600.0F * v; });
        const LiveVolume volume(noise);
        const VolumeGrid& grid = volume.volume().grid;
        const Look look = looks(grid).front();
        const Shot shot = stage.cast(volume, xray(0.05), look, glm::ivec2(20));
        const Miss m =
            miss(shot, wanted(
                           grid, shot, look.near_mm,
                           [&](const glm::dvec3& f) { return reference::sector_value(noise, f); }, 150));
        // Trilinear fields have kinks at the faces of cells, at which both sides integrate to second order.
        // Where first and last sample meet without being neighbours, the field jumps: first order.
        const bool jumps = !named.shape.wrap && named.shape.angle_rad > 6.0;
        EXPECT_LE(m.worst, jumps ? 5e-4 : 2e-4) << "pixel " << m.x << ", " << m.y;
        EXPECT_GT(m.pixels, 20);
        worst = std::max(worst, m.worst);
    }
    std::printf("  worst %.1e\n", worst);
}

/// The prefiltered B-spline through the samples of a ring or a sector, in double precision: along a ring
/// three turns of them are filtered, of which the middle one does not feel the ends.
std::function<double(const glm::dvec3&)> spline_of(const Volume& volume) {
    const glm::ivec3 n = volume.grid.dims;
    const int ring = volume.grid.shape.wrap_axis();
    glm::ivec3 turns(1);
    if (ring >= 0) {
        turns[ring] = 3;
    }
    const glm::ivec3 all = n * turns;
    std::vector<double> samples;
    for (int k = 0; k < all.z; ++k) {
        for (int j = 0; j < all.y; ++j) {
            for (int i = 0; i < all.x; ++i) {
                samples.push_back(volume.stored(glm::ivec3(i, j, k) % n));
            }
        }
    }
    const reference::Field field(all, std::move(samples), reference::Filter::bspline_prefiltered);
    const ShapeAxes axes = axes_of(volume.grid.shape, n);
    return [=, shape = volume.grid.shape](const glm::dvec3& frame) {
        glm::dvec3 index = (from_frame(shape, frame) - axes.first) / axes.step;
        if (ring >= 0) {
            index[ring] -= n[ring] * std::floor(index[ring] / n[ring]);
            index[ring] += n[ring];
        }
        return field.value((index + 0.5) / glm::dvec3(all));
    };
}

TEST(SectorFields, PolynomialsFromVoxelsAsDoublePrecisionSplines) {
    double worst = 0.0;
    double off = 0.0;
    VolumeStage stage;
    for (const Polynomial& p : polynomials()) {
        SCOPED_TRACE(p.name);
        for (const NamedShape& named : some_shapes()) {
            if (named.shape.kind != p.kind || !named.shape.wrap || named.shape.latitude_rad == 1.6) {
                continue;
            }
            const glm::ivec3 n =
                p.kind == VolumeKind::cylindrical ? glm::ivec3(12, 36, 8) : glm::ivec3(36, 19, 12);
            const Volume made =
                sector_volume(named.shape, n, [&](const glm::dvec3& f) { return p.value(f / radius_mm); });
            const auto spline = spline_of(made);
            const LiveVolume volume(made);
            const std::vector<Look> all = looks(made.grid);
            // Aslant, along the axis, and from its end: across the seam, the axis and the poles.
            for (const std::size_t view : {0U, 1U, 3U}) {
                const Look& look = all[view];
                const Shot shot = stage.cast(volume, xray(0.1, "bspline_fp32"), look, glm::ivec2(16));
                const Miss m = miss(shot, wanted(made.grid, shot, look.near_mm, spline, 60));
                EXPECT_LE(m.worst, 1e-5) << named.name << " view " << view << " pixel " << m.x << ", " << m.y;
                EXPECT_GT(m.pixels, 40) << named.name;
                worst = std::max(worst, m.worst);
                off = std::max(off,
                               miss(shot, wanted(
                                              made.grid, shot, look.near_mm,
                                              [&](const glm::dvec3& f) { return p.value(f / radius_mm); }, 6))
                                   .worst);
            }
        }
    }
    std::printf("  worst %.1e; from the polynomial itself, which so few voxels hold no better, %.1e\n", worst,
                off);
}

TEST(SectorFields, GradientsAreThoseOfTheWorldNextToAxisPolesAndCentre) {
    // A linear field has one gradient everywhere. In the picture: what metric() makes of the field's own
    // slopes.
    const glm::dvec3 normal(0.48, -0.6, 0.64);
    const std::string n = "vec3 n = " + glsl(normal) + ";\n";
    const std::string turned = "vec2 t = vec2(cos(a), sin(a));\n";
    double worst = 0.0;
    for (const VolumeKind kind : {VolumeKind::cylindrical, VolumeKind::spherical}) {
        const bool cylinder = kind == VolumeKind::cylindrical;
        const std::string slopes =
            cylinder
                ? "float a = c.y;\n" + turned +
                      "return vec3(dot(n.xy, t), c.x * dot(n.xy, vec2(-t.y, t.x)), n.z)"
                : "float a = c.x;\n" + turned +
                      "float u = dot(n.xy, t);\n"
                      "return vec3(c.z * cos(c.y) * dot(n.xy, vec2(-t.y, t.x)),\n"
                      "            c.z * (n.z * cos(c.y) - u * sin(c.y)), n.z * sin(c.y) + u * cos(c.y))";
        constexpr std::array<std::string_view, 1> functions{"finish"};
        VolumeStage stage(
            {{"volume/sample.glsl",
              "#include \"volume/storage.glsl\"\n"
              "float sample_volume(vec3 place) { return 0.0; }\n"
              "vec3 sample_gradient(vec3 place) {\n"
              "    vec3 c = (place - u_sample_offset) / u_sample_scale;\n" +
                  n + slopes + " / u_sample_scale;\n}\n"},
             {"volume/march.glsl",
              "uniform float u_slab;\n"
              "void march(Ray ray, vec2 interval, float offset, inout State state) {\n"
              "    if (interval.y > interval.x && state.depth == 0.0) {\n"
              "        vec3 local = ray.origin + 0.5 * (interval.x + interval.y) * ray.direction;\n"
              "        state.colour = metric(sample_gradient(to_sample(local)), local);\n"
              "        state.depth = length(local.xy);\n"
              "    }\n"
              "}\n"},
             {"volume/function_composite.glsl",
              wrapped("volume/function_composite.glsl", functions,
                      "vec4 finish(State state) { return vec4(state.colour, state.depth); }\n")}});
        VolumeShape shape = some_shapes()[cylinder ? 0 : 6].shape;
        shape.first_angle_rad = -0.5 * shape.angle_rad;
        // Fine along the radius: nearer than a hundredth of a voxel directions about the axis are not
        // resolved.
        const int radial = 1024;
        const LiveVolume volume(
            sector_noise(shape, cylinder ? glm::ivec3(radial, 8, 4) : glm::ivec3(8, 4, radial), 1));
        const double guard = 0.01 / (radial - 1);
        const VolumeGrid& grid = volume.volume().grid;
        const glm::dvec3 axis = grid.direction[2];
        const glm::dvec3 wanted_gradient = grid.direction * normal / radius_mm;
        const glm::dvec3 middle = sector_centre(grid);
        // Parallel rays along the axis, all of them within that distance of it, and from its end at a slant.
        for (const double height_mm : {90.0, 3.0, 0.1, 0.004}) {
            for (const bool slant : {false, true}) {
                const Look look{
                    .eye_mm = middle + 200.0 * (slant ? grid.direction * glm::dvec3(0.6, 0.3, 0.74) : axis),
                    .target_mm = middle,
                    .up = {0, 1, 0},
                    .orthographic_mm = height_mm};
                const Shot shot =
                    stage.cast(volume,
                               {{"sampling", {{"skip", false}}},
                                {"transfer_function", {{"points", {{{"value", 0}, {"opacity", 0.1}}}}}}},
                               look, glm::ivec2(20));
                int compared = 0;
                for (int i = 0; i < 400; ++i) {
                    const glm::dvec4 got = shot.at(i % 20, i / 20);
                    if (got.w <= guard) {
                        continue;
                    }
                    ++compared;
                    const double error = glm::length(glm::dvec3(got) - wanted_gradient) * radius_mm;
                    // Texture coordinates are rounded by 2^-25, which is so much more of a small radius; the
                    // rest is what sines and cosines lose.
                    const double bound = std::exp2(-24.0) / got.w + 2e-6;
                    EXPECT_LE(error, bound)
                        << i % 20 << ", " << i / 20 << " at " << got.w << " of " << height_mm;
                    worst = std::max(worst, error / bound);
                }
                EXPECT_GT(compared, 150);
            }
        }
    }
    std::printf("  %.2f of what rounding explains\n", worst);
}

/// The samples along the angle counted on from another one, and the frame turned back by as much.
Volume shifted(const Volume& volume, int by) {
    Volume result = volume;
    const glm::ivec3 n = volume.grid.dims;
    const int ring = volume.grid.shape.wrap_axis();
    auto* const to = reinterpret_cast<float*>(result.voxels.data());
    for (int k = 0; k < n.z; ++k) {
        for (int j = 0; j < n.y; ++j) {
            for (int i = 0; i < n.x; ++i) {
                glm::ivec3 from(i, j, k);
                from[ring] = (from[ring] + by) % n[ring];
                to[i + n.x * (j + n.y * k)] = static_cast<float>(volume.stored(from));
            }
        }
    }
    result.grid.shape.first_angle_rad += by * 2.0 * std::numbers::pi / n[ring];
    return result;
}

TEST(SectorFields, TurningTheDataAgainstTheFrameMovesNoPixel) {
    for (const char* filter :
         {"linear", "linear_fp32", "bspline", "bspline_fp32", "catmull_rom", "nearest"}) {
        double worst = 0.0;
        for (const NamedShape& named : some_shapes()) {
            if (!named.shape.wrap || named.shape.r_min_mm > 22.0) {
                continue;
            }
            SCOPED_TRACE(named.name);
            SCOPED_TRACE(filter);
            const bool cylinder = named.shape.kind == VolumeKind::cylindrical;
            const glm::ivec3 dims = cylinder ? glm::ivec3(10, 24, 9) : glm::ivec3(24, 13, 10);
            const Volume smooth = sector_volume(named.shape, dims, [](const glm::dvec3& p) {
                return 300.0 * std::sin(0.11 * p.x + 0.06 * p.z) * std::cos(0.09 * p.y) + 100.0;
            });
            VolumeStage stage;
            const Look look = looks(smooth.grid).front();
            const nlohmann::json parameters = xray(0.25, filter);
            const Shot before = stage.cast(LiveVolume(smooth), parameters, look, glm::ivec2(28));
            for (const int by : {5, 12, 23}) {
                const Shot after =
                    stage.cast(LiveVolume(shifted(smooth, by)), parameters, look, glm::ivec2(28));
                double most = 0.0;
                int off = 0;
                for (int y = 0; y < 28; ++y) {
                    for (int x = 0; x < 28; ++x) {
                        const double d = std::abs(before.at(x, y).x - after.at(x, y).x);
                        off += d > 1e-6 ? 1 : 0;
                        most = std::max(most, d);
                    }
                }
                // A nearest voxel may be another one by a rounding.
                if (std::string_view(filter) != "nearest") {
                    EXPECT_EQ(off, 0) << by << " off by " << most;
                    worst = std::max(worst, most);
                }
            }
        }
        std::printf("  %s: %.1e\n", filter, worst);
    }
}

}  // namespace
}  // namespace viscera::test
