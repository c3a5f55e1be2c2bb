#include <algorithm>
#include <array>
#include <regex>

#include "engine/io/exr.h"
#include "engine/io/png.h"
#include "tests/app/app_test.h"

namespace viscera::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using Command = AppTest;

TEST_F(Command, WrongCommandLinesAreUsageErrors) {
    const std::vector<std::vector<std::string>> wrong{{},
                                                      {"nonsense"},
                                                      {"render"},
                                                      {"check"},
                                                      {"diff", "a.exr"},
                                                      {"info"},
                                                      {"render", path("scene.json"), "--nonsense"},
                                                      {"render", path("scene.json"), "--time"},
                                                      {"render", path("scene.json"), "--time", "soon"},
                                                      {"diff", "a", "b", "--max", "-1"},
                                                      {"diff", "a", "b", "--max", "nan"},
                                                      {"diff", "a", "b", "--fraction", "2"},
                                                      {"render", path("scene.json"), "--dump", ""},
                                                      {"render", path("scene.json"), "--glsl", path("no")},
                                                      {"render", path("scene.json"), "--time", "nan"},
                                                      {"render", path("scene.json"), "--png", "no.such"},
                                                      {"bench", "--set", "/camera/kind=c_arm", "cached"},
                                                      {"backends", "extra"}};
    for (const auto& arguments : wrong) {
        const Ended ended = viscera(arguments);
        EXPECT_EQ(ended.code, 2) << testing::PrintToString(arguments) << ended.err;
        EXPECT_FALSE(ended.err.empty());
    }
}

TEST_F(Command, AWordThatIsNoCommandIsNamed) {
    EXPECT_THAT(viscera({"rendr", path("scene.json")}).err,
                HasSubstr("rendr: is no command; did you mean 'render'?"));
    EXPECT_THAT(viscera({"frobnicate"}).err, HasSubstr("frobnicate: is no command"));
}

TEST_F(Command, HelpAndVersionAreNoErrors) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--help"}, {"render", "--help"}, {"diff", "--help"}, {"--version"}}) {
        const Ended ended = viscera(arguments);
        expect_fine(ended);
        EXPECT_FALSE(ended.out.empty());
        EXPECT_EQ(ended.err, "");
    }
    EXPECT_THAT(viscera({"render", "--help"}).out, HasSubstr("--output TEXT=out")) << "defaults are told";
}

TEST_F(Command, CheckPrintsThePlanWithReasons) {
    const Ended ended = viscera({"check", path("scene.json")});
    expect_fine(ended);
    EXPECT_THAT(ended.out, HasSubstr("2 of 3 passes live"));
    EXPECT_THAT(ended.out, testing::ContainsRegex("vessels +contrast.main +yes +read by 'composite'"));
    EXPECT_THAT(ended.out, testing::ContainsRegex("unused +picture.image +no +culled"));
    EXPECT_THAT(ended.out, HasSubstr("48x32"));
    EXPECT_THAT(viscera({"check", path("scene.json"), "--resolution", "9x7"}).out, HasSubstr("9x7"));
}

/// Graphviz's grammar as far as the plan needs it: one statement a line, every edge between declared nodes.
void expect_digraph(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "digraph plan {");
    const std::string attributes =
        R"re((\[[a-z]+=("([^"\\]|\\.)*"|[a-z0-9]+)(, [a-z]+=("([^"\\]|\\.)*"|[a-z0-9]+))*\])re";
    const std::regex node("  ([pc][0-9]+) " + attributes + ");");
    const std::regex edge("  ([pc][0-9]+) -> ([pc][0-9]+)( " + attributes + "))?;");
    std::set<std::string> nodes;
    std::size_t edges = 0;
    bool closed = false;
    while (std::getline(lines, line)) {
        std::smatch match;
        EXPECT_FALSE(closed) << line;
        if (line == "}") {
            closed = true;
        } else if (std::regex_match(line, match, node)) {
            EXPECT_TRUE(nodes.insert(match[1]).second) << line;
        } else if (std::regex_match(line, match, edge)) {
            EXPECT_TRUE(nodes.contains(match[1]) && nodes.contains(match[2])) << line;
            ++edges;
        } else {
            EXPECT_EQ(line, "  rankdir=LR;");
        }
    }
    EXPECT_TRUE(closed);
    EXPECT_GT(edges, 0U);
}

