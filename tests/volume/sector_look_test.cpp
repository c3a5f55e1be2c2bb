// What is made of cylindrical and spherical volumes besides integrals: limits, meshes, labels, overlays, clip
// planes, slices, surfaces; and how much nearer to the truth they come than a box of as many voxels.

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "effects/volume/limits_effect.h"
#include "effects/volume/sector_mesh.h"
#include "engine/runtime/embedded_shaders.h"
#include "tests/reference/volume_sector.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/sector_stage.h"

namespace viscera::test {
namespace {

nlohmann::json glow() {
    return {{"points",
             {{{"value", 0}, {"colour", {0.9, 0.5, 0.3}}, {"opacity", 0.004}},
              {{"value", 200}, {"colour", {1.0, 0.95, 0.8}}, {"opacity", 0.05}}}}};
}

Volume waves(const VolumeShape& shape) {
    return sector_volume(shape, small_dims(shape), [](const glm::dvec3& p) {
        return 100.0 + 90.0 * std::sin(0.1 * p.x + 0.07 * p.z) * std::cos(0.12 * p.y);
    });
}

nlohmann::json camera_of(const VolumeGrid& grid, const glm::dvec3& from, double near_mm = 20.0) {
    const glm::dvec3 centre = sector_centre(grid);
    const glm::dvec3 eye = centre + from;
    return {{"eye_mm", {eye.x, eye.y, eye.z}},
            {"target_mm", {centre.x, centre.y, centre.z}},
            {"vertical_fov_deg", 36},
            {"near_mm", near_mm},
            {"far_mm", 1500.0}};
}

nlohmann::json cast(const char* limits, nlohmann::json more = nlohmann::json::object()) {
    more["transfer_function"] = glow();
    more["sampling"]["limits"] = limits;
    return more;
}

nlohmann::json limit_passes(const nlohmann::json& more, bool inner) {
    nlohmann::json parameters = more;
    parameters["volume"]["host"] = "host";
    nlohmann::json passes{{{"name", "entry"}, {"effect", "volume.entry"}, {"parameters", parameters}},
                          {{"name", "exit"}, {"effect", "volume.exit"}, {"parameters", parameters}}};
    if (inner) {
        passes.push_back({{"name", "in"}, {"effect", "volume.inner_entry"}, {"parameters", parameters}});
        passes.push_back({{"name", "out"}, {"effect", "volume.inner_exit"}, {"parameters", parameters}});
    }
    return passes;
}

TEST(SectorMesh, IsClosedFacesOutwardsAndEnclosesTheShapeClosely) {
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const volume::Space space =
            volume::make_space({.dims = small_dims(named.shape), .shape = named.shape}, PlacementParams{});
        const MeshData mesh = volume::sector_mesh(space, space.coordinates(glm::dvec3(0.0), glm::dvec3(1.0)));
        // Volume of the shape in units of the outer radius.
        const VolumeShape& s = named.shape;
        const double inner = s.r_min_mm / 50.0;
        const double wanted =
            s.kind == VolumeKind::cylindrical
                ? 0.5 * s.angle_rad * (1.0 - inner * inner) * s.height_mm / 50.0
                : s.angle_rad * 2.0 * std::sin(0.5 * s.latitude_rad) * (1.0 - inner * inner * inner) / 3.0;
        const double got = volume::signed_volume6(mesh) / 6.0;
        EXPECT_GT(got, wanted);
        EXPECT_LT(got, 1.02 * wanted);
        // Every edge of a triangle that has an area is walked once each way.
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        std::map<std::array<float, 3>, std::uint32_t> places;
        const auto place = [&](std::uint32_t i) {
            const glm::vec3 p = mesh.positions[i] + 0.0F;
            return places.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(places.size()))
                .first->second;
        };
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            const std::array<std::uint32_t, 3> c{place(mesh.indices[t]), place(mesh.indices[t + 1]),
                                                 place(mesh.indices[t + 2])};
            if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
                continue;
            }
            for (std::size_t i = 0; i < 3; ++i) {
                ++edges[{c.at(i), c.at((i + 1) % 3)}];
                --edges[{c.at((i + 1) % 3), c.at(i)}];
            }
        }
        EXPECT_TRUE(std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; }));
    }
}

