#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "tests/stress/volume_scene.h"

// Cylindrical and spherical volumes at the ends of what they can be.
namespace viscera::test {
namespace {

using nlohmann::json;
using VolumeSectors = VolumeStress;

using std::numbers::pi;

/// About the world's origin, 8 mm in all.
Volume sector(VolumeShape shape, const glm::ivec3& dims, double value = 50.0) {
    Volume volume = constant_volume(dims, glm::dvec3(1.0), value);
    volume.grid.shape = shape;
    volume.grid.origin_mm = {0.0, 0.0, -0.5 * shape.height_mm};
    return volume;
}
VolumeShape cylinder(double angle, bool wrap = false) {
    return {
        .kind = VolumeKind::cylindrical, .r_max_mm = 4.0, .angle_rad = angle, .wrap = wrap, .height_mm = 6.0};
}
VolumeShape sphere(double angle, double latitude, bool wrap = false) {
    return {.kind = VolumeKind::spherical,
            .r_max_mm = 4.0,
            .angle_rad = angle,
            .wrap = wrap,
            .latitude_rad = latitude};
}

json under(const char* function, const char* filter, json parameters) {
    parameters["function"] = function;
    parameters["sampling"]["filter"] = filter;
    parameters["isosurface"]["values"] = {{{"value", 50}}};
    return parameters;
}

TEST_F(VolumeSectors, FlatOnesAreIdleAndSaySo) {
    VolumeShape thin = cylinder(pi);
    thin.r_min_mm = thin.r_max_mm;
    VolumeShape low = cylinder(pi);
    low.height_mm = 0.0;
    for (const VolumeShape& shape : {thin, low, cylinder(0.0), sphere(0.0, 1.0), sphere(1.0, 0.0)}) {
        const LiveVolume volume(sector(shape, {4, 5, 6}));
        EXPECT_TRUE(is_empty(cast(volume, homogeneous())));
        EXPECT_NE(said().find("an extent is 0"), std::string::npos) << said();
    }
}

TEST_F(VolumeSectors, EveryNumberOfVoxelsUnderEveryFunctionAndFilter) {
    int turn = 0;
    const std::array functions{"composite", "mip", "average", "xray", "isosurface"};
    const std::array filters{"linear",  "bspline",      "catmull_rom_fp32",
                             "nearest", "bspline_fp32", "linear_fp32"};
    for (const glm::ivec3 dims : {glm::ivec3(1), glm::ivec3(1, 5, 7), glm::ivec3(5, 1, 7),
                                  glm::ivec3(5, 7, 1), glm::ivec3(2), glm::ivec3(9, 2, 3)}) {
        for (const VolumeShape& shape : {cylinder(2.0 * pi, true), cylinder(2.0 * pi), cylinder(4.0),
                                         sphere(2.0 * pi, pi, true), sphere(5.0, pi), sphere(1.0, 1.0)}) {
            const LiveVolume volume(sector(shape, dims));
            const auto i = static_cast<std::size_t>(turn++);
            const Image image = cast(volume, under(functions.at(i % 5), filters.at(i % 6), homogeneous()));
            if (i % 5 < 3) {
                EXPECT_FALSE(is_empty(image)) << dims.x << dims.y << dims.z << functions.at(i % 5);
            }
        }
    }
}

/// The same camera for a view along the axis, which `up` would otherwise lie on.
json turned_up(json camera) {
    camera["up"] = {0, 1, 0};
    return camera;
}

TEST_F(VolumeSectors, HomogeneousOnesAreChordsFromAnywhere) {
    // A whole ball and a whole cylinder: closed forms from the axis, the centre, in a face and far away.
    for (const glm::ivec3 dims : {glm::ivec3(1, 4, 3), glm::ivec3(6, 5, 7)}) {
        const LiveVolume ball(sector(sphere(2.0 * pi, pi, true), dims));
        for (const json& camera_json :
             {camera({0, 0, 0}, {1, 0.2, 0.1}), turned_up(camera({0, 0, 9}, {0, 0, 0})),
              camera({0, 0, 4}, {0.1, 0, 0}), camera({3, -25, 4}, {0, 0, 0}),
              orthographic({0, -20, 0}, {0, 0, 0}, 8.0)}) {
            const Image image = cast(ball, homogeneous(), camera_json);
            // Whatever is seen of a ball of 8 mm absorbs no more than its diameter does.
            EXPECT_LE(image.at(10, 8, 3), 1.0 - std::pow(0.9, 8.0) + 1e-5);
            EXPECT_GT(image.at(10, 8, 3), 0.2);
        }
        const Image middle = cast(ball, homogeneous(), orthographic({0, -20, 0}, {0, 0, 0}, 0.01));
        EXPECT_NEAR(middle.at(10, 8, 3), 1.0 - std::pow(0.9, 8.0), 1e-5);
        const Image along = cast(ball, homogeneous(), turned_up(camera({0, 0, 0}, {0, 0, 1}, 1e-4)));
        EXPECT_NEAR(along.at(10, 8, 3), 1.0 - std::pow(0.9, 4.0), 1e-4);
        const LiveVolume bar(sector(cylinder(2.0 * pi), dims));
        const Image axial =
            cast(bar, homogeneous(), turned_up(orthographic({0, 0.001, 20}, {0, 0.001, 0}, 0.01)));
        EXPECT_NEAR(axial.at(10, 8, 3), 1.0 - std::pow(0.9, 6.0), 1e-5);
    }
}

TEST_F(VolumeSectors, OfAnySizeFarAwayAndStretched) {
    for (const double scale : {1e-6, 1e6}) {
        VolumeShape shape = cylinder(4.5);
        shape.r_min_mm = scale;
        shape.r_max_mm = 4.0 * scale;
        shape.height_mm = 6.0 * scale;
        const LiveVolume volume(sector(shape, {5, 6, 4}));
        const json eye{3.0 * scale, -25.0 * scale, 4.0 * scale};
        const Image image =
            cast(volume, under("mip", "linear", homogeneous()), camera(eye, {0, 0, 0}, scale, 100.0 * scale));
        EXPECT_FALSE(is_empty(image));
    }
    Volume far = sector(sphere(5.0, 2.0), {5, 6, 4});
    far.grid.origin_mm = {1e6, -1e6, 1e6};
    const Image image =
        cast(LiveVolume(far), homogeneous(), camera({1e6 + 3, -1e6 - 25, 1e6 + 4}, {1e6, -1e6, 1e6}));
    EXPECT_FALSE(is_empty(image));
    for (const json& scale : {json{1, 1000, 1}, json{1, 1, 0.001}, json{-1, 1, 1}}) {
        json parameters = under("mip", "linear", homogeneous());
        parameters["volume"]["placement"]["scale"] = scale;
        (void)cast(LiveVolume(sector(cylinder(2.0 * pi, true), {5, 6, 4})), parameters);
    }
    json singular = homogeneous();
    singular["volume"]["placement"]["scale"] = {1, 0, 1};
    EXPECT_TRUE(is_empty(cast(LiveVolume(sector(cylinder(4.0), {5, 6, 4})), singular)));
    EXPECT_NE(said().find("singular"), std::string::npos);
}

TEST_F(VolumeSectors, BrokenVoxelsCropsAndLongSteps) {
    Volume broken = sector(sphere(2.0 * pi, pi, true), {6, 5, 4});
    const std::array<float, 3> odd{std::numeric_limits<float>::quiet_NaN(),
                                   std::numeric_limits<float>::infinity(),
                                   -std::numeric_limits<float>::infinity()};
    std::memcpy(broken.voxels.data(), odd.data(), sizeof odd);
    const LiveVolume volume(broken);
    for (const char* filter : {"linear", "bspline", "catmull_rom"}) {
        (void)cast(volume, under("composite", filter, homogeneous()));
    }
    json cropped = homogeneous();
    cropped["crop"] = {{"first", {2, 4.5, 3}}, {"size", {1, 0.2, 0.5}}};
    (void)cast(volume, cropped);
    cropped["crop"]["first"] = {100, 0, 0};
    EXPECT_TRUE(is_empty(cast(volume, cropped)));
    json steps = homogeneous();
    for (const double step : {1e-9, 1e9}) {
        steps["sampling"]["step"] = step;
        (void)cast(volume, steps);
    }
}

TEST_F(VolumeSectors, GeometriesThatCannotBeAreRefused) {
    json parameters = homogeneous();
    parameters["volume"]["geometry"] = {{"kind", "cylindrical"}};
    expect_refused(scene(parameters, front()), ErrorCode::scene, "/volume/geometry");
    const auto of_file = [&](const json& geometry) {
        json document = scene(homogeneous(), front());
        document["passes"][0]["parameters"]["volume"] = {{"file", "any.mha"}, {"geometry", geometry}};
        return document;
    };
    expect_refused(of_file({{"kind", "cylindrical"}, {"wrap", true}, {"angle_deg", 90}}), ErrorCode::scene,
                   "wrap");
    expect_refused(of_file({{"kind", "spherical"}, {"r_min_mm", 9}, {"r_max_mm", 4}}), ErrorCode::scene,
                   "r_max_mm");
    expect_refused(of_file({{"kind", "conical"}}), ErrorCode::scene, "kind");
    expect_refused(of_file({{"kind", "spherical"}, {"latitude_deg", 200}}), ErrorCode::scene, "latitude_deg");
}

}  // namespace
}  // namespace viscera::test
