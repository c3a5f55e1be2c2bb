#include <array>
#include <cmath>
#include <limits>

#include "tests/stress/volume_scene.h"

// Transfer functions, samplings, crops, surfaces, placements, labels, overlays and planes at their ends.
namespace viscera::test {
namespace {

using nlohmann::json;
using VolumeLooks = VolumeStress;

constexpr std::array functions{"composite", "mip",        "minip",      "average",
                               "xray",      "isosurface", "accumulate", "density"};
constexpr std::array schemes{"midpoint", "gauss", "preintegrated", "cell"};
constexpr std::array filters{"nearest",      "linear",      "linear_fp32",     "bspline",
                             "bspline_fp32", "catmull_rom", "catmull_rom_fp32"};

json knot(double value, double opacity) {
    return {{"value", value}, {"colour", {0.25, 0.5, 1}}, {"opacity", opacity}};
}

Volume block(double value = 50.0) {
    return constant_volume(glm::ivec3(4), glm::dvec3(2.0), value);
}

TEST_F(VolumeLooks, EveryFunctionWithEveryFilterAndEveryScheme) {
    const LiveVolume ball(ball_volume(6));
    // Cheap programs only: the tricubic filters take their turn with one scheme each.
    for (std::size_t f = 0; f < functions.size(); ++f) {
        for (std::size_t i = 0; i < schemes.size(); ++i) {
            const std::size_t filter = (f + i) % (i == 1 ? filters.size() : 3);
            json parameters = ramp();
            parameters["function"] = functions[f];
            parameters["sampling"] = {{"scheme", schemes[i]}, {"filter", filters[filter]}};
            parameters["isosurface"]["values"] = {{{"value", 40}}};
            EXPECT_GT(largest(cast(ball, parameters)), 0.01F)
                << functions[f] << " " << schemes[i] << " " << filters[filter];
        }
    }
    EXPECT_TRUE(renderer().log().faults().empty()) << said();
}

TEST_F(VolumeLooks, ColoursAtTheirEnds) {
    constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const json list = json::array({json::object(), json::object(), json::object()});
    for (const glm::ivec3& dims : {glm::ivec3(1), glm::ivec3(5, 1, 7), glm::ivec3(4)}) {
        for (const float odd : {0.0F, 1e37F, -1e37F, nan_value, infinity}) {
            Volume volume = constant_volume(dims, glm::dvec3(2.0), 7.0);
            std::vector<float> values(3 * volume.grid.voxel_count(), 7.0F);
            values[values.size() / 2] = odd;
            volume.channels = 3;
            const auto bytes = std::as_bytes(std::span(values));
            volume.voxels.assign(bytes.begin(), bytes.end());
            const LiveVolume live(std::move(volume));
            for (const auto& [opacity, samples, brightness] :
                 {std::tuple(0.0, 1.0, 0.0), std::tuple(1e30, 1.0, 1e30), std::tuple(1.0, 1e9, -1e30)}) {
                json parameters{{"function", "accumulate"}};
                parameters["accumulate"] = {{"opacity", opacity},
                                            {"samples", samples},
                                            {"brightness", brightness},
                                            {"channels", list}};
                (void)cast(live, parameters);
                parameters["shading"] = {{"enabled", true},
                                         {"lights", {{{"direction", {0, 0, 1}}}}},
                                         {"light_volume", {{"shadow", 1}, {"ambient_occlusion", 1}}}};
                parameters["sampling"]["filter"] = "bspline";
                (void)cast(live, parameters);
                parameters["accumulate"]["channels"][1]["threshold"] = {1.0, 0.0};
                EXPECT_TRUE(is_empty(cast(live, parameters)));
            }
        }
    }
}

TEST_F(VolumeLooks, KeptGradientsOfAnyNumbers) {
    constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const glm::ivec3& dims : {glm::ivec3(1), glm::ivec3(5, 1, 7), glm::ivec3(4)}) {
        for (const double odd : {0.0, 50.0, 3e38, -3e38, 1e-40, nan_value, infinity}) {
            const LiveVolume volume(make_volume(dims, glm::dvec3(2.0), [&](const glm::ivec3& i) {
                return (i.x + i.y + i.z) % 3 == 1 ? odd : odd == 1e-40 ? 0.0 : 50.0;
            }));
            json parameters = homogeneous();
            parameters["shading"] = {{"enabled", true}};
            parameters["sampling"]["gradient"] = "precomputed";
            EXPECT_FALSE(is_empty(cast(volume, parameters))) << odd;
        }
    }
}

TEST_F(VolumeLooks, TransferFunctionsOfNothingOneKnotAndSteps) {
    const LiveVolume volume(block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const char* scheme : {"gauss", "preintegrated"}) {
        json parameters = homogeneous();
        parameters["sampling"]["scheme"] = scheme;
        json& points = parameters["transfer_function"]["points"];
        points = json::array();
        EXPECT_TRUE(is_empty(cast(volume, parameters)));
        points = {knot(50, 0.1)};
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "one knot");
        points = {knot(-1e30, 0.1), knot(1e30, 0.1)};
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "knots far apart");
        points = {knot(1e300, 0.1), knot(-1e300, 0.1)};
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "knots turned round");
        points = {knot(20, 0), knot(20, 0.1), knot(80, 0.1), knot(80, 0)};
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "steps beside the value");
        points = {knot(50.0001, 0), knot(50.0001, 1)};
        EXPECT_TRUE(is_empty(cast(volume, parameters)));
        points = {knot(60, 0), knot(70, 1)};
        EXPECT_TRUE(is_empty(cast(volume, parameters)));
        // All knots at the volume's value: the last one holds.
        points = {knot(50, 0.7), knot(50, 0), knot(50, 0.9), knot(50, 0.1)};
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "all knots in one place");
        points = json::array();
        for (int i = 0; i < 3000; ++i) {
            points.push_back(knot(49.0 + 0.001 * i, 0.1));
        }
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "thousands");
    }
}