TEST(SectorLimits, AnalyticDrawnAndMeshedOnesAgree) {
    Stage stage;
    TempFolder folder;
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const LiveVolume volume(waves(named.shape));
        const VolumeGrid& grid = volume.volume().grid;
        const bool cropped = std::string_view("ring bitten").find(named.name) != std::string_view::npos;
        nlohmann::json common = nlohmann::json::object();
        if (cropped) {
            common["crop"] = {{"first", {3, 5, 6}}, {"size", {15, 13, 12}}};
        }
        const nlohmann::json camera = camera_of(grid, {140, -150, 70});
        const Image analytic =
            mixed_shot(stage, mixed_scene(nlohmann::json::array(), cast("analytic", common), camera), volume);
        const Image drawn = mixed_shot(
            stage, mixed_scene(limit_passes(common, false), cast("two_pass", common), camera), volume);
        // The user's mesh is the sector's own here, a little larger and in the world.
        const volume::Space space = volume::make_space(grid, PlacementParams{});
        MeshData mesh = volume::sector_mesh(space, space.coordinates(glm::dvec3(0.0), glm::dvec3(1.0)));
        for (glm::vec3& p : mesh.positions) {
            p = space.local_to_world * glm::dvec4(p, 1.0);
        }
        nlohmann::json limits = common;
        limits["limits_mesh"] = folder.write(std::string(named.name) + ".obj", obj_text(mesh)).string();
        const Image meshed =
            mixed_shot(stage, mixed_scene(limit_passes(limits, true), cast("mesh", common), camera), volume);
        for (const auto& [what, other] : {std::pair("drawn", drawn), std::pair("meshed", meshed)}) {
            SCOPED_TRACE(what);
            const Difference d = difference(analytic, other, 1e-3);
            EXPECT_LE(d.mean, 1e-4);
            // At edges coverage decides; there the way through the volume is short.
            EXPECT_LE(d.above, 90U);
            EXPECT_GT(d.seen, 150U);
        }
        EXPECT_EQ(stage.complaints(), std::vector<std::string>{});
    }
}

/// Two boxes beside each other along x as one mesh.
MeshData two_boxes() {
    MeshData mesh = volume::box_mesh({-60, -30, -30}, {-20, 30, 30});
    const MeshData second = volume::box_mesh({15, -30, -30}, {55, 30, 30});
    for (const std::uint32_t i : second.indices) {
        mesh.indices.push_back(i + 8);
    }
    mesh.positions.insert(mesh.positions.end(), second.positions.begin(), second.positions.end());
    return mesh;
}

TEST(MeshLimits, AMeshMayBePassedTwice) {
    constexpr double sigma = 0.01;
    const LiveVolume whole(byte_volume(16, 10.0, [](const glm::dvec3&) { return 200.0; }));
    const double opacity = 1.0 - std::exp(-sigma);
    TempFolder folder;
    Stage stage;
    const nlohmann::json limits{{"limits_mesh", folder.write("two.obj", obj_text(two_boxes())).string()}};
    nlohmann::json p{{"sampling", {{"limits", "mesh"}, {"termination", 0}}}};
    p["transfer_function"]["points"] = {{{"value", 0}, {"opacity", opacity}},
                                        {{"value", 255}, {"opacity", opacity}}};
    for (const glm::dvec3 eye :
         {glm::dvec3(-420, 60, 40), glm::dvec3(-40, -5, 3), glm::dvec3(300, -200, 20)}) {
        const Image got =
            mixed_shot(stage, mixed_scene(limit_passes(limits, true), p, camera_at(eye, 2.0)), whole);
        const View view = stage.renderer().still(0.0).eye();
        std::size_t off = 0;
        std::size_t twice = 0;
        for (int y = 0; y < got.height; ++y) {
            for (int x = 0; x < got.width; ++x) {
                const PixelRay ray = pixel_ray(view, x, y, got.width, got.height);
                const glm::dvec2 a = box_interval(ray, {-60, -30, -30}, {-20, 30, 30});
                const glm::dvec2 b = box_interval(ray, {15, -30, -30}, {55, 30, 30});
                const double la = std::max(a.y - a.x, 0.0);
                const double lb = std::max(b.y - b.x, 0.0);
                const double error = std::abs(got.at(x, y, 3) - (1.0 - std::exp(-sigma * (la + lb))));
                off += error > 1e-4 ? 1 : 0;
                twice += la > 1.0 && lb > 1.0 && error <= 1e-4 ? 1 : 0;
            }
        }
        EXPECT_LE(off, 30U);  // edges, where coverage decides
        EXPECT_GT(twice, 100U);
    }
    EXPECT_EQ(stage.complaints(), std::vector<std::string>{});
}

