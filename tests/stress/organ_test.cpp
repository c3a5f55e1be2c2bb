#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "engine/io/exr.h"
#include "engine/io/file_bytes.h"
#include "tests/core/not_finite.h"
#include "tests/stress/stage.h"

// Organs of odd shape, size and light: finite pictures, and a word where something is left out.
namespace viscera::test {
namespace {

using nlohmann::json;

class OrganStress : public Stage {
  protected:
    /// A square of cells x cells in the plane y = 0, `side` wide, as OBJ. `uv`: "u v" of a place in it.
    void write_square(double side, const std::function<std::string(double s, double t)>& uv, bool normals) {
        constexpr int cells = 4;
        std::ostringstream obj;
        obj.precision(9);
        for (int j = 0; j <= cells; ++j) {
            for (int i = 0; i <= cells; ++i) {
                const double s = static_cast<double>(i) / cells;
                const double t = static_cast<double>(j) / cells;
                obj << "v " << (s - 0.5) * side << ' ' << 0.02 * side * s * t << ' ' << (t - 0.5) * side
                    << '\n';
                obj << (normals ? "vn 0 -1 0\n" : "") << (uv ? "vt " + uv(s, t) + '\n' : std::string());
            }
        }
        const auto corner = [&](int i, int j) {
            const std::string n = std::to_string(j * (cells + 1) + i + 1);
            return " " + n + (uv ? "/" + n : normals ? "/" : "") + (normals ? "/" + n : "");
        };
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) {
                obj << 'f' << corner(i, j) << corner(i + 1, j) << corner(i + 1, j + 1) << "\nf"
                    << corner(i, j) << corner(i + 1, j + 1) << corner(i, j + 1) << '\n';
            }
        }
        (void)folder().write("organ.obj", obj.str());
    }
    std::string picture(const std::string& name, const std::function<float(int i, int c)>& f) {
        Image image = make_image(8, 8, PixelFormat::rgba32f);
        for (int i = 0; i < 64; ++i) {
            for (int c = 0; c < 4; ++c) {
                image.set(i % 8, i / 8, c, f(i, c));
            }
        }
        const io::ExrPart part{.name = "picture", .image = image};
        io::write_exr(folder() / name, std::span(&part, 1));
        return name;
    }
    /// Everything on one organ of a side, seen from one and a half sides away.
    json everything(double side = 20.0) {
        const auto rough = [](int i, int c) { return c == 2 ? 0.9F : 0.1F * static_cast<float>(i % 5 - 2); };
        const auto grey = [](int i, int) { return 0.3F + 0.01F * static_cast<float>(i); };
        json organ = {
            {"mesh", {{"file", "organ.obj"}}},
            {"diffuse_map", picture("diffuse.exr", grey)},
            {"normal_map", {{"map", picture("normal.exr", rough)}, {"encoding", "signed"}}},
            {"cut",
             {{"map", picture("cut.exr", [](int i, int c) { return c == 3 && i > 40 ? 1.0F : 0.2F; })}}},
            {"hint", {{"map", picture("hint.exr", grey)}, {"period_s", 0}}},
            {"hematoma",
             {{"spots", {{{"centre", {0, 0, 0}}, {"radius", 0.3 * side}}}}, {"host_spots", "spots"}}},
            {"lights", {{{"falloff_mm", 4 * side}}, {{"place", "world"}, {"position", {0, -side, side}}}}},
            {"focus", {{"near_mm", side}, {"focus_mm", 1.5 * side}, {"far_mm", 2.5 * side}}}};
        return {{"version", 1},
                {"resolution", {48, 40}},
                {"camera",
                 {{"eye_mm", {0, -1.5 * side, 0.1 * side}},
                  {"target_mm", {0, 0, 0}},
                  {"near_mm", 0.05 * side},
                  {"far_mm", 20 * side},
                  {"vertical_fov_deg", 45}}},
                {"passes",
                 {fill("tissue.energy",
                       picture("energy.exr", [](int i, int) { return 0.05F * static_cast<float>(i - 20); })),
                  fill("tissue.blood_color", picture("blood.exr", grey)),
                  fill("tissue.blood_normal", picture("blood_normal.exr", rough)),
                  {{"name", "organ"}, {"effect", "organ.surface"}, {"parameters", organ}},
                  {{"name", "membrane"},
                   {"effect", "organ.surface"},
                   {"parameters",
                    {{"mesh", {{"file", "organ.obj"}, {"placement", {{"move_mm", {0, -0.1 * side, 0}}}}}},
                     {"blending", "blended"},
                     {"opacity", 0.3},
                     {"into_picture", true},
                     {"shading", {{"shininess", 0}}}}}},
                  {{"name", "depth_of_field"}, {"effect", "organ.depth_of_field"}}}},
                {"outputs", {"final"}}};
    }
    static json fill(const std::string& target, const std::string& file) {
        return {{"name", "fill-" + target},
                {"effect", "picture.image"},
                {"parameters", {{"file", file}, {"fit", "stretch"}, {"monochrome", false}}},
                {"targets", {{"image", target}}}};
    }
    static json& organ_of(json& scene) { return scene["passes"][3]["parameters"]; }
    /// Pixels that show anything.
    static int covered(const Image& image) {
        int count = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                count += image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2) > 0.02F ? 1 : 0;
            }
        }
        return count;
    }
    /// A texture that a host lends in place of a target, one texel after the other.
    Image with_lent(const std::string& target, int width, int height, std::span<const float> texels) {
        GLuint texture = 0;
        gl().GenTextures(1, &texture);
        gl().BindTexture(GL_TEXTURE_2D, texture);
        gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, texels.data());
        const std::array<ImportedTexture, 1> imported{ImportedTexture{.target = target,
                                                                      .texture = texture,
                                                                      .format = PixelFormat::rgba32f,
                                                                      .width = width,
                                                                      .height = height}};
        Frame frame = renderer().still(0.0);
        frame.imported = imported;
        Pictures pictures = render(frame);
        gl().DeleteTextures(1, &texture);
        return pictures.contains("final") ? pictures.at("final") : pictures.at("organ.color");
    }
    static std::string straight(double s, double t) { return std::to_string(s) + ' ' + std::to_string(t); }
};