TEST_F(VolumeLooks, FullOpacityAndReferenceLengths) {
    const LiveVolume volume(block());
    for (const char* scheme : {"midpoint", "gauss", "preintegrated", "cell"}) {
        for (const double reference : {1.0, 1e-30, 1e-300, 1e30, 1e300}) {
            for (const bool terminates : {false, true}) {
                json parameters = homogeneous();
                parameters["transfer_function"]["points"] = {knot(50, 1.0)};
                parameters["transfer_function"]["reference_length_mm"] = reference;
                parameters["sampling"] = {{"scheme", scheme}, {"termination", terminates ? 0.002 : 0.0}};
                const Image image = cast(volume, parameters);
                if (reference <= 1.0) {
                    EXPECT_NEAR(image.at(10, 8, 3), 1.0, 1e-3) << scheme << " " << reference;
                    EXPECT_NEAR(image.at(10, 8, 1), 0.5, 1e-3) << scheme << " " << reference;
                } else {
                    EXPECT_LT(largest(image), 1e-6F) << scheme << " " << reference;
                }
            }
        }
    }
}

TEST_F(VolumeLooks, StepsTinyAndLargerThanTheVolume) {
    const LiveVolume volume(block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const char* scheme : {"midpoint", "gauss", "preintegrated", "cell"}) {
        for (const double step : {1e-300, 1e-3, 0.37, 4.0, 100.0, 1e30, 1e300}) {
            json parameters = homogeneous();
            parameters["sampling"]["scheme"] = scheme;
            parameters["sampling"]["step"] = step;
            const double tolerance = step < 0.01 ? 5e-4 : 3e-5;  // tens of thousands of sums in floats
            expect_homogeneous(cast(volume, parameters, camera({3, -40, 4}, {0, 0, 0})), to_world, tolerance,
                               std::string(scheme) + " " + std::to_string(step));
        }
    }
    expect_said_once("volume.step", "it is made longer");
    json parameters = homogeneous();
    parameters["sampling"]["step"] = 0;
    expect_refused(scene(parameters, front()), ErrorCode::scene, "/sampling/step");
}