/// Renders with more volumes of the host.
Shot cast_with(VolumeStage& stage, const std::vector<HostVolume>& volumes, nlohmann::json parameters,
               const Look& look, const glm::ivec2& size) {
    parameters["volume"]["host"] = "host";
    stage.stage().make_current();
    stage.stage().load(
        {{"version", 1},
         {"resolution", {size.x, size.y}},
         {"camera", to_json(look)},
         {"passes", {{{"name", "cast"}, {"effect", "volume.ray_cast"}, {"parameters", parameters}}}},
         {"targets", {{"volume.colour", {{"format", "rgba32f"}}}}},
         {"outputs", {"volume.colour"}}});
    Frame frame = stage.stage().renderer().still(0.0);
    frame.volumes = volumes;
    stage.stage().renderer().render(frame);
    return {stage.stage().renderer().read("volume.colour"), frame.eye()};
}

double worst_difference(const Shot& a, const Shot& b, std::size_t* above = nullptr, double limit = 0.0) {
    double worst = 0.0;
    for (int y = 0; y < a.image.height; ++y) {
        for (int x = 0; x < a.image.width; ++x) {
            const glm::dvec4 d = glm::abs(a.at(x, y) - b.at(x, y));
            const double most = std::max({d.x, d.y, d.z, d.w});
            worst = std::max(worst, most);
            if (above != nullptr && most > limit) {
                ++*above;
            }
        }
    }
    return worst;
}

TEST(SectorLooks, LabelsAndOverlayOfTheSameShapeFollowIt) {
    // One colour for each half of the turns, as labels of the volume's shape and as a box's labels: the same
    // but where a label's voxel ends elsewhere.
    for (const char* name : {"ring", "ball", "gap"}) {
        SCOPED_TRACE(name);
        const VolumeShape shape = [&] {
            for (const NamedShape& named : some_shapes()) {
                if (std::string_view(named.name) == name) {
                    return named.shape;
                }
            }
            return VolumeShape{};
        }();
        const LiveVolume volume(waves(shape));
        const auto half = [](const glm::dvec3& p) { return p.x > 3.0 ? 1.0 : 0.0; };
        const glm::ivec3 n =
            shape.kind == VolumeKind::cylindrical ? glm::ivec3(64, 256, 4) : glm::ivec3(256, 128, 64);
        const LiveVolume curved(sector_volume(shape, n, half));
        const VolumeGrid& grid = volume.volume().grid;
        Volume box = float_volume({230, 230, 230}, glm::dvec3(0.5), [&](const glm::dvec3&) { return 0.0; });
        box.grid.origin_mm += sector_centre(grid);
        auto* const values = reinterpret_cast<float*>(box.voxels.data());
        const glm::dmat4 to_frame = glm::inverse(grid.frame_to_world());
        for (std::size_t i = 0; i < box.grid.voxel_count(); ++i) {
            const glm::dvec3 index(i % 230, i / 230 % 230, i / 230 / 230);
            values[i] = static_cast<float>(half(to_frame * glm::dvec4(box.grid.world_of_index(index), 1.0)));
        }
        const LiveVolume straight(box);
        const Look look{.eye_mm = sector_centre(grid) + glm::dvec3(110, -150, 80),
                        .target_mm = sector_centre(grid),
                        .fov_deg = 34};
        nlohmann::json p{{"transfer_function", glow()}};
        p["labels"] = {{"host", "labels"},
                       {"segments", {{{"id", 1}, {"colour", {0.1, 0.9, 0.2}}, {"opacity_factor", 3.0}}}}};
        nlohmann::json q{{"transfer_function", glow()}};
        q["overlay"] = {{"host", "labels"}, {"strength", 0.8}};
        for (const nlohmann::json& parameters : {p, q}) {
            VolumeStage stage;
            const Shot a =
                cast_with(stage, {{"host", &volume}, {"labels", &curved}}, parameters, look, glm::ivec2(40));
            const Shot b = cast_with(stage, {{"host", &volume}, {"labels", &straight}}, parameters, look,
                                     glm::ivec2(40));
            const Shot none =
                cast_with(stage, {{"host", &volume}}, {{"transfer_function", glow()}}, look, glm::ivec2(40));
            std::size_t above = 0;
            EXPECT_LT(worst_difference(a, b, &above, 0.02), 0.2);
            EXPECT_LE(above, 60U);  // the halves' border crosses the picture, 40 pixels high, twice
            EXPECT_GT(worst_difference(a, none), 0.1);
        }
    }
}

