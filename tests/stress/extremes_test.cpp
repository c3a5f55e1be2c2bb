#include <limits>

#include "engine/io/exr.h"
#include "tests/stress/stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;
using Extremes = Stage;

TEST_F(Extremes, ScalesOfTheMesh) {
    for (const double scale : {1e-300, 1e-30, 1e-6, 1e3, 1e6, 1e30, 1e300}) {
        json scene = chain();
        scene["passes"][0]["parameters"]["vessel"]["mm_per_unit"] = scale;
        (void)render(scene);
    }
    for (const double wrong : {0.0, -1.0}) {
        json scene = chain();
        scene["passes"][0]["parameters"]["vessel"]["mm_per_unit"] = wrong;
        EXPECT_THROW(load(scene), Error);
    }
}

TEST_F(Extremes, Times) {
    load(chain());
    for (const double time_s : {-1e9, -1.0, 0.0, 1e-300, 1e9, 1e15, 1e300}) {
        (void)render(time_s);
    }
    for (const double time_s :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW((void)renderer().still(time_s), Error);
        Frame frame = renderer().still(0.0);
        frame.time_s = time_s;
        (void)render(frame);
    }
    EXPECT_GT(largest(render(1.0).at("contrast.main")), 0.1F) << "and afterwards all is as before";
}

TEST_F(Extremes, FarFromTheOrigin) {
    const Image near = render(chain()).at("contrast.main");
    json scene = chain();
    scene["camera"]["eye_mm"] = {1e6, 1e6 - 60, 1e6 + 10};
    scene["camera"]["target_mm"] = {1e6, 1e6, 1e6 + 10};
    scene["passes"][0]["parameters"]["vessel"]["injection_mm"] = {1e6, 1e6, 1e6};
    EXPECT_EQ(largest(render(scene).at("final")), 0.75F) << "the vessel stayed at the origin";
    scene["camera"]["eye_mm"] = {0, -1e6, 10};
    scene["camera"]["far_mm"] = 2e6;
    scene["camera"]["target_mm"] = {0, 0, 10};
    (void)render(scene);
}

TEST_F(Extremes, ClippingPlanes) {
    for (const auto& [near, far] :
         {std::pair(1e-9, 1e12), std::pair(1e-300, 1e300), std::pair(59.0, 59.000001), std::pair(1e9, 1e10),
          std::pair(1e-12, 1e-11)}) {
        json scene = chain();
        scene["camera"]["near_mm"] = near;
        scene["camera"]["far_mm"] = far;
        (void)render(scene);
    }
    for (const auto& [near, far] : {std::pair(0.0, 1.0), std::pair(5.0, 5.0), std::pair(9.0, 1.0)}) {
        json scene = chain();
        scene["camera"]["near_mm"] = near;
        scene["camera"]["far_mm"] = far;
        EXPECT_THROW((void)render(scene), Error);
    }
}

TEST_F(Extremes, CamerasWithoutADirection) {
    json scene = chain();
    scene["camera"]["eye_mm"] = scene["camera"]["target_mm"];
    EXPECT_THROW((void)render(scene), Error);
    scene = chain();
    scene["camera"]["up"] = {0, 1, 0};
    EXPECT_THROW((void)render(scene), Error);
    scene["camera"]["up"] = {0, 0, 0};
    EXPECT_THROW((void)render(scene), Error);
    scene = chain();
    scene["camera"]["vertical_fov_deg"] = 179.0;
    (void)render(scene);
    scene["camera"]["vertical_fov_deg"] = 0.1;
    (void)render(scene);
    scene["camera"] = {
        {"kind", "c_arm"}, {"source_axis_distance_mm", 1e-6}, {"source_image_distance_mm", 1e9}};
    (void)render(scene);
}

TEST_F(Extremes, ViewsOfTheHostThatMakeNoSense) {
    load(chain());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double value : {0.0, nan, std::numeric_limits<double>::infinity(), 1e300}) {
        Frame frame = renderer().still(1.0);
        frame.eyes[0].projection = glm::dmat4(value);
        (void)render(frame);
        frame = renderer().still(1.0);
        frame.eyes[0].view = glm::dmat4(value);
        frame.eyes[0].eye_mm = glm::dvec3(value);
        (void)render(frame);
    }
}

TEST_F(Extremes, NoEmitterAndAThousand) {
    json scene = chain();
    json& emitters = scene["passes"][2]["parameters"]["emitters"];
    const json one = emitters[0];
    emitters = json::array();
    const Pictures none = render(scene);
    EXPECT_EQ(largest(none.at("contrast.reflux")), 0.0F);
    for (int i = 0; i < 1000; ++i) {
        json emitter = one;
        emitter["base_mm"] = {0.01 * i - 5, 0, 4 + 0.01 * i};
        emitters.push_back(emitter);
    }
    EXPECT_GT(largest(render(scene).at("contrast.reflux")), 0.1F);
}