TEST_F(VolumeLooks, CropsOfNothingAndBesideTheVolume) {
    const LiveVolume volume(block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const char* function : functions) {
        for (const json& crop :
             {json{{"first", {4, 0, 0}}}, json{{"first", {1e9, 1e300, 9}}, {"size", {1, 1, 1}}},
              json{{"first", {0, 0, 4}}, {"size", {9, 9, 9}}}}) {
            json parameters = homogeneous();
            parameters["function"] = function;
            parameters["crop"] = crop;
            parameters["isosurface"]["values"] = {{{"value", 50}}};
            EXPECT_EQ(cast(volume, parameters).at(10, 8, 3), 0.0F) << function << crop;
        }
    }
    json parameters = homogeneous();
    parameters["crop"] = {{"first", {0, 0, 0}}, {"size", {0, 0, 0}}};
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "size 0 is all");
    parameters["crop"] = {{"first", {1, 0, 2.5}}, {"size", {2, 1e300, 0.5}}};
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "a part", {0.25, 0.0, 0.625},
                       {0.75, 1.0, 0.75});
    parameters["crop"] = {{"first", {1, 1, 1}}, {"size", {1e-9, 1e-300, 1}}};
    EXPECT_LT(largest(cast(volume, parameters)), 1e-3F);
    parameters["crop"] = {{"first", {-1, 0, 0}}};
    expect_refused(scene(parameters, front()), ErrorCode::scene, "/crop/first");
}

TEST_F(VolumeLooks, SurfacesOnPlateausOutsideAndThroughVoxels) {
    const LiveVolume plateau(make_volume(glm::ivec3(6), glm::dvec3(1.5), [](const glm::ivec3& i) {
        return i.x < 2 ? 0.0 : i.x < 4 ? 50.0 : 100.0;
    }));
    const LiveVolume ball(ball_volume(8));
    const auto surfaces = [](const json& values) {
        json parameters{{"function", "isosurface"}};
        for (const json& value : values) {
            parameters["isosurface"]["values"].push_back({{"value", value}, {"opacity", 0.5}});
        }
        return parameters;
    };
    for (const double value : {50.0, 0.0, 100.0, 25.0}) {
        (void)cast(plateau, surfaces({value}));
        (void)cast(LiveVolume(block()), surfaces({value}));
        (void)cast(ball, surfaces({value}));
    }
    EXPECT_GT(largest(cast(plateau, surfaces({25}), camera({-25, 1, 2}, {0, 0, 0}))), 0.4F);
    EXPECT_GT(largest(cast(plateau, surfaces({50}), camera({-25, 1, 2}, {0, 0, 0}))), 0.4F);
    for (const double value : {-1.0, 101.0, 1e30, -1e300, 1e300}) {
        EXPECT_TRUE(is_empty(cast(ball, surfaces({value})))) << value;
        EXPECT_TRUE(is_empty(cast(plateau, surfaces({value})))) << value;
    }
    (void)cast(ball, surfaces({10, 20, 30, 40, 50, 60, 70, 80}));
    (void)cast(ball, surfaces({50, 50, 50}));
    json none{{"function", "isosurface"}};
    EXPECT_TRUE(is_empty(cast(ball, none)));
    give("host", &ball);
    expect_refused(scene(surfaces({1, 2, 3, 4, 5, 6, 7, 8, 9}), front()), ErrorCode::scene,
                   "/isosurface/values");
}