TEST(SectorLooks, LabelsOfAnotherShapeAreRefused) {
    const LiveVolume volume(waves(some_shapes()[0].shape));
    const LiveVolume other(waves(some_shapes()[1].shape));
    VolumeStage stage;
    EXPECT_THROW(
        (void)cast_with(stage, {{"host", &volume}, {"labels", &other}},
                        {{"transfer_function", glow()}, {"labels", {{"host", "labels"}}}}, {}, glm::ivec2(8)),
        Error);
    EXPECT_THROW((void)cast_with(stage, {{"host", &volume}},
                                 {{"transfer_function", glow()}, {"sampling", {{"scheme", "cell"}}}}, {},
                                 glm::ivec2(8)),
                 Error);
}

TEST(SectorLooks, ClipPlanesAndSubVolumesCutThem) {
    VolumeStage stage(chords_shown());
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const LiveVolume volume(waves(named.shape));
        const VolumeGrid& grid = volume.volume().grid;
        const glm::dvec3 centre = sector_centre(grid);
        const glm::dvec3 normal = glm::normalize(glm::dvec3(0.4, -0.3, 0.6));
        const Look look{.eye_mm = centre + glm::dvec3(110, -150, 80), .target_mm = centre, .fov_deg = 34};
        const nlohmann::json p{
            {"transfer_function", glow()},
            {"sampling", {{"skip", false}}},
            {"clip_planes",
             {{{"point_mm", {centre.x, centre.y, centre.z}}, {"normal", {normal.x, normal.y, normal.z}}}}}};
        const Shot shot = stage.cast(volume, p, look, glm::ivec2(32));
        const Miss m = miss(shot, [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
            const double rise = glm::dot(normal, ray.direction);
            const double at = -glm::dot(normal, ray.origin_mm - centre) / rise;
            double length = 0.0;
            int pieces = 0;
            for (reference::Interval s :
                 reference::intersect(grid.shape, reference::whole(grid.shape), grid.frame_to_world(), ray)) {
                s.begin = std::max({s.begin, shot.along(ray, 1.0), rise > 0.0 ? at : -1e300});
                s.end = std::min(s.end, rise > 0.0 ? 1e300 : at);
                length += std::max(s.end - s.begin, 0.0);
                pieces += s.end > s.begin ? 1 : 0;
            }
            return length > 1.0 ? std::optional(glm::dvec4(length, pieces, 0.0, 1.0)) : std::nullopt;
        });
        EXPECT_LE(m.worst, 0.01) << m.x << " " << m.y;
        EXPECT_GT(m.pixels, 30);
    }
}

TEST(SectorSlices, ShowWhatLiesOnThePlane) {
    Stage stage;
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        Volume made = waves(named.shape);
        const LiveVolume volume(made);
        const VolumeGrid& grid = made.grid;
        const glm::dvec3 centre = sector_centre(grid);
        const double height = 130.0;
        stage.load({{"version", 1},
                    {"resolution", {48, 48}},
                    {"camera", to_json({})},
                    {"passes",
                     {{{"name", "slice"},
                       {"effect", "volume.slice"},
                       {"parameters",
                        {{"volume", {{"host", "host"}}},
                         {"height_mm", height},
                         {"background", {0, 0, 1, 1}},
                         {"sampling", {{"filter", "linear_fp32"}}},
                         {"transfer_function", {{"window", {{"width", 200}, {"level", 100}}}}},
                         {"plane",
                          {{"oblique",
                            {{"point_mm", {centre.x, centre.y, centre.z}},
                             {"normal", {0.2, -0.3, 0.9}},
                             {"up", {0, 1, 0}}}}}}}}}}},
                    {"targets", {{"volume.slice", {{"format", "rgba32f"}}}}},
                    {"outputs", {"volume.slice"}}});
        const HostVolume given{"host", &volume};
        Frame frame = stage.renderer().still(0.0);
        frame.volumes = std::span(&given, 1);
        stage.renderer().render(frame);
        const Image got = stage.renderer().read("volume.slice");
        const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, -0.3, 0.9));
        const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), normal));
        const glm::dvec3 up = glm::cross(normal, right);
        const glm::dmat4 to_frame = glm::inverse(grid.frame_to_world());
        int inside = 0;
        int edges = 0;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 48; ++x) {
                const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / 48.0 - 0.5;
                const glm::dvec3 frame_place =
                    to_frame * glm::dvec4(centre + height * (at.x * right + at.y * up), 1.0);
                const bool here = reference::inside(grid.shape, reference::whole(grid.shape), frame_place);
                const bool shown = !(got.at(x, y, 0) == 0.0F && got.at(x, y, 2) == 1.0F);
                if (here != shown) {
                    ++edges;
                } else if (here) {
                    ++inside;
                    const double value = reference::sector_value(made, frame_place);
                    EXPECT_NEAR(got.at(x, y, 0), std::clamp(value / 200.0, 0.0, 1.0), 5e-6) << x << " " << y;
                }
            }
        }
        EXPECT_LE(edges, 2);
        EXPECT_GT(inside, 60);
    }
}

