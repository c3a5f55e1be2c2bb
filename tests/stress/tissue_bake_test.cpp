#include <array>
#include <cmath>
#include <string>

#include "tests/stress/stage.h"

// Surfaces that no texture fits: bakes stay finite and say what they left out.
namespace viscera::test {
namespace {

using nlohmann::json;

class TissueBakes : public Stage {
  protected:
    /// Bakes an OBJ of this text; every target is finite.
    Pictures bake(const std::string& obj, const json& mesh = json::object(), int size = 32) {
        json parameters = {{"mesh", mesh}, {"size", size}};
        parameters["mesh"]["file"] =
            folder().write("mesh" + std::to_string(++number_) + ".obj", obj).string();
        load({{"version", 1},
              {"resolution", {16, 16}},
              {"passes", {{{"name", "bake"}, {"effect", "tissue.bake"}, {"parameters", parameters}}}},
              {"outputs", {"tissue.position", "tissue.normal", "tissue.metric", "tissue.seam"}}});
        return render(0.0);
    }
    /// Share of texels with this alpha.
    static double share(const Pictures& pictures, float alpha) {
        const Image& image = pictures.at("tissue.position");
        int count = 0;
        for (int i = 0; i < image.width * image.height; ++i) {
            count += image.at(i % image.width, i / image.width, 3) == alpha ? 1 : 0;
        }
        return static_cast<double>(count) / (image.width * image.height);
    }