TEST_F(VolumeLooks, PlacementsSingularMirroredAndHuge) {
    const LiveVolume volume(block());
    const auto placed = [](const json& scale) {
        json parameters = homogeneous();
        parameters["volume"]["placement"]["scale"] = scale;
        return parameters;
    };
    for (const json& scale : {json{0, 1, 1}, json{0, 0, 0}, json{1, 1, 0}}) {
        EXPECT_TRUE(is_empty(cast(volume, placed(scale))));
    }
    expect_said_once("volume.singular", "placement is singular");
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const json& scale : {json{-1, 1, 1}, json{-1, -1, -1}, json{1, -1, -1}}) {
        expect_homogeneous(cast(volume, placed(scale)), to_world, 3e-5, scale.dump());
    }
    for (const double scale : {1e-300, 1e-100, 1e-30, 1e-9, 1e9, 1e30, 1e100, 1e300}) {
        for (const char* function : functions) {
            json parameters = placed({scale, scale, -scale});
            parameters["function"] = function;
            parameters["isosurface"]["values"] = {{{"value", 50}}};
            (void)cast(volume, parameters);
        }
        json parameters = placed({scale, 1, 1});
        (void)cast(volume, parameters);
        parameters = placed({1, 1, 1});
        parameters["volume"]["placement"]["move_mm"] = {scale, 0, 0};
        parameters["volume"]["placement"]["rotate_deg"] = {0, scale, 0};
        (void)cast(volume, parameters);
    }
}

TEST_F(VolumeLooks, LabelsOfNoneBesideAndBroken) {
    const LiveVolume volume(block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    const LiveVolume same(constant_volume(glm::ivec3(4), glm::dvec3(2.0), 3.0, ScalarType::u8));
    Volume far = constant_volume(glm::ivec3(2), glm::dvec3(2.0), 3.0, ScalarType::u8);
    far.grid.origin_mm += 1000.0;
    const LiveVolume beside(std::move(far));
    const LiveVolume broken(constant_volume(glm::ivec3(3), glm::dvec3(2.0), 3.5));
    const LiveVolume no_number(
        constant_volume(glm::ivec3(3), glm::dvec3(2.0), std::numeric_limits<double>::quiet_NaN()));
    json parameters = homogeneous();
    parameters["labels"] = {{"host", "labels"}, {"segments", {{{"id", 3}, {"visible", false}}}}};
    give("labels", &same);
    EXPECT_TRUE(is_empty(cast(volume, parameters)));
    for (const LiveVolume* labels : {&beside, &broken, &no_number}) {
        give("labels", labels);
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "no voxel of the id");
    }
    expect_said_once("volume.labels", "not whole numbers");
    give("labels", &same);
    parameters["labels"]["segments"][0]["id"] = 77;
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "an id that no voxel has");
    parameters["labels"]["segments"] = json::array();
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "no segments");
    for (const int id : {-2147483647, 2147483647}) {
        parameters["labels"]["segments"] = {{{"id", id}, {"visible", false}}};
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "ids of any size");
    }
    parameters["sampling"]["scheme"] = "preintegrated";
    parameters["labels"]["segments"] = {{{"id", 3}, {"visible", false}}};
    EXPECT_TRUE(is_empty(cast(volume, parameters)));
    for (const LiveVolume* labels : {&beside, &broken, &no_number}) {
        give("labels", labels);
        expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "pre-integrated, no voxel of the id");
    }
    give("labels", nullptr);
    EXPECT_TRUE(is_empty(cast(volume, parameters)));
    parameters["labels"]["segments"] = {{{"id", 3}}, {{"id", 3}}};
    expect_refused(scene(parameters, front()), ErrorCode::scene, "/labels/segments/1/id");
}

TEST_F(VolumeLooks, SegmentsWithoutLabelsAndOverlaysThatAreNotHeededAreSaid) {
    const LiveVolume volume(block());
    json parameters = homogeneous();
    parameters["labels"]["segments"] = {{{"id", 3}, {"visible", false}}};
    give("host", &volume);
    expect_refused(scene(parameters, front()), ErrorCode::scene, "/labels");
    parameters["function"] = "mip";
    parameters["labels"]["host"] = "labels";  // which nobody gives
    EXPECT_TRUE(is_empty(cast(volume, parameters)));
    parameters.erase("labels");
    parameters["overlay"]["host"] = "overlay";  // it is not looked for
    json plain = homogeneous();
    plain["function"] = "mip";
    expect_same(cast(volume, parameters), cast(volume, plain), "an overlay takes no part");
    expect_said_once("volume.look", "'mip' shows");
}

