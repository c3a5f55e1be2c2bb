#include <cmath>
#include <limits>

#include "tests/stress/volume_scene.h"

// Cameras and pictures of odd place, direction and size.
namespace viscera::test {
namespace {

using nlohmann::json;
using VolumeViews = VolumeStress;

constexpr double side_mm = 8.0;

Volume bright_block() {
    return constant_volume(glm::ivec3(4), glm::dvec3(side_mm / 4.0), 50.0);
}

TEST_F(VolumeViews, CamerasOnFacesInCornersInsideAndBeside) {
    const LiveVolume volume(bright_block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const json& eye : {json{0, 0, 0}, json{0, -4, 0}, json{-4, -4, 0}, json{-4, -4, -4}, json{4, 4, 4},
                            json{0.5, -1.5, 2}, json{2, 2, 2}, json{0, 0, 4}, json{1e-12, 0, -4}}) {
        for (const json& way :
             {json{1, 0, 0}, json{0, 1, 0}, json{0, -1, 0}, json{1, 1, 1}, json{0.3, 0.9, -0.2}}) {
            json target = eye;
            for (std::size_t a = 0; a < 3; ++a) {
                target[a] = eye[a].get<double>() + way[a].get<double>();
            }
            expect_homogeneous(cast(volume, homogeneous(), camera(eye, target)), to_world, 3e-5,
                               eye.dump() + " towards " + way.dump());
        }
    }
}

TEST_F(VolumeViews, InsideUnderEveryFunction) {
    const LiveVolume ball(ball_volume(8));
    for (const char* function :
         {"composite", "mip", "minip", "average", "xray", "isosurface", "accumulate", "density"}) {
        for (const json& eye : {json{0, 0, 0}, json{0, -5, 0}, json{5, 5, 5}, json{1, 2, 1}}) {
            json parameters = ramp();
            parameters["function"] = function;
            parameters["isosurface"]["values"] = {{{"value", 50}}};
            (void)cast(ball, parameters, camera(eye, {0.1, 0.2, 0.3}));
        }
    }
}

TEST_F(VolumeViews, RaysAlongTheFaces) {
    const LiveVolume volume(bright_block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    // Rays parallel to two pairs of faces, some of them in the faces between voxels. 16 rows over 16 mm: half
    // of the way between rows lies on the box's faces.
    for (const json& eye : {json{0, -20, 0}, json{20, 0, 0}, json{0, -20, 0.5}, json{-20, 0.5, 0.25}}) {
        const json target{0, eye[1] == 0.5 ? 0.5 : 0.0, eye[2]};
        for (const char* scheme : {"gauss", "cell"}) {
            json parameters = homogeneous();
            parameters["sampling"]["scheme"] = scheme;
            const Image image = cast(volume, parameters, orthographic(eye, target, 16.0));
            // A ray just in a face may belong to the box or not.
            for (int y = 0; y < image.height; ++y) {
                for (int x = 0; x < image.width; ++x) {
                    const float alpha = image.at(x, y, 3);
                    EXPECT_TRUE(alpha == 0.0F || std::abs(alpha - (1.0 - std::pow(0.9, side_mm))) < 2e-5)
                        << alpha << " at " << x << ", " << y;
                }
            }
            EXPECT_GT(image.at(10, 8, 3), 0.5F);
            EXPECT_EQ(image.at(0, 0, 3), 0.0F);
        }
    }
    // A perspective camera that looks along a face, from the plane of it.
    for (const json& eye : {json{4, -30, 0}, json{4, -30, 4}, json{0, -30, -4}}) {
        expect_homogeneous(cast(volume, homogeneous(), camera(eye, {eye[0], 0, eye[2]})), to_world, 3e-5,
                           eye.dump());
    }
}

TEST_F(VolumeViews, LookingAwayShowsNothing) {
    const LiveVolume volume(bright_block());
    for (const json& target : {json{0, -50, 0}, json{40, -25, 0}, json{0, -25, 40}}) {
        EXPECT_TRUE(is_empty(cast(volume, homogeneous(), camera({0, -25, 0}, target))));
    }
    EXPECT_TRUE(is_empty(cast(volume, homogeneous(), orthographic({100, -20, 0}, {100, 0, 0}, 8))));
}

TEST_F(VolumeViews, NearAndFarPlanesCut) {
    const LiveVolume volume(bright_block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const auto& [near, far] : {std::pair(25.0, 1000.0), std::pair(0.01, 25.0), std::pair(24.0, 24.001),
                                    std::pair(25.0, 25.0000001)}) {
        expect_homogeneous(cast(volume, homogeneous(), camera({3, -25, 4}, {0, 0, 0}, near, far)), to_world,
                           1e-4, std::to_string(near) + " to " + std::to_string(far));
    }
    const Image plain = cast(volume, homogeneous());
    for (const auto& [near, far] : {std::pair(1e-9, 1e12), std::pair(1e-6, 1e30)}) {
        expect_near(cast(volume, homogeneous(), camera({3, -25, 4}, {0, 0, 0}, near, far)), plain, 1e-5,
                    "no plane");
    }
    for (const auto& [near, far] : {std::pair(0.001, 5.0), std::pair(1e9, 1e10)}) {
        EXPECT_TRUE(is_empty(cast(volume, homogeneous(), camera({3, -25, 4}, {0, 0, 0}, near, far))));
    }
}

TEST_F(VolumeViews, EyesFarAway) {
    const LiveVolume volume(bright_block());
    const glm::dmat4 to_world = volume.volume().grid.texture_to_world();
    for (const double far : {1e3, 1e6, 1e8}) {
        json view = orthographic({0.1 * far, -far, 0.2 * far}, {0, 0, 0}, 14.0);
        view["near_mm"] = 0.5 * far;
        view["far_mm"] = 2.0 * far;
        expect_homogeneous(cast(volume, homogeneous(), view), to_world, 1e-4, std::to_string(far));
    }
    for (const double height : {1e-6, 1e6, 1e30}) {
        (void)cast(volume, homogeneous(), orthographic({0, -30, 0}, {0, 0, 0}, height));
    }
}

TEST_F(VolumeViews, TargetsOfAnyShape) {
    const LiveVolume volume(bright_block());
    for (const char* effect : {"analytic", "two_pass"}) {
        json parameters = homogeneous();
        parameters["sampling"]["limits"] = effect;
        json drawn = scene(parameters, front());
        if (std::string_view(effect) == "two_pass") {
            const json where{{"volume", {{"host", "host"}}}};
            drawn["passes"].insert(drawn["passes"].begin(),
                                   {{{"name", "entry"}, {"effect", "volume.entry"}, {"parameters", where}},
                                    {{"name", "exit"}, {"effect", "volume.exit"}, {"parameters", where}}});
        }
        give("host", &volume);
        load(drawn);
        for (const auto& [width, height] :
             {std::pair(1, 1), std::pair(1, 7), std::pair(301, 1), std::pair(3, 3), std::pair(37, 91),
              std::pair(4097, 1), std::pair(1, 4097)}) {
            Frame frame = volume_frame();
            frame.width = width;
            frame.height = height;
            frame.eyes[0] = make_view(renderer().scene().camera, frame.aspect(), 0.0);
            const Image image = picture(frame);
            EXPECT_EQ(image.width, width);
            EXPECT_EQ(image.height, height);
            EXPECT_GT(largest(image), 0.3F) << width << " x " << height;
        }
    }
}

TEST_F(VolumeViews, DrawnLimitsFromEverywhere) {
    const LiveVolume volume(bright_block());
    const json where{{"volume", {{"host", "host"}}}};
    for (const json& eye : {json{3, -25, 4}, json{0, 0, 0}, json{0.5, -3.9, 1}, json{0, -60, 0}}) {
        const Image analytic = cast(volume, homogeneous(), camera(eye, {1, 2, -1}));
        json parameters = homogeneous();
        parameters["sampling"]["limits"] = "two_pass";
        json drawn = scene(parameters, camera(eye, {1, 2, -1}));
        drawn["passes"].insert(drawn["passes"].begin(),
                               {{{"name", "entry"}, {"effect", "volume.entry"}, {"parameters", where}},
                                {{"name", "exit"}, {"effect", "volume.exit"}, {"parameters", where}}});
        load(drawn);
        expect_near(picture(), analytic, 1e-4, eye.dump());
    }
}

TEST_F(VolumeViews, ViewsOfTheHostThatMakeNoSense) {
    const LiveVolume volume(ball_volume(8));
    const Image sound = cast(volume, ramp());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double value : {0.0, nan, std::numeric_limits<double>::infinity(), 1e300}) {
        Frame frame = volume_frame();
        frame.eyes[0].projection = glm::dmat4(value);
        (void)picture(frame);
        frame = volume_frame();
        frame.eyes[0].view = glm::dmat4(value);
        frame.eyes[0].eye_mm = glm::dvec3(value);
        (void)picture(frame);
    }
    expect_same(picture(), sound, "and afterwards all is as before");
}

}  // namespace
}  // namespace viscera::test