TEST(SectorSurfaces, LieWhereTheFieldSaysSo) {
    // A ball beside the axis in a ring and in a sphere, from smooth data: where rays meet it, within a
    // thousandth of a voxel of the interpolated field, and in order.
    const std::string file = "volume/function_isosurface.glsl";
    constexpr std::string_view lit = "vec3 lit = ";
    std::string text = embedded_shader(file).value();
    text.replace(text.find(lit), lit.size(), "vec3 lit = local; ");
    VolumeStage stage(ShaderTexts{{file, text}});
    for (const char* name : {"ring", "ball", "gap", "shell"}) {
        SCOPED_TRACE(name);
        VolumeShape shape;
        for (const NamedShape& named : some_shapes()) {
            shape = std::string_view(named.name) == name ? named.shape : shape;
        }
        const bool cylinder = shape.kind == VolumeKind::cylindrical;
        const Volume made =
            sector_volume(shape, cylinder ? glm::ivec3(24, 48, 28) : glm::ivec3(48, 31, 24),
                          [](const glm::dvec3& p) { return glm::length(p - glm::dvec3(-9, 4, 22)); });
        const LiveVolume volume(made);
        const VolumeGrid& grid = made.grid;
        const glm::dmat4 to_frame = glm::inverse(grid.frame_to_world());
        const glm::dvec3 target = grid.frame_to_world() * glm::dvec4(-9, 4, 22, 1);
        const Look look{.eye_mm = target + glm::dvec3(110, -150, 80), .target_mm = target, .fov_deg = 12};
        const nlohmann::json p{{"function", "isosurface"},
                               {"isosurface", {{"values", {{{"value", 16.0}}}}}},
                               {"sampling", {{"filter", "linear_fp32"}}}};
        const Shot shot = stage.cast(volume, p, look, glm::ivec2(40));
        const volume::Space space = volume::make_space(grid, PlacementParams{});
        double worst = 0.0;
        int hits = 0;
        int missed = 0;
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 40; ++x) {
                const reference::Ray ray = shot.ray(x, y);
                // The first crossing by small steps and halving.
                const auto value = [&](double s) {
                    return reference::sector_value(made, to_frame * glm::dvec4(ray.at(s), 1.0)) - 16.0;
                };
                double first = -1.0;
                double least = 1e300;
                for (const reference::Interval& s :
                     reference::intersect(shape, reference::whole(shape), grid.frame_to_world(), ray)) {
                    const int steps = static_cast<int>(s.length() / 0.2) + 1;
                    for (int i = 0; i < steps && first < 0.0; ++i) {
                        double a = s.begin + s.length() * i / steps + 1e-9;
                        double b = s.begin + s.length() * (i + 1) / steps - 1e-9;
                        least = std::min(least, std::abs(value(a)));
                        if ((value(a) < 0.0) == (value(b) < 0.0)) {
                            continue;
                        }
                        const bool falls = value(a) > 0.0;
                        for (int k = 0; k < 40; ++k) {
                            const double m = 0.5 * (a + b);
                            ((value(m) > 0.0) == falls ? a : b) = m;
                        }
                        first = 0.5 * (a + b);
                    }
                }
                const bool hit = shot.at(x, y).w > 0.5;
                if (hit != (first >= 0.0)) {
                    missed += least > 0.02 || hit ? 1 : 0;  // grazing by a hundredth of a voxel
                    continue;
                }
                if (hit) {
                    ++hits;
                    const glm::dvec3 met = space.local_to_world * glm::dvec4(glm::dvec3(shot.at(x, y)), 1.0);
                    const double s = glm::dot(met - ray.at(0.0), ray.at(1.0) - ray.at(0.0));
                    worst = std::max(worst, std::abs(s - first));
                }
            }
        }
        EXPECT_EQ(missed, 0);
        EXPECT_GT(hits, 200);
        EXPECT_LE(worst, 1e-3 * 50.0 / 24.0);  // a thousandth of the radial spacing
    }
}