TEST_F(OrganStress, MeshesWithoutNormalsOrCoordinatesAreDrawn) {
    for (const bool normals : {true, false}) {
        for (const bool coordinates : {true, false}) {
            write_square(20.0, coordinates ? straight : std::function<std::string(double, double)>(),
                         normals);
            json scene = everything();
            // Meshes are shared by name: another name, another mesh.
            const std::string name = std::string(normals ? "n" : "x") + (coordinates ? "u" : "x") + ".obj";
            std::filesystem::rename(folder() / "organ.obj", folder() / name);
            organ_of(scene)["mesh"]["file"] = name;
            scene["passes"][4]["parameters"]["mesh"]["file"] = name;
            EXPECT_GT(covered(render(scene).at("organ.color")), 800) << name;
        }
    }
}

TEST_F(OrganStress, CoordinatesThatAreMirroredFlatAtOnePointOrHuge) {
    const std::array<std::function<std::string(double, double)>, 5> ways{
        [](double s, double t) { return straight(1.0 - s, t); },
        [](double s, double) { return straight(s, 0.5); },
        [](double, double) { return std::string("0.25 0.75"); },
        [](double s, double t) { return straight(1e6 * s, 1e6 * t); },
        [](double s, double t) { return straight(s > 0.5 ? 1.0 - s : s, t); }};  // overlapping
    for (std::size_t i = 0; i < ways.size(); ++i) {
        write_square(20.0, ways[i], true);
        const std::string name = std::to_string(i) + ".obj";
        std::filesystem::rename(folder() / "organ.obj", folder() / name);
        json scene = everything();
        organ_of(scene)["mesh"] = {{"file", name}, {"atlas", "file"}};
        scene["passes"][4]["parameters"]["mesh"]["file"] = name;
        EXPECT_GT(covered(render(scene).at("organ.color")), 800) << name;
    }
}

TEST_F(OrganStress, TrianglesOfNoAreaAndNothingElse) {
    (void)folder().write("organ.obj",
                         "v 0 0 0\nv 1 0 0\nv 2 0 0\nv -9 0 -9\nv 9 0 -9\nv 0 0 9\nvt 0 0\nvt 1 0\nvt 1 1\n"
                         "f 1/1 2/2 3/3\nf 1/1 1/1 2/2\nf 4/1 5/1 6/1\nf 4/1 5/2 6/3\n");
    EXPECT_GT(covered(render(everything()).at("organ.color")), 100);
    (void)folder().write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n");
    json scene = everything();
    organ_of(scene)["mesh"]["file"] = "flat.obj";
    EXPECT_LT(covered(render(scene).at("organ.color")), 800) << "the membrane alone";
}

TEST_F(OrganStress, TrianglesThatGoRoundTheOtherWayAreSaid) {
    write_square(20.0, straight, true);
    EXPECT_GT(covered(render(everything()).at("organ.color")), 800);
    EXPECT_FALSE(renderer().log().faults().contains("organ.winding"));
    std::string text = io::read_file(folder() / "organ.obj", 1 << 20);
    for (std::size_t at = text.find("vn 0 -1 0"); at != std::string::npos; at = text.find("vn 0 -1 0", at)) {
        text.replace(at, 9, "vn 0 1 0");
    }
    (void)folder().write("inside.obj", text);
    json scene = everything();
    organ_of(scene)["mesh"]["file"] = "inside.obj";
    (void)render(scene);
    expect_said_once("organ.winding", "32 of 32 triangles go round clockwise");
}