  private:
    int number_ = 0;
};

// A square of two triangles: texture coordinates follow.
const std::string square = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\n";
const std::string faces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

TEST_F(TissueBakes, TexturesOfAnyOrientation) {
    const Pictures plain = bake(square + "vt .2 .2\nvt .8 .2\nvt .8 .8\nvt .2 .8\n" + faces);
    const Pictures mirrored = bake(square + "vt .8 .2\nvt .2 .2\nvt .2 .8\nvt .8 .8\n" + faces);
    EXPECT_NEAR(share(plain, 1.0F), 0.36, 0.05);
    EXPECT_EQ(share(plain, 1.0F), share(mirrored, 1.0F));
    EXPECT_NEAR(plain.at("tissue.position").at(16, 16, 0), mirrored.at("tissue.position").at(15, 16, 0),
                1e-5);
    EXPECT_EQ(renderer().log().faults().size(), 0U) << said();
    EXPECT_NE(said().find("2 of 2 triangles are mirrored in the texture"), std::string::npos) << said();
}

TEST_F(TissueBakes, ATriangleWithoutAreaInTheTexture) {
    // Its third corner lies on the line between the others.
    (void)bake(square + "vt .2 .2\nvt .8 .2\nvt .8 .8\nvt .5 .5\n" + faces, {{"atlas", "file"}});
    expect_said_once("tissue.flat", "1 triangles have no area in the texture");
}

TEST_F(TissueBakes, AllTrianglesOnOnePlace) {
    const std::string uv = "vt .2 .2\nvt .8 .2\nvt .8 .8\n";
    const std::string same = "f 1/1 2/2 3/3\nf 1/1 3/2 4/3\n";
    const Pictures kept = bake(square + uv + same, {{"atlas", "file"}});
    expect_said_once("tissue.overlap", "texels lie in more than one triangle");
    EXPECT_GT(share(kept, 1.0F), 0.1);
    // An atlas of its own has room for both.
    EXPECT_GT(share(bake(square + uv + same), 1.0F), 0.3);
}

TEST_F(TissueBakes, TextureCoordinatesFarOutside) {
    (void)bake(square + "vt -1e6 0\nvt 1e7 3\nvt 5 1e8\nvt -2 -3\n" + faces, {{"atlas", "file"}});
    expect_said_once("tissue.huge", "span more than 4 textures");
    (void)bake(square + "vt 1e30 0\nvt 1e38 1e38\nvt nan 1\nvt inf 0\n" + faces, {{"atlas", "file"}});
    // Two textures wide: repeats, which covers each texel several times.
    EXPECT_EQ(share(bake(square + "vt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\n" + faces, {{"atlas", "file"}}), 1.0F),
              1.0);
    // By itself it gets an atlas.
    (void)bake(square + "vt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\n" + faces);
    EXPECT_NE(said().find("an atlas of 1 charts was made"), std::string::npos) << said();
}

TEST_F(TissueBakes, MissingTextureCoordinatesAndNormals) {
    const Pictures pictures = bake(square + "f 1 2 3\nf 1 3 4\n");
    EXPECT_GT(share(pictures, 1.0F), 0.3);
    EXPECT_EQ(pictures.at("tissue.normal").at(16, 16, 2), 1.0F);
    EXPECT_NE(said().find("has no texture coordinates; an atlas"), std::string::npos) << said();
    EXPECT_NE(said().find("has no normals; they are made"), std::string::npos) << said();
}

TEST_F(TissueBakes, EdgesOfMoreThanTwoTriangles) {
    // Three fins about one edge.
    const std::string fins =
        "v 0 0 0\nv 0 10 0\nv 10 0 0\nv -5 0 8\nv -5 0 -8\n"
        "vt .1 .1\nvt .1 .3\nvt .3 .1\nvt .5 .1\nvt .5 .3\nvt .7 .1\nvt .1 .6\nvt .1 .8\nvt .3 .6\n"
        "f 1/1 2/2 3/3\nf 1/4 2/5 4/6\nf 1/7 2/8 5/9\n";
    (void)bake(fins);
    expect_said_once("tissue.non_manifold", "1 edges join more than two triangles");
}

TEST_F(TissueBakes, OrgansOfAnySize) {
    for (const double unit : {1e-3, 1e4, 1e-12, 1e12}) {
        const Pictures pictures =
            bake(square + "vt .2 .2\nvt .8 .2\nvt .8 .8\nvt .2 .8\n" + faces, {{"mm_per_unit", unit}});
        EXPECT_NEAR(share(pictures, 1.0F), 0.36, 0.05) << unit;
        const double texel = unit * 10.0 / (0.6 * 32.0);
        EXPECT_NEAR(pictures.at("tissue.metric").at(16, 16, 0) / texel, 1.0, 1e-4) << unit;
        EXPECT_NEAR(pictures.at("tissue.normal").at(16, 16, 2), 1.0, 1e-3) << unit;
    }
}

TEST_F(TissueBakes, AHostThatFoldsTheSurfaceToNothing) {
    (void)bake(square + "vt .2 .2\nvt .8 .2\nvt .8 .8\nvt .2 .8\n" + faces, {{"host_positions", "moved"}});
    HostValues values;
    Frame frame = renderer().still(0.0);
    frame.values = &values;
    const std::array<std::vector<float>, 4> shapes{
        std::vector<float>(12, 3.0F), std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0},
        std::vector<float>{1e30F, 0, 0, -1e30F, 0, 0, 0, 1e30F, 0, 0, 0, 1e30F},
        std::vector<float>(12, 1e-30F)};
    for (const std::vector<float>& shape : shapes) {
        values.set("moved", shape);
        const Pictures pictures = render(frame);
        EXPECT_NEAR(share(pictures, 1.0F), 0.36, 0.05) << "texels stand for what they stood for";
    }
    expect_said_once("tissue.collapsed", "2 triangles have no area where the host has moved them");
    EXPECT_EQ(renderer().log().faults().at("tissue.collapsed"), 6U) << "two for each shape but the third";
    values.set("moved", std::vector<float>(12, std::nanf("")));
    EXPECT_EQ(render(frame).at("tissue.position").at(16, 16, 3), 1.0F);
    expect_said_once("surface.host_position_not_finite", "not all finite");
}

TEST_F(TissueBakes, NothingToBake) {
    // Both triangles are degenerate, which the reader says.
    const Pictures pictures = bake("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 2\n");
    EXPECT_EQ(share(pictures, 0.0F), 1.0);
    EXPECT_EQ(pictures.at("tissue.seam").at(3, 3, 0), -1.0F);
    (void)bake(square + "f 1 2 3\n", {{"placement", {{"scale", {1, 0, 1}}}}});
    expect_said_once("tissue.singular", "placement is singular");
}

TEST_F(TissueBakes, ATextureThatIsNoSquare) {
    json scene = {{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.position"}}};
    const auto file = folder().write("wide.obj", square + "vt .2 .2\nvt .8 .2\nvt .8 .8\nvt .2 .8\n" + faces);
    scene["passes"] = {
        {{"name", "bake"}, {"effect", "tissue.bake"}, {"parameters", {{"mesh", {{"file", file.string()}}}}}}};
    scene["targets"]["tissue.position"]["size"] = {64, 32};
    EXPECT_EQ(share(render(scene, 0.0), 0.0F), 1.0);
    expect_said_once("tissue.no_square", "no squares");
}

}  // namespace
}  // namespace viscera::test