TEST_F(VolumeLooks, OverlaysBesideConstantAndBroken) {
    const LiveVolume volume(block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    json parameters = homogeneous();
    parameters["overlay"]["host"] = "overlay";
    Volume far = ball_volume(4);
    far.grid.origin_mm += 1000.0;
    const LiveVolume beside(std::move(far));
    give("overlay", &beside);
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "beside the volume");
    for (const double value : {0.0, 1e30, -1e30, std::numeric_limits<double>::quiet_NaN()}) {
        const LiveVolume constant(constant_volume(glm::ivec3(3), glm::dvec3(3.0), value));
        give("overlay", &constant);
        (void)cast(volume, parameters);
    }
    const LiveVolume ball(ball_volume(4));
    give("overlay", &ball);
    for (const json& window : {json{{"width", 1e-300}, {"level", 50}}, json{{"width", 1e300}, {"level", 0}},
                               json{{"width", 1e-30}, {"level", 1e30}}}) {
        parameters["overlay"]["window"] = window;
        (void)cast(volume, parameters);
    }
    parameters["overlay"].erase("window");
    parameters["overlay"]["points"] = {knot(50, 0)};
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "no share of the strength");
    give("overlay", nullptr);
    EXPECT_TRUE(is_empty(cast(volume, parameters)));
}

TEST_F(VolumeLooks, EightPlanesThatLeaveNothing) {
    const LiveVolume volume(block());
    for (const char* function : functions) {
        json parameters = homogeneous();
        parameters["function"] = function;
        parameters["isosurface"]["values"] = {{{"value", 50}}};
        for (int i = 0; i < 8; ++i) {
            const double angle = 0.785398 * i;
            parameters["clip_planes"].push_back(
                {{"point_mm", {0.1 * std::cos(angle), 0.1 * std::sin(angle), 0}},
                 {"normal", {std::cos(angle), std::sin(angle), 0}}});
        }
        EXPECT_TRUE(is_empty(cast(volume, parameters))) << function;
    }
    json parameters = homogeneous();
    parameters["clip_planes"] = {{{"point_mm", {0, 0, 0}}, {"normal", {1, 0, 0}}},
                                 {{"point_mm", {0, 0, 0}}, {"normal", {-1, 0, 0}}}};
    EXPECT_LT(largest(cast(volume, parameters)), 1e-5F);
    parameters["clip_planes"] = {{{"point_mm", {0, 0, 0}}, {"normal", {1e-140, 0, 0}}}};
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "a half", {0.5, 0, 0});
    parameters["clip_planes"] = {{{"point_mm", {-4, 0, 0}}, {"normal", {1, 0, 0}}}};
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "in a face");
    parameters["clip_planes"] = {{{"point_mm", {1e300, 0, 0}}, {"normal", {-1, 0, 0}}}};
    expect_homogeneous(cast(volume, parameters), to_world, 3e-5, "far away");
    parameters["clip_planes"][0]["normal"] = {0, 0, 0};
    expect_refused(scene(parameters, front()), ErrorCode::scene, "/clip_planes/0/normal");
}

TEST_F(VolumeLooks, LightsInOddPlacesAndGradientsOfNothing) {
    const LiveVolume ball(ball_volume(8));
    json parameters = ramp();
    parameters["shading"] = {
        {"enabled", true},
        {"lights",
         {{{"position_mm", {0, 0, 0}}}, {{"position_mm", {1e30, 0, 0}}}, {{"direction", {1e-100, 0, 0}}}}}};
    for (const LiveVolume* volume : {&ball}) {
        (void)cast(*volume, parameters);
        (void)cast(*volume, parameters, camera({0, 0, 0}, {1, 0, 0}));
    }
    (void)cast(LiveVolume(block()), parameters);
    for (const json& gradient :
         {json{{{"gradient", 0}, {"factor", 0}}}, json{{{"gradient", 1e300}, {"factor", 1}}},
          json{{{"gradient", 0}, {"factor", 0}}, {{"gradient", 0}, {"factor", 1}}}}) {
        parameters["transfer_function"]["gradient"] = gradient;
        (void)cast(ball, parameters);
        (void)cast(LiveVolume(block()), parameters);
    }
}

}  // namespace
}  // namespace viscera::test
