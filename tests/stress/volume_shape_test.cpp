#include <array>
#include <cmath>
#include <limits>

#include "tests/stress/volume_scene.h"

#include "tests/core/not_finite.h"

// Volumes of odd shape, size, place and content.
namespace viscera::test {
namespace {

using nlohmann::json;
using VolumeShapes = VolumeStress;

json with_function(json parameters, const char* function) {
    parameters["function"] = function;
    return parameters;
}

TEST_F(VolumeShapes, OneVoxelAndFlatOnesAreWholeBoxes) {
    for (const glm::ivec3 dims :
         {glm::ivec3(1), glm::ivec3(1, 5, 7), glm::ivec3(5, 1, 7), glm::ivec3(5, 7, 1), glm::ivec3(1, 1, 9),
          glm::ivec3(9, 1, 1), glm::ivec3(2), glm::ivec3(17, 1, 3)}) {
        const LiveVolume volume(constant_volume(dims, glm::dvec3(8.0) / glm::dvec3(dims), 50.0));
        for (const char* scheme : {"midpoint", "gauss", "preintegrated", "cell"}) {
            json parameters = homogeneous();
            parameters["sampling"]["scheme"] = scheme;
            expect_homogeneous(cast(volume, parameters), volume.volume().grid.texture_to_world(), 2e-5,
                               std::string(scheme) + " " + std::to_string(dims.x) + " " +
                                   std::to_string(dims.y) + " " + std::to_string(dims.z));
        }
    }
    EXPECT_TRUE(renderer().log().faults().empty()) << said();
}

TEST_F(VolumeShapes, OneVoxelUnderEveryFunctionAndFilter) {
    const LiveVolume volume(constant_volume(glm::ivec3(1), glm::dvec3(8.0), 100.0));
    const LiveVolume flat(
        make_volume({1, 3, 4}, {2.0, 2.0, 2.0}, [](const glm::ivec3& i) { return 40.0 * i.z; }));
    for (const auto& [function, filter] :
         {std::pair("composite", "catmull_rom"), std::pair("mip", "bspline"), std::pair("minip", "nearest"),
          std::pair("average", "linear_fp32"), std::pair("xray", "bspline"),
          std::pair("isosurface", "linear"), std::pair("isosurface", "bspline")}) {
        json parameters = with_function(ramp(), function);
        parameters["sampling"]["filter"] = filter;
        parameters["isosurface"]["values"] = {{{"value", 50}}};
        const Image image = cast(volume, parameters);
        if (std::string_view(function) == "isosurface") {
            EXPECT_TRUE(is_empty(image)) << filter << ": 50 lies nowhere";
        } else {
            EXPECT_GT(largest(image), 0.2F) << function << " " << filter;
        }
        (void)cast(flat, parameters);
    }
}

TEST_F(VolumeShapes, ConstantsOfAnyTypeAndSize) {
    const double most = 1e37;
    for (const auto& [type, stored] :
         {std::pair(ScalarType::u8, 0.0), std::pair(ScalarType::u8, 255.0), std::pair(ScalarType::i8, -128.0),
          std::pair(ScalarType::u16, 65535.0), std::pair(ScalarType::i16, -32768.0),
          std::pair(ScalarType::f32, 0.0), std::pair(ScalarType::f32, most),
          std::pair(ScalarType::f32, -most), std::pair(ScalarType::f32, 1e-30),
          std::pair(ScalarType::f32, 1e-40)}) {
        const LiveVolume volume(constant_volume(glm::ivec3(4), glm::dvec3(2.0), stored, type));
        const std::string what = std::string(to_string(type)) + " " + std::to_string(stored);
        for (const char* scheme : {"gauss", "preintegrated", "cell"}) {
            json parameters = homogeneous();
            parameters["sampling"]["scheme"] = scheme;
            expect_homogeneous(cast(volume, parameters), volume.volume().grid.texture_to_world(), 2e-5,
                               what + " " + scheme);
        }
        for (const char* function : {"mip", "minip", "average"}) {
            const Image image = cast(volume, with_function(homogeneous(), function));
            EXPECT_NEAR(image.at(10, 8, 2), 0.1, 1e-6) << what << " " << function;
            EXPECT_NEAR(image.at(10, 8, 3), 0.1, 1e-6) << what << " " << function;
        }
        for (const char* function : {"xray", "isosurface", "accumulate", "density"}) {
            json parameters = with_function(homogeneous(), function);
            parameters["isosurface"]["values"] = {{{"value", stored}}};
            (void)cast(volume, parameters);
        }
    }
}

TEST_F(VolumeShapes, RescalesOfAnySize) {
    for (const auto& [slope, intercept] :
         {std::pair(-1.0, 0.0), std::pair(1e-12, 0.0), std::pair(1e12, 0.0), std::pair(-1e-6, 1e6),
          std::pair(1.0, 1e9), std::pair(1e-300, 5.0), std::pair(1e300, 0.0), std::pair(1.0, -1e300)}) {
        Volume volume = ball_volume(8);
        volume.slope = slope;
        volume.intercept = intercept;
        const LiveVolume live(std::move(volume));
        const Image plain = cast(LiveVolume(ball_volume(8)), ramp());
        json parameters = ramp();
        const double low = intercept;
        const double high = slope * 100.0 + intercept;
        parameters["transfer_function"]["points"][0]["value"] = low;
        parameters["transfer_function"]["points"][1]["value"] = high;
        const Image image = cast(live, parameters);
        if (high != low && std::abs(intercept) < 1e4 * std::abs(slope * 100.0)) {
            expect_near(image, plain, 2e-3, "slope " + std::to_string(slope));
        }
        for (const char* function : {"mip", "xray", "isosurface"}) {
            parameters["isosurface"]["values"] = {{{"value", 0.5 * slope * 100.0 + intercept}}};
            (void)cast(live, with_function(parameters, function));
        }
    }
}

TEST_F(VolumeShapes, SpacingsOfOneToAThousand) {
    for (const glm::dvec3 spacing : {glm::dvec3(0.002, 2.0, 2.0), glm::dvec3(2.0, 0.002, 2.0),
                                     glm::dvec3(2.0, 2.0, 0.002), glm::dvec3(0.002, 0.002, 2.0)}) {
        const LiveVolume volume(constant_volume(glm::ivec3(4), spacing, 1.0));
        for (const char* scheme : {"gauss", "cell"}) {
            json parameters = homogeneous();
            parameters["sampling"]["scheme"] = scheme;
            expect_homogeneous(cast(volume, parameters), volume.volume().grid.texture_to_world(), 5e-5,
                               scheme);
            const json edge_on = orthographic({-20, 0, 0.0003}, {0, 0, 0.0003}, 10.0);
            expect_homogeneous(cast(volume, parameters, edge_on), volume.volume().grid.texture_to_world(),
                               5e-5, std::string("edge on ") + scheme);
        }
        for (const char* function : {"mip", "xray", "isosurface"}) {
            (void)cast(volume, with_function(ramp(), function));
        }
    }
}

TEST_F(VolumeShapes, TheSamePictureInMicrometresAndKilometres) {
    const auto scaled = [&](double scale, const char* scheme, bool shaded) {
        Volume volume = ball_volume(8);
        volume.grid.spacing_mm *= scale;
        volume.grid.origin_mm *= scale;
        json parameters = ramp();
        parameters["transfer_function"]["reference_length_mm"] = scale;
        parameters["sampling"]["scheme"] = scheme;
        parameters["shading"]["enabled"] = shaded;
        return cast(LiveVolume(std::move(volume)), parameters,
                    camera({3 * scale, -25 * scale, 4 * scale}, {0, 0, 0}, 0.01 * scale, 1000 * scale));
    };
    for (const char* scheme : {"gauss", "preintegrated", "cell"}) {
        const Image plain = scaled(1.0, scheme, true);
        EXPECT_GT(largest(plain), 0.5F);
        for (const double scale : {8e-7, 1e-6, 1e-3, 1e6, 8e5}) {
            expect_near(scaled(scale, scheme, true), plain, 1e-4,
                        std::string(scheme) + " times " + std::to_string(scale));
        }
        for (const double scale : {1e-30, 1e-20, 1e20, 1e30}) {
            (void)scaled(scale, scheme, false);
        }
    }
}

TEST_F(VolumeShapes, AKilometreFromTheOrigin) {
    const Image plain = cast(LiveVolume(ball_volume(8)), ramp());
    for (const glm::dvec3 far : {glm::dvec3(1e6, 0, 0), glm::dvec3(-1e6, 1e6, 1e6)}) {
        Volume volume = ball_volume(8);
        volume.grid.origin_mm += far;
        const LiveVolume live(std::move(volume));
        json parameters = ramp();
        const auto view = camera({far.x + 3, far.y - 25, far.z + 4}, {far.x, far.y, far.z});
        expect_near(cast(live, parameters, view), plain, 1e-5, "far away");
        parameters["clip_planes"] = {{{"point_mm", {far.x, far.y, far.z}}, {"normal", {1, 0.3, 0.2}}}};
        const Image cut = cast(live, parameters, view);
        json near = ramp();
        near["clip_planes"] = {{{"point_mm", {0, 0, 0}}, {"normal", {1, 0.3, 0.2}}}};
        expect_near(cut, cast(LiveVolume(ball_volume(8)), near), 1e-5, "cut far away");
    }
}

TEST_F(VolumeShapes, VoxelsThatAreNoNumbersAreEmpty) {
    constexpr double fill_value = -std::numeric_limits<float>::max();  // where a program has no value
    const auto broken = [=](const glm::ivec3& i) {
        const int n = i.x + 3 * i.y + 5 * i.z;
        return n % 11 == 0   ? nan
               : n % 13 == 0 ? infinity
               : n % 17 == 0 ? -infinity
               : n % 19 == 0 ? fill_value
                             : 10.0 * (n % 9);
    };
    const auto mended = [&](const glm::ivec3& i) { return is_number(broken(i)) ? broken(i) : 0.0; };
    const LiveVolume spoilt(make_volume(glm::ivec3(6), glm::dvec3(1.5), broken));
    const LiveVolume whole(make_volume(glm::ivec3(6), glm::dvec3(1.5), mended));
    for (const auto& [function, filter] :
         {std::pair("composite", "linear"), std::pair("composite", "bspline"), std::pair("mip", "linear"),
          std::pair("minip", "nearest"), std::pair("average", "linear"), std::pair("xray", "nearest"),
          std::pair("isosurface", "linear"), std::pair("accumulate", "linear"),
          std::pair("density", "linear")}) {
        json parameters = with_function(ramp(), function);
        parameters["sampling"]["filter"] = filter;
        parameters["isosurface"]["values"] = {{{"value", 33}}};
        expect_same(cast(spoilt, parameters), cast(whole, parameters), std::string(function) + " " + filter);
    }
    expect_said_once("volume.non_finite", "NaN, infinite or beyond");
}

TEST_F(VolumeShapes, NothingButNoNumbersIsAnEmptyVolume) {
    for (const double value : {nan, infinity, -infinity}) {
        const LiveVolume volume(constant_volume(glm::ivec3(4), glm::dvec3(2.0), value));
        EXPECT_TRUE(is_empty(cast(volume, ramp())));
        for (const char* function :
             {"mip", "minip", "average", "xray", "isosurface", "accumulate", "density"}) {
            json parameters = with_function(ramp(), function);
            parameters["isosurface"]["values"] = {{{"value", 33}}};
            (void)cast(volume, parameters);
        }
    }
}

TEST_F(VolumeShapes, NumbersOfAnySize) {
    constexpr double most = 1e36;
    const LiveVolume volume(make_volume(glm::ivec3(4), glm::dvec3(2.0), [&](const glm::ivec3& i) {
        return (i.x + i.y + i.z) % 2 == 0 ? most : -most;
    }));
    for (const char* filter :
         {"nearest", "linear", "linear_fp32", "bspline", "catmull_rom", "catmull_rom_fp32"}) {
        for (const char* function : {"composite", "mip", "average", "xray", "isosurface"}) {
            json parameters = with_function(ramp(), function);
            parameters["sampling"]["filter"] = filter;
            parameters["shading"]["enabled"] = true;
            (void)cast(volume, parameters);
        }
    }
}

TEST_F(VolumeShapes, AChannelThatIsNotThere) {
    const LiveVolume one(constant_volume(glm::ivec3(4), glm::dvec3(2.0), 7.0));
    json parameters = homogeneous();
    parameters["volume"]["channel"] = 3;
    give("host", &one);
    expect_refused(scene(parameters, front()), ErrorCode::scene, "channel");
}

}  // namespace
}  // namespace viscera::test