TEST_F(OrganStress, LightsOnTheSurfaceInTheEyeAndFarAway) {
    write_square(20.0, straight, true);
    json scene = everything();
    json& lights = organ_of(scene)["lights"];
    for (const json& position :
         {json{0, 0, 0}, json{0, -30, 2}, json{1e30, 0, 0}, json{0, -1e7, 0}, json{0, -1e-30, 0}}) {
        for (const double shininess : {0.0, 1.0, 2000.0}) {
            for (const double falloff : {0.0, 1e-6, 1e12}) {
                lights = {{{"place", "world"},
                           {"position", position},
                           {"falloff_mm", falloff},
                           {"angular", 0},
                           {"glow_mm", 5}},
                          {{"position", {0, 0, 0}}, {"angular", 1000}},
                          {{"place", "infinity"},
                           {"position", position == json{0, 0, 0} ? json{0, 1e-300, 0} : position}}};
                organ_of(scene)["shading"]["shininess"] = shininess;
                (void)render(scene);
            }
        }
    }
    expect_said_once("organ.light_far", "count as at infinity");
    lights = {{{"place", "infinity"}, {"position", {0, 0, 0}}}};
    EXPECT_THROW(load(scene), Error);
    lights = json::array();
    for (int i = 0; i < 9; ++i) {
        lights.push_back({{"place", "camera"}});
    }
    EXPECT_THROW(load(scene), Error) << "nine lights";
    lights = {{{"place", "camera"}}};
    organ_of(scene)["focus"]["near_mm"] = organ_of(scene)["focus"]["focus_mm"];
    EXPECT_THROW(load(scene), Error) << "planes that do not rise";
    organ_of(scene).erase("focus");
    lights = json::array();
    scene["passes"].erase(4);
    EXPECT_EQ(render(scene).at("organ.color").at(24, 20, 0), 0.0F);
}

TEST_F(OrganStress, OrgansOfAnySizeLookAlike) {
    Image first;
    for (const double side : {20.0, 1e-3, 2e-2, 1e4, 2e4}) {
        write_square(side, straight, true);
        const std::string name = std::to_string(side) + ".obj";
        std::filesystem::rename(folder() / "organ.obj", folder() / name);
        json scene = everything(side);
        organ_of(scene)["mesh"]["file"] = name;
        organ_of(scene)["lights"] = {
            {{"place", "world"}, {"position", {0, -side, 0}}, {"falloff_mm", 4 * side}}};
        scene["passes"].erase(4);
        const Image image = render(scene).at("organ.color");
        if (first.empty()) {
            first = image;
        }
        float worst = 0.0F;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                for (int c = 0; c < 4; ++c) {
                    worst = std::max(worst, std::abs(image.at(x, y, c) - first.at(x, y, c)));
                }
            }
        }
        EXPECT_LE(worst, 4e-3F) << side;
    }
}

TEST_F(OrganStress, HostsThatSendNonsenseAreHeardOnce) {
    write_square(20.0, straight, true);
    json scene = everything();
    organ_of(scene)["cut"]["vertex_scalar"] = "cut";
    load(scene);
    HostValues values;
    Frame frame = renderer().still(0.0);
    frame.values = &values;
    values.set("spots", std::array{nan_float, 0.0F, 0.0F, 5.0F, 0.0F, 0.0F, 0.0F, -1.0F, 1e30F, 1e30F, 1e30F,
                                   1e-30F, 7.0F});
    values.set("cut", std::array{1.0F, nan_float});
    (void)render(frame);
    expect_said_once("organ.spot", "not finite or have no radius");
    expect_said_once("organ.host_spots", "4 floats for each spot");
    expect_said_once("organ.cut_count", "2 entries for 25 vertices");
    values.set("cut", std::vector<float>(25, nan_float));
    values.set("spots", std::vector<float>(4 * 61000, 1.0F));
    (void)render(frame);
    expect_said_once("organ.spots", "more than 60000");
    expect_said_once("organ.cut_value", "there is no cut there");
}