TEST_F(Command, CheckDrawsAGraph) {
    const Ended ended = viscera({"check", path("scene.json"), "--dot"});
    expect_fine(ended);
    expect_digraph(ended.out);
    EXPECT_THAT(ended.out, HasSubstr("unused (picture.image): culled"));
}

TEST_F(Command, CheckReadsEveryShippedScene) {
    int scenes = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(VISCERA_SOURCE_DIR) / "assets/scenes")) {
        const Ended ended = viscera({"check", entry.path().string(), "--dot"});
        expect_fine(ended);
        expect_digraph(ended.out);
        ++scenes;
    }
    EXPECT_GT(scenes, 0);
}

TEST_F(Command, CheckRefusesWhatRenderWould) {
    expect_refused(viscera({"check", path("none.json")}), 4, "none.json");
    scene_["outputs"] = {"nothing"};
    write_scene(scene_);
    expect_refused(viscera({"check", path("scene.json")}), 3, "nothing");
}

TEST_F(Command, BackendsListsEveryWayWithoutADisplay) {
    const Ended ended = viscera({"backends"});
    expect_fine(ended);
    for (const char* name : {"egl-device", "egl-surfaceless", "osmesa", "glfw: refused: "}) {
        EXPECT_THAT(ended.out, HasSubstr(name));
    }
    std::istringstream lines(ended.out);
    for (std::string line; std::getline(lines, line);) {
        if (line.find("llvmpipe") != std::string::npos) {
            EXPECT_THAT(line, HasSubstr(", software"));
        }
    }
}

TEST_F(Command, ViewWithoutADisplayIsRefused) {
    expect_refused(viscera({"view", path("scene.json")}), 5, "isplay");
}

TEST_F(Command, ViewShowsFramesWhereThereIsADisplay) {
    const Ended ended = run({"xvfb-run", "-a", VISCERA_APP, "view", path("scene.json"), "--frames", "3"});
    if (ended.code == 127) {
        GTEST_SKIP() << "xvfb-run is not installed";
    }
    expect_fine(ended);
    // xvfb-run sends both streams to stdout.
    EXPECT_THAT(ended.out + ended.err, HasSubstr("renders with glfw: "));
}

TEST_F(Command, BenchNamesItsCasesAndKnowsNoOthers) {
    const Ended listed = viscera({"bench", "--list"});
    expect_fine(listed);
    EXPECT_GT(std::ranges::count(listed.out, '\n'), 3);
    expect_refused(viscera({"bench", "nonsense", "--backend", "osmesa"}), 2, "nonsense");
    expect_refused(viscera({"bench", "--backend", "glfw"}), 5, "isplay");
}

class Diff : public AppTest {
  protected:
    std::string picture(const std::string& name, float value, int width = 4,
                        PixelFormat format = PixelFormat::r32f) {
        Image image = make_image(width, 3, format);
        for (int i = 0; i < width * 3; ++i) {
            image.set(i % width, i / width, 0, 0.5F);
        }
        image.set(1, 2, 0, value);
        const io::ExrPart part{.name = "p", .image = image};
        io::write_exr(folder_ / name, std::span(&part, 1));
        return path(name);
    }
};

TEST_F(Diff, EqualPicturesPassAndDifferentOnesDoNot) {
    const std::string a = picture("a.exr", 0.5F);
    const std::string b = picture("b.exr", 0.75F);
    const Ended same = viscera({"diff", a, a});
    expect_fine(same);
    EXPECT_THAT(same.out, HasSubstr("equal"));
    const Ended other = viscera({"diff", a, b});
    EXPECT_EQ(other.code, 1);
    EXPECT_THAT(other.out, HasSubstr("different"));
    EXPECT_THAT(other.out, HasSubstr("max 0.25"));
    EXPECT_THAT(other.out, HasSubstr("worst at 1,2 channel 0"));
    EXPECT_EQ(viscera({"diff", a, picture("wide.exr", 0.5F, 5)}).code, 1);
    const std::string four = picture("channels.exr", 0.5F, 4, PixelFormat::rgba32f);
    EXPECT_EQ(viscera({"diff", a, four, "--heatmap", path("none.png")}).code, 1);
}

