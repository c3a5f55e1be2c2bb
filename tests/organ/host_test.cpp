#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "effects/organ/pictures.h"
#include "engine/core/eyes.h"
#include "engine/io/mesh.h"
#include "tests/io/sample_files.h"
#include "tests/organ/organ_stage.h"

// What a host brings to an organ: matrices, two eyes, moved vertices, scalars, maps of other depths.
namespace viscera::test {
namespace {

using nlohmann::json;

class OrganHost : public testing::Test {
  protected:
    Image through(const View& view, const HostValues* values = nullptr) {
        Frame frame = s.stage().renderer().still(0.0);
        frame.eyes[0] = view;
        frame.values = values;
        s.stage().renderer().render(frame);
        return s.stage().renderer().read("organ.color");
    }
    static float largest_difference(const Image& a, const Image& b) {
        const std::vector<float> first = to_floats(a);
        const std::vector<float> second = to_floats(b);
        float worst = 0.0F;
        for (std::size_t i = 0; i < first.size(); ++i) {
            worst = std::max(worst, std::abs(first[i] - second[i]));
        }
        return worst;
    }

    OrganStage s{64, 64};
};

TEST_F(OrganHost, PicturesUpsideDownAreTheSamePicture) {
    for (const char* faces : {"both", "front"}) {
        s.parameters["faces"] = faces;
        const Image upright = s.render();
        const View own = s.stage().renderer().still(0.0).eye();
        glm::dmat4 projection = own.projection;
        for (int column = 0; column < 4; ++column) {
            projection[column][1] *= -1.0;
        }
        const Image turned = through(view_of(own.view, projection));
        float worst = 0.0F;
        for (int y = 0; y < upright.height; ++y) {
            for (int x = 0; x < upright.width; ++x) {
                for (int c = 0; c < 4; ++c) {
                    worst = std::max(worst,
                                     std::abs(upright.at(x, y, c) - turned.at(x, upright.height - 1 - y, c)));
                }
            }
        }
        EXPECT_LE(worst, 1e-5F) << faces;
        EXPECT_NE(upright.data, turned.data);
    }
}

TEST_F(OrganHost, TheCamerasLightIsOneForBothEyes) {
    s.camera["stereo"] = {{"interpupillary_mm", 24.0}};
    json scene = s.scene();
    const auto pictures = [&] {
        s.stage().load(scene);
        s.stage().render(0.0);
        return std::array{s.stage().renderer().read("organ.color.left"),
                          s.stage().renderer().read("organ.color.right")};
    };
    const auto at_camera = pictures();
    // The same lamp, as a lamp in the world.
    const View middle = make_view(s.stage().renderer().scene().camera, 1.0);
    json& light = scene["passes"].back()["parameters"]["lights"][0];
    const glm::dvec3 place(glm::inverse(middle.view) *
                           glm::dvec4(light["position"][0], light["position"][1], light["position"][2], 1.0));
    light["place"] = "world";
    light["position"] = {place.x, place.y, place.z};
    const auto in_world = pictures();
    for (std::size_t eye = 0; eye < 2; ++eye) {
        EXPECT_LE(largest_difference(at_camera[eye], in_world[eye]), 1e-5F) << eye;
    }
    EXPECT_GT(largest_difference(at_camera[0], at_camera[1]), 1e-2F);
}

TEST_F(OrganHost, MovedVerticesAreDrawnWhereTheyAre) {
    Log log;
    const MeshData mesh =
        io::merge(io::load_meshes(s.parameters["mesh"]["file"].get<std::string>(), {}, log));
    std::vector<float> moved;
    for (const glm::vec3& p : mesh.positions) {
        moved.insert(moved.end(), {p.x + 7.0F, p.y - 5.0F, p.z - 4.0F});
    }
    for (const char* blending : {"opaque", "blended"}) {
        s.parameters["blending"] = blending;
        s.parameters["opacity"] = 0.6;
        s.parameters["mesh"].erase("host_positions");
        s.parameters["mesh"]["placement"] = {{"move_mm", {7, -5, -4}}};
        const Image wanted = s.render();
        s.parameters["mesh"].erase("placement");
        s.parameters["mesh"]["host_positions"] = "organ.positions";
        const Image still = s.render();
        HostValues values;
        values.set("organ.positions", moved);
        const Image image = through(s.stage().renderer().still(0.0).eye(), &values);
        EXPECT_LE(largest_difference(image, wanted), 2e-5F) << blending;
        EXPECT_GT(largest_difference(image, still), 0.05F) << blending;
    }
}

TEST_F(OrganHost, CutsFollowAScalarOfTheMesh) {
    const auto red = [](double, double, int c) { return c == 0 ? 0.9F : c == 3 ? 1.0F : 0.0F; };
    const std::string map = s.picture_file("cut.exr", 8, red);
    s.camera["eye_mm"] = {3, 2, 2.5};
    s.camera["target_mm"] = {0.3, 0.3, 0.3};
    s.camera["near_mm"] = 0.1;
    s.parameters["lights"] = {{{"place", "camera"}, {"position", {0, 0, 0}}, {"angular", 0}}};
    s.parameters["shading"]["specular"] = 0;
    s.parameters["mesh"] = {{"file", s.folder.write("tetra.glb", tetra_glb()).string()}};
    const Image whole = s.render();
    s.parameters["cut"] = {{"map", map}, {"vertex_scalar", "_DENSITY"}};  // above 0 everywhere
    const Image cut = s.render();
    EXPECT_GT(whole.at(32, 32, 1), 0.01F);
    EXPECT_GT(cut.at(32, 32, 0), 1.5F * whole.at(32, 32, 0));
    EXPECT_EQ(cut.at(32, 32, 1), 0.0F) << "red all over";
    s.parameters["cut"]["vertex_scalar"] = "_NONE";
    EXPECT_EQ(s.render().data, whole.data);
    EXPECT_EQ(s.stage().renderer().log().faults().count("organ.cut_scalar"), 1U);
}

TEST_F(OrganHost, MapsOf16BitsSayZeroLikeThoseOf8) {
    Log log;
    for (const bool sixteen : {true, false}) {
        Image map = make_image(2, 1, sixteen ? PixelFormat::rgba32f : PixelFormat::rgba8);
        const float zero = sixteen ? 32768.0F / 65535.0F : 128.0F / 255.0F;
        for (int c = 0; c < 2; ++c) {
            map.set(0, 0, c, zero);
            map.set(1, 0, c, c == 0 ? 1.0F : zero);
        }
        map.set(0, 0, 2, 1.0F);
        map.set(1, 0, 2, 1.0F);
        const Image slopes = organ::slopes_of(map, {}, log, "normals.png");
        EXPECT_EQ(slopes.at(0, 0, 0), 0.0F);
        EXPECT_EQ(slopes.at(0, 0, 1), 0.0F);
        EXPECT_EQ(slopes.at(1, 0, 0), -1.0F);
        EXPECT_EQ(slopes.at(1, 0, 1), 0.0F);
    }
    EXPECT_TRUE(log.faults().empty());
}

}  // namespace
}  // namespace viscera::test