TEST_F(Extremes, EmittersOfTheHost) {
    json scene = chain();
    scene["passes"][2]["parameters"]["host_emitters"] = "smoke";
    const Image own = render(scene).at("contrast.reflux");
    constexpr float big = std::numeric_limits<float>::max();
    constexpr float inf = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    HostValues host;
    const auto with = [&](const std::vector<float>& values) {
        host.set("smoke", values);
        Frame frame = renderer().still(1.0);
        frame.values = &host;
        return render(frame).at("contrast.reflux");
    };
    for (const std::vector<float>& values :
         {std::vector<float>{}, std::vector<float>{nan, 0, 4, 5, 0, 8, 5, 0, 9, 1},
          std::vector<float>{0, 0, 4, 5, 0, 8, 5, 0, 9, nan},
          std::vector<float>{0, 0, 4, inf, 0, 8, 5, 0, 9, 1}, std::vector<float>{1, 2, 3}}) {
        expect_same(with(values), own, "the scene's emitter is untouched");
    }
    expect_said_once("contrast.emitter_not_finite", "not finite");
    expect_said_once("contrast.host_emitters", "no multiple of 10");
    for (const float size : {-1.0F, 0.0F, 1e-30F, 1e30F, big}) {
        (void)with({0, 0, 4, 5, 0, 8, 5, 0, 9, size});
    }
    (void)with({big, big, big, -big, -big, -big, 0, 0, 0, 1});
    (void)with({0, 0, 4, 5, 0, 8, big, big, big, 1});
}

TEST_F(Extremes, Blurs) {
    for (const double sigma : {0.0, 1e-300, 1e-9, 0.001, 0.5}) {
        for (const double gain : {0.0, 1.0, 65504.0}) {
            json scene = chain();
            scene["passes"][3]["parameters"] = {{"sigma", sigma}, {"gain", gain}};
            const Pictures pictures = render(scene);
            if (gain == 0.0) {
                EXPECT_EQ(largest(pictures.at("contrast.capillary")), 0.0F);
            }
        }
    }
}

TEST_F(Extremes, TheLargestGainLeavesBlackBlackAndALargerOneIsRefused) {
    json scene = chain();
    scene["passes"][3]["parameters"] = {{"sigma", 0.0}, {"gain", 65504.0}};
    const Pictures pictures = render(scene);
    EXPECT_EQ(pictures.at("contrast.capillary").at(0, 0, 0), 0.0F);
    scene["passes"][3]["parameters"]["gain"] = 1e300;
    EXPECT_THROW(load(scene), Error);
}

TEST_F(Extremes, ParametersOfTheBolusAndTheCloud) {
    for (const json& bolus :
         {json{{"rise_s", 1e-300}}, json{{"rise_s", 1e300}}, json{{"washout_s", 1e-300}},
          json{{"washout_s", 1e300}}, json{{"duration_s", 0}}, json{{"duration_s", 1e300}},
          json{{"amplitude", 0}}, json{{"start_s", -1e300}}, json{{"start_s", 1e300}},
          json{{"table", {{{"time_s", 0}, {"density", 1}}}}},
          json{{"table", {{{"time_s", 0}, {"density", 1}}, {{"time_s", 0}, {"density", 0}}}}},
          json{{"table", {{{"time_s", -1e300}, {"density", 1}}, {{"time_s", 1e300}, {"density", 0}}}}}}) {
        json scene = chain();
        scene["passes"][0]["parameters"]["bolus"] = bolus;
        try {
            load(scene);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::scene) << bolus;
            continue;
        }
        for (const double time_s : {0.0, 0.5, 1.0, 3.0}) {
            (void)render(time_s);
        }
    }
    for (const double radius : {1e-300, 1e-30, 1e30, 1e300}) {
        json scene = chain();
        scene["passes"][0]["parameters"]["cloud"]["radius_mm"] = radius;
        (void)render(scene);
    }
}

TEST_F(Extremes, ASteepBolusIsStillFullOnItsPlateau) {
    json scene = chain();
    scene["passes"][0]["parameters"]["bolus"] = {
        {"duration_s", 5}, {"rise_s", 1e-300}, {"washout_s", 1e-300}};
    scene["passes"][0]["parameters"]["vessel"]["geodesic"]["speed_mm_s"] = 1e6;
    EXPECT_GT(largest(render(scene).at("contrast.main")), 0.99F);
}

TEST_F(Extremes, BackgroundsBeyondHalfFloat) {
    Image image = make_image(4, 1, PixelFormat::r32f);
    image.set(0, 0, 0, 1e30F);
    image.set(1, 0, 0, -1e30F);
    image.set(2, 0, 0, std::numeric_limits<float>::infinity());
    image.set(3, 0, 0, std::numeric_limits<float>::quiet_NaN());
    const io::ExrPart part{.name = "bright", .image = image};
    io::write_exr(folder() / "bright.exr", std::span(&part, 1));
    json scene = chain();
    scene["passes"].insert(
        scene["passes"].begin(),
        json{{"name", "background"}, {"effect", "picture.image"}, {"parameters", {{"file", "bright.exr"}}}});
    for (const double gain : {0.0, 1.0, 65504.0}) {
        scene["passes"][0]["parameters"]["gain"] = gain;
        for (const json& composite :
             {json{{"tone", "thesis"}}, json{{"darkest", 1e-300}}, json{{"darkest", 1}}}) {
            scene["passes"][5]["parameters"] = composite;
            (void)render(scene);
        }
    }
    expect_said_once("picture.not_finite", "not finite");
}

}  // namespace
}  // namespace viscera::test