TEST_F(Diff, PicturesOfOneFileAreHeldAgainstThoseOfTheirNames) {
    const auto write = [&](const char* name, const char* first, const char* second) {
        const Image image = make_image(4, 3, PixelFormat::r16f);
        const std::array parts{io::ExrPart{.name = first, .image = image},
                               io::ExrPart{.name = second, .image = image}};
        io::write_exr(folder_ / name, parts);
        return path(name);
    };
    const std::string ab = write("ab.EXR", "a", "b");
    expect_fine(viscera({"diff", ab, write("same.exr", "a", "b")}));
    const Ended other = viscera({"diff", ab, write("ac.exr", "a", "c")});
    EXPECT_EQ(other.code, 1);
    EXPECT_THAT(other.out, HasSubstr("'b' stands against 'c'"));
}

TEST_F(Diff, LimitsLetPassWhatTheySay) {
    const std::string a = picture("a.exr", 0.5F);
    const std::string b = picture("b.exr", 0.75F);
    EXPECT_EQ(viscera({"diff", a, b, "--max", "0.25"}).code, 0);
    EXPECT_EQ(viscera({"diff", a, b, "--max", "0.249"}).code, 1);
    EXPECT_EQ(viscera({"diff", a, b, "--max", "0.25", "--mean", "0.02"}).code, 1);
    EXPECT_EQ(viscera({"diff", a, b, "--fraction", "0.09"}).code, 0) << "one pixel of twelve";
    EXPECT_EQ(viscera({"diff", a, b, "--fraction", "0.08"}).code, 1);
}

TEST_F(Diff, WhatIsNotFiniteNeverPasses) {
    const std::string good = picture("good.exr", 0.5F);
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity()}) {
        const std::string bad = picture("bad.exr", value);
        for (const auto& [a, b] : {std::pair(good, bad), std::pair(bad, good), std::pair(bad, bad)}) {
            EXPECT_EQ(viscera({"diff", a, b, "--max", "1e30", "--mean", "1e30", "--fraction", "1"}).code, 1);
        }
    }
}

TEST_F(Diff, FilesThatAreNoPicturesAreNamed) {
    const std::string good = picture("good.exr", 0.5F);
    (void)folder_.write("bad.exr", slurp(good).substr(0, 120));
    (void)folder_.write("text.txt", "text");
    for (const char* name : {"bad.exr", "none.exr", "none.png", "text.txt"}) {
        expect_refused(viscera({"diff", good, path(name)}), 4, name);
    }
}

TEST_F(Diff, HeatmapShowsWhere) {
    const Ended ended =
        viscera({"diff", picture("a.exr", 0.5F), picture("b.exr", 0.75F), "--heatmap", path("heat.png")});
    EXPECT_EQ(ended.code, 1);
    const Image heat = io::read_image(folder_ / "heat.png");
    EXPECT_EQ(heat.at(0, 0, 0), 0.0F);
    EXPECT_EQ(heat.at(1, 2, 0), 1.0F);
    EXPECT_EQ(
        viscera({"diff", picture("a.exr", 0.5F), picture("b.exr", 0.75F), "--heatmap", path("no/heat.png")})
            .code,
        4);
}

using Info = AppTest;