TEST(SectorAccuracy, ABoxOfAsManyVoxelsIsTenTimesWorse) {
    // Detail as a probe sees it: fine in its own coordinates near the axis, sampled directly and by way of a
    // box.
    VolumeShape shape{.kind = VolumeKind::cylindrical,
                      .r_min_mm = 4.0,
                      .r_max_mm = 50.0,
                      .angle_rad = 2.0 * std::numbers::pi,
                      .wrap = true,
                      .height_mm = 40.0};
    const auto field = [](const glm::dvec3& p) {
        const double r = std::hypot(p.x, p.y);
        return 400.0 +
               300.0 * std::sin(6.0 * std::atan2(p.y, p.x)) * std::exp(-r / 12.0) * std::cos(0.1 * p.z);
    };
    const glm::ivec3 n(48, 128, 24);
    const Volume direct = sector_volume(shape, n, field);
    const VolumeGrid& grid = direct.grid;
    // The box has as many voxels, cubes as nearly as may be, each with the value that the sector's samples
    // give there.
    const glm::dmat4 box = grid.box_to_world();
    const double side = std::cbrt(100.0 * 100.0 * 40.0 / (48.0 * 128.0 * 24.0));
    Volume resampled = float_volume(glm::ivec3(100.0 / side, 100.0 / side, 40.0 / side), glm::dvec3(1.0),
                                    [](const glm::dvec3&) { return 0.0; });
    VolumeGrid& straight = resampled.grid;
    straight.spacing_mm = glm::dvec3(100.0, 100.0, 40.0) / glm::dvec3(straight.dims);
    straight.direction = grid.direction;
    straight.origin_mm = box * glm::dvec4(0.5 / glm::dvec3(straight.dims), 1.0);
    auto* const values = reinterpret_cast<float*>(resampled.voxels.data());
    const glm::dmat4 to_frame = glm::inverse(grid.frame_to_world());
    for (std::size_t i = 0; i < straight.voxel_count(); ++i) {
        const auto nx = static_cast<std::size_t>(straight.dims.x);
        const auto ny = static_cast<std::size_t>(straight.dims.y);
        const glm::dvec3 place =
            to_frame * glm::dvec4(straight.world_of_index(glm::dvec3(i % nx, i / nx % ny, i / nx / ny)), 1.0);
        const double r = std::hypot(place.x, place.y);
        values[i] =
            r < 4.0 || r > 50.0 ? -1000.0F : static_cast<float>(reference::sector_value(direct, place));
    }
    const Look look{.eye_mm = sector_centre(grid) + glm::dvec3(60, -120, 90),
                    .target_mm = sector_centre(grid),
                    .fov_deg = 32};
    const nlohmann::json p{{"function", "xray"},
                           {"xray", {{"water_attenuation_per_mm", 0.01}, {"negative", false}}},
                           {"sampling", {{"step", 0.25}, {"filter", "linear_fp32"}}}};
    VolumeStage stage;
    const glm::ivec2 size(40);
    const auto error_of = [&](const Volume& shown) {
        const Shot shot = stage.cast(LiveVolume(shown), p, look, size);
        return miss(shot, [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
            double sum = 0.0;
            for (const reference::Interval& s :
                 reference::intersect(shape, reference::whole(shape), grid.frame_to_world(), ray)) {
                sum += reference::integral(s, 24, [&](double t) {
                    return 0.01 * (1.0 + field(to_frame * glm::dvec4(ray.at(t), 1.0)) / 1000.0);
                });
            }
            const double intensity = std::exp(-sum);
            return sum > 0.0 ? std::optional(glm::dvec4(glm::dvec3(intensity), 1.0)) : std::nullopt;
        });
    };
    const Miss curved = error_of(direct);
    const Miss boxed = error_of(resampled);
    std::printf("  rms %.2e direct, %.2e by way of a box of as many voxels\n", curved.rms, boxed.rms);
    EXPECT_GT(boxed.rms, 10.0 * curved.rms);
}

}  // namespace
}  // namespace viscera::test