TEST_F(OrganStress, TargetsThatAreNoNumbersReachNoPicture) {
    write_square(20.0, straight, true);
    constexpr auto inf = static_cast<float>(infinity);
    const std::array<float, 16> texels{nan_float, inf,       -inf, nan_float, 1e38F, -1e38F, 1e38F, 1e38F,
                                       0.5F,      nan_float, 0.5F, 1.0F,      -7.0F, inf,    1e20F, -inf};
    // Pictures come in clean, so a host's texture brings them.
    for (const std::string target :
         {"tissue.energy", "tissue.blood_color", "tissue.blood_normal", "tissue.blood_height",
          "painted.diffuse", "painted.cut", "painted.hint"}) {
        json scene = everything();
        for (std::size_t i = 3; i-- > 0;) {
            if (scene["passes"][i]["targets"]["image"] == target ||
                (target == "tissue.blood_height" && i == 2)) {
                scene["passes"].erase(i);
            }
        }
        for (json& pass : scene["passes"]) {
            if (pass["effect"] != "organ.surface") {
                continue;
            }
            for (const char* port : {"diffuse", "cut", "hint"}) {
                if (target == std::string("painted.") + port) {
                    pass["targets"][port] = target;
                    pass["parameters"].erase(std::string(port) == "diffuse" ? "diffuse_map" : port);
                }
            }
            if (target == "painted.hint") {
                pass["parameters"]["hint"]["period_s"] = 0;
            }
        }
        const std::array<ImportedTarget, 1> lent{
            ImportedTarget{.name = target, .format = PixelFormat::rgba32f, .width = 2, .height = 2}};
        renderer().set_scene(parse_scene(scene.dump(), folder() / "scene.json"), lent);
        (void)with_lent(target, 2, 2, texels);  // every value is finite
    }
}

TEST_F(OrganStress, APictureThatIsNoNumberIsBlurredWithoutIt) {
    const json scene{{"version", 1},
                     {"resolution", {8, 8}},
                     {"passes",
                      {{{"name", "depth_of_field"},
                        {"effect", "organ.depth_of_field"},
                        {"parameters", {{"radius", 0.25}}}}}},
                     {"targets", {{"final", {{"format", "rgba32f"}}}}},
                     {"outputs", {"final"}}};
    std::array<float, 256> texels{};
    for (std::size_t i = 0; i < texels.size(); ++i) {
        // Stripes of 0 and 1, blurred all over.
        texels[i] = i % 4 == 3 ? 1.0F : static_cast<float>(i / 4 % 2);
    }
    texels[20] = texels[60] = nan_float;
    texels[97] = static_cast<float>(infinity);
    texels[131] = nan_float;
    texels[179] = -7.0F;
    const std::array<ImportedTarget, 1> lent{
        ImportedTarget{.name = "organ.color", .format = PixelFormat::rgba32f, .width = 8, .height = 8}};
    renderer().set_scene(parse_scene(scene.dump(), folder() / "scene.json"), lent);
    const Image image = with_lent("organ.color", 8, 8, texels);
    // Pixels beside one that is no number are blurred as all others are.
    constexpr std::array<int, 5> changed{5, 15, 24, 32, 44};
    for (int i = 0; i < 64; ++i) {
        if (std::ranges::find(changed, i) == changed.end()) {
            EXPECT_NEAR(image.at(i % 8, i / 8, 0), 0.5F, 0.3F) << i;
        }
    }
}

TEST_F(OrganStress, PaintOfAnotherMeshIsSaid) {
    write_square(20.0, straight, true);
    json scene = everything();
    std::filesystem::copy_file(folder() / "organ.obj", folder() / "same.obj");
    for (const char* file : {"same.obj", "other.obj"}) {
        if (std::string_view(file) == "other.obj") {
            write_square(25.0, straight, true);
            std::filesystem::rename(folder() / "organ.obj", folder() / file);
            std::filesystem::copy_file(folder() / "same.obj", folder() / "organ.obj");
        }
        const json mesh{{"file", file}};
        scene["passes"][0] = {
            {"name", "bake"}, {"effect", "tissue.bake"}, {"parameters", {{"mesh", mesh}, {"size", 32}}}};
        scene["passes"][1] = {
            {"name", "coagulate"},
            {"effect", "tissue.coagulate"},
            {"parameters", {{"mesh", mesh}, {"size", 32}, {"contacts", {{{"from_mm", {0, 0, 0}}}}}}}};
        load(scene);
        (void)render(0.0);
        (void)render(0.1);
        EXPECT_EQ(renderer().log().faults().contains("organ.other_mesh"),
                  std::string_view(file) == "other.obj")
            << said();
    }
    expect_said_once("organ.other_mesh", "was painted on another mesh");
}

TEST_F(OrganStress, MapsThatPointInwardsOrNowhereAreFlat) {
    write_square(20.0, straight, true);
    json scene = everything();
    (void)picture("bad.exr", [](int i, int c) { return i % 2 == 0 ? 0.0F : c == 2 ? -0.5F : 0.3F; });
    organ_of(scene)["normal_map"]["map"] = "bad.exr";
    const Image bad = render(scene).at("organ.color");
    expect_said_once("organ.normal_map", "do not point outwards");
    (void)picture("up.exr", [](int, int c) { return c == 2 ? 1.0F : 0.0F; });
    organ_of(scene)["normal_map"]["map"] = "up.exr";
    expect_same(bad, render(scene).at("organ.color"), "flat");
}

}  // namespace
}  // namespace viscera::test