TEST_F(Info, TellsWhatEachKindOfFileHolds) {
    (void)folder_.write("a.stl", tetra_stl());
    (void)folder_.write("a.obj", tetra_obj());
    (void)folder_.write("a.ply", tetra_ply());
    (void)folder_.write("a.vtp", tetra_vtp());
    (void)folder_.write("line.json", R"({"unit":"mm","nodes":[[0,0,0,1],[0,0,9,2]],"edges":[[0,1]]})");
    const io::ExrPart part{.name = "p", .image = make_image(4, 3, PixelFormat::r16f)};
    io::write_exr(folder_ / "a.exr", std::span(&part, 1));
    io::write_png(folder_ / "a.png", part.image);
    for (const auto& [name, kind] :
         {std::pair("tetra.glb", "meshes"), std::pair("a.stl", "meshes"), std::pair("a.obj", "meshes"),
          std::pair("a.ply", "meshes"), std::pair("a.vtp", "meshes"), std::pair("line.json", "centreline"),
          std::pair("a.exr", "image"), std::pair("a.png", "image")}) {
        const Ended ended = viscera({"info", path(name)});
        expect_fine(ended);
        const json document = json::parse(ended.out);
        EXPECT_EQ(document.at("kind"), kind) << name;
        EXPECT_EQ(document.at("file"), path(name));
    }
    EXPECT_THAT(viscera({"info", path("tetra.glb")}).out, HasSubstr("\"triangles\": 4"));
}

TEST_F(Info, BadFilesAreFileErrors) {
    (void)folder_.write("torn.glb", tetra_glb().substr(0, 99));
    (void)folder_.write("lies.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\n");
    (void)folder_.write("empty.stl", "");
    (void)folder_.write("noise.exr", std::string(500, 'x'));
    (void)folder_.write("what.xyz", "?");
    for (const char* name : {"torn.glb", "lies.ply", "empty.stl", "noise.exr", "what.xyz", "none.glb", "."}) {
        expect_refused(viscera({"info", path(name)}), 4, name);
    }
    expect_refused(viscera({"info", path("scene.json")}), 4, "is a scene");
}

class Schema : public testing::Test {
  protected:
    static std::string source(std::string_view name) {
        return slurp(std::filesystem::path(VISCERA_SOURCE_DIR) / name);
    }
};

TEST_F(Schema, TheCommittedSchemaIsTheOneOfThisBuild) {
    const Ended ended = viscera({"schema"});
    expect_fine(ended);
    EXPECT_TRUE(ended.out == source("assets/schema/scene.schema.json"))
        << "stale: viscera schema > assets/schema/scene.schema.json";
}

TEST_F(Schema, TheCommittedTablesAreThoseOfThisBuild) {
    const Ended ended = viscera({"schema", "--markdown"});
    expect_fine(ended);
    EXPECT_TRUE(ended.out == source("docs/effects.md"))
        << "stale: viscera schema --markdown > docs/effects.md";
}

TEST_F(Schema, ShippedScenesAreValidAndWrongOnesAreNot) {
    const TempFolder folder;
    const Ended schema = viscera({"schema"});
    (void)folder.write("schema.json", schema.out);
    std::filesystem::create_directories(folder / "wrong");
    json scene = json::parse(source("assets/scenes/angiography.json"));
    const auto wrong = [&](const std::string& name, const std::string& pointer, const json& value) {
        json changed = scene;
        changed[json::json_pointer(pointer)] = value;
        (void)folder.write("wrong/" + name + ".json", changed.dump());
    };
    wrong("unknown_key", "/passes/0/nonsense", 1);
    wrong("unknown_parameter", "/passes/0/parameters/nonsense", 1);
    wrong("wrong_type", "/resolution", "large");
    wrong("unknown_effect", "/passes/0/effect", "contrast.nonsense");
    wrong("out_of_range", "/passes/9/parameters/darkest", 7);
    const Ended checked =
        run({"python3", std::string(VISCERA_SOURCE_DIR) + "/tests/core/check_schema.py",
             (folder / "schema.json").string(), std::string(VISCERA_SOURCE_DIR) + "/assets/scenes",
             (folder / "wrong").string()});
    if (checked.code == 77 || checked.code == 127) {
        GTEST_SKIP() << "python3-jsonschema is not installed";
    }
    EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
}

}  // namespace
}  // namespace viscera::test
