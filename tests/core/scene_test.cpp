#include "engine/core/scene.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/json_text.h"
#include "tests/core/sample_scene.h"

namespace viscera {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ParseScene, ReadsAScene) {
    const Scene scene = parse(valid_scene);
    EXPECT_EQ(scene.file, "scenes/a.json");
    EXPECT_EQ(scene.name, "two passes");
    EXPECT_EQ(scene.width, 640);
    EXPECT_EQ(scene.height, 480);
    EXPECT_EQ(scene.time_s, 2.5);
    EXPECT_EQ(scene.frames_per_second, 15.0);
    EXPECT_EQ(scene.camera.kind, CameraKind::orthographic);
    EXPECT_EQ(scene.camera.eye_mm, glm::dvec3(0.0, -100.0, 0.0));
    ASSERT_EQ(scene.targets.size(), 2U);
    EXPECT_EQ(scene.targets[0].name, "contrast.main");
    EXPECT_EQ(scene.targets[0].format, PixelFormat::r16f);
    EXPECT_EQ(scene.targets[0].size->scale, 0.5);
    EXPECT_EQ(scene.targets[0].size->width, 0);
    EXPECT_THAT(*scene.targets[0].clear, ElementsAre(1.0F, 0.0F, 0.0F, 0.0F));
    EXPECT_EQ(scene.targets[1].format, std::nullopt);
    EXPECT_EQ(scene.targets[1].size->width, 32);
    EXPECT_EQ(scene.targets[1].size->height, 16);
    EXPECT_EQ(scene.targets[1].clear, std::nullopt);
    ASSERT_EQ(scene.passes.size(), 2U);
    EXPECT_EQ(scene.passes[0].name, "first");
    EXPECT_EQ(scene.passes[0].effect, "test.flow");
    EXPECT_TRUE(scene.passes[0].enabled);
    EXPECT_EQ(scene.passes[0].pointer, "/passes/0");
    EXPECT_FALSE(scene.passes[1].enabled);
    EXPECT_EQ(scene.passes[1].targets, (std::map<std::string, std::string>{{"main", "fixed"}}));
    EXPECT_THAT(scene.outputs, ElementsAre("contrast.main", "fixed"));
}

TEST(ParseScene, ExpandsReferences) {
    const Scene scene = parse(valid_scene);
    EXPECT_EQ(scene.passes[0].parameters,
              json::parse(R"({"rate": 4, "mesh": "../meshes/a.glb", "points": [1, 2]})"));
    EXPECT_EQ(scene.passes[1].parameters,
              json::parse(R"({"rate": 9, "mesh": "../meshes/a.glb", "points": [3]})"));
}

TEST(ParseScene, HasDefaults) {
    const Scene scene = parse(R"({"version": 1, "passes": [], "outputs": ["a"]})");
    EXPECT_EQ(scene.width, 1024);
    EXPECT_EQ(scene.height, 1024);
    EXPECT_EQ(scene.frames_per_second, 30.0);
    EXPECT_EQ(parse(R"({"version": 1, "passes": [{"name": "p", "effect": "e"}], "outputs": ["a"]})")
                  .passes[0]
                  .parameters,
              json::object());
}

TEST(ParseScene, HashFollowsTheContentOnly) {
    const std::string hash = parse(valid_scene).hash;
    EXPECT_EQ(hash.size(), 16U);
    EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
    EXPECT_EQ(parse(json::parse(valid_scene).dump(8)).hash, hash) << "layout does not matter";
    EXPECT_NE(parse(valid_scene, {{"/time_s", 3.0}}).hash, hash);
    EXPECT_NE(parse(with("/name", "other")).hash, hash);
}

TEST(ParseScene, ToleratesAByteOrderMark) {
    EXPECT_EQ(parse("\xEF\xBB\xBF" + std::string(valid_scene)).hash, parse(valid_scene).hash);
}

TEST(ParseScene, SyntaxErrorsHaveLineAndColumn) {
    EXPECT_THAT(error_of("{\n  \"version\": 1,\n  \"ü\" 2}"),
                StartsWith("scenes/a.json: line 3, column 7: "));
    EXPECT_THAT(error_of(""), StartsWith("scenes/a.json: line 1, column 1: "));
    EXPECT_THAT(error_of("{\"a\": 1e999}"), HasSubstr("line 1, column"));
    EXPECT_THAT(error_of("{\"a\": 1e999}"), HasSubstr("number overflow"));
    EXPECT_THAT(error_of("{} x"), HasSubstr("line 1, column 4"));
    for (const char* text :
         {"{", "[", "{\"a\"", "{\"a\":}", "{\"a\":1,}", "[1,]", "nul", "{'a': 1}", "// x\n{}", "\"a",
          "{\"a\": NaN}", "{\"a\": 01}", "\"\\x\"", "\"\\ud800\"", "{\"a\": .5}", "]", ","}) {
        EXPECT_THAT(error_of(text), StartsWith("scenes/a.json: line ")) << text;
    }
}

TEST(ParseScene, SaysWhereTheTextIsNotUtf8) {
    for (const char* bytes : {"\xFF", "\xC3", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80",
                              "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\x80", "\xE2\x82"}) {
        EXPECT_EQ(error_of("{\n\"name\": \"" + std::string(bytes) + "\"}"),
                  "scenes/a.json: line 2, column 10: not valid UTF-8");
    }
    EXPECT_EQ(parse(with("/name", "aµ€😀")).name, "aµ€😀");
}

TEST(ParseScene, NamesKeysThatStandTwice) {
    EXPECT_THAT(
        error_of(
            R"({"version": 1, "passes": [{"name": "a", "effect": "e", "name": "b"}], "outputs": ["x"]})"),
        HasSubstr("scenes/a.json: /passes/0/name: the key stands twice"));
    EXPECT_THAT(error_of(R"({"version": 1, "version": 1, "passes": [], "outputs": ["x"]})"),
                HasSubstr("/version: the key stands twice"));
}

TEST(ParseScene, BoundsDepthAndSize) {
    EXPECT_THAT(error_of(std::string(10'000'000, '[')), HasSubstr("nested deeper than"));
    std::string nested;
    for (int i = 0; i < 1'000'000; ++i) {
        nested += "{\"a\":";
    }
    EXPECT_THAT(error_of(nested), HasSubstr("nested deeper than"));
    EXPECT_THAT(error_of(std::string((std::size_t{64} << 20U) + 1, ' ')), HasSubstr("longer than 64 MiB"));
    std::string many = "[0";
    for (int i = 0; i < 2'000'000; ++i) {
        many += ",0";
    }
    EXPECT_THAT(error_of(many + "]"), HasSubstr("more than 2000000 values"));
}

TEST(ParseScene, ReferencesCannotRunAway) {
    json document = json::parse(valid_scene);
    document["shared"] = {{"a0", 1}};
    for (int i = 1; i < 40; ++i) {
        const json part{{"$ref", "#/shared/a" + std::to_string(i - 1)}};
        document["shared"]["a" + std::to_string(i)] = json::array({part, part});
    }
    document["passes"][0]["parameters"] = {{"x", {{"$ref", "#/shared/a39"}}}};
    EXPECT_THAT(error_of(document.dump()), HasSubstr("/passes/0/parameters/x"));
    json chain = json::parse(valid_scene);
    for (int i = 0; i < 100'000; ++i) {
        chain["shared"]["b" + std::to_string(i)] = {{"$ref", "#/shared/b" + std::to_string(i + 1)}};
    }
    chain["passes"][0]["parameters"] = {{"$ref", "#/shared/b0"}};
    EXPECT_THAT(error_of(chain.dump()), HasSubstr("nested too deeply"));
}

struct Fault {
    std::string text;
    std::string expected;  ///< after "scenes/a.json: "
};

TEST(ParseScene, NamesEachFault) {
    const std::vector<Fault> faults{
        {"[]", "expected an object, not a list"},
        {"null", "expected an object, not null"},
        {"3", "expected an object, not a number"},
        {without("/version"), "/version: missing"},
        {with("/version", 2), "/version: must be 1, is 2"},
        {with("/version", "1"), "/version: expected a whole number, not a string"},
        {without("/passes"), "/passes: missing"},
        {with("/passes", json::object()), "/passes: expected a list, not an object"},
        {without("/outputs"), "/outputs: missing"},
        {with("/outputs", json::array()), "/outputs: expected at least one target"},
        {with("/outputs/0", "../x"), "/outputs/0: a target's name is made of"},
        {with("/outputs/1", "contrast.main"), "/outputs/1: \"contrast.main\" stands twice"},
        {with("/outputs/1", 3), "/outputs/1: expected a string, not a number"},
        {with("/pases", json::array()), "/pases: unknown key; did you mean \"passes\"?"},
        {with("/target", json::array()), "/target: unknown key; did you mean \"targets\"?"},
        {with("/resolution", {640}), "/resolution: expected [width, height]"},
        {with("/resolution", 640), "/resolution: expected a list, not a number"},
        {with("/resolution/1", 0), "/resolution/1: must be at least 1 and at most 16384 pixels, is 0"},
        {with("/resolution/0", 16385),
         "/resolution/0: must be at least 1 and at most 16384 pixels, is 16385"},
        {with("/resolution/0", 1.5), "/resolution/0: expected a whole number, not 1.5"},
        {with("/frames_per_second", 0), "/frames_per_second: must be above 0"},
        {with("/time_s", "now"), "/time_s: expected a number, not a string"},
        {with("/camera", 1), "/camera: expected an object, not a number"},
        {with("/camera/kind", "ortographic"),
         "/camera/kind: unknown value \"ortographic\"; did you mean \"orthographic\"?"},
        {with("/camera/eye", {0, 0, 0}), "/camera/eye: unknown key; did you mean \"eye_mm\"?"},
        {with("/camera/eye_mm", {0, 0, 0}), "/camera: "},
        {with("/shared", json::array()), "/shared: expected an object, not a list"},
        {with("/targets", json::array()), "/targets: expected an object, not a list"},
        {with("/targets/Bad", json::object()), "/targets/Bad: a target's name is made of"},
        {with("/targets/a..b", json::object()), "/targets/a..b: a target's name is made of"},
        {with("/targets/x~1y", json::object()), "/targets/x~1y: a target's name is made of"},
        {with("/targets/fixed", 1), "/targets/fixed: expected an object, not a number"},
        {with("/targets/fixed/format", "rgba16"),
         "/targets/fixed/format: unknown value \"rgba16\"; did you mean \"rgba16f\"?"},
        {with("/targets/fixed/scale", 0.5), "/targets/fixed/size: scale and size exclude each other"},
        {with("/targets/contrast.main/scale", 0),
         "/targets/contrast.main/scale: must be above 0 and at most 4, is 0"},
        {with("/targets/contrast.main/scale", 4.1),
         "/targets/contrast.main/scale: must be above 0 and at most 4, is 4.1"},
        {with("/targets/fixed/size", {1, 2, 3}), "/targets/fixed/size: expected [width, height]"},
        {with("/targets/fixed/clear", json::array()), "/targets/fixed/clear: expected one to four numbers"},
        {with("/targets/fixed/clear", {0, 0, 0, 0, 0}), "/targets/fixed/clear: expected one to four numbers"},
        {with("/targets/fixed/clear", {1e39}), "/targets/fixed/clear/0: must be at least"},
        {with("/passes/0", 1), "/passes/0: expected an object, not a number"},
        {without("/passes/0/name"), "/passes/0/name: missing"},
        {without("/passes/0/effect"), "/passes/0/effect: missing"},
        {with("/passes/0/effect", ""), "/passes/0/effect: no effect is named"},
        {with("/passes/0/name", ""), "/passes/0/name: a pass's name is made of"},
        {with("/passes/0/name", "a b"), "/passes/0/name: a pass's name is made of"},
        {with("/passes/0/name", std::string(129, 'a')), "/passes/0/name: a pass's name is made of"},
        {with("/passes/1/name", "first"), "/passes/1/name: another pass is called \"first\""},
        {with("/passes/0/enable", true), "/passes/0/enable: unknown key; did you mean \"enabled\"?"},
        {with("/passes/0/enabled", 1), "/passes/0/enabled: expected true or false, not a number"},
        {with("/passes/0/params", json::object()), "/passes/0/params: unknown key"},
        {with("/passes/0/parameters", json::array()), "/passes/0/parameters: expected an object, not a list"},
        {with("/passes/1/targets", json::array()),
         "/passes/1/targets: expected an object of port and target, not a list"},
        {with("/passes/1/targets/main", 1),
         "/passes/1/targets/main: expected the name of a target or null, not a number"},
        {with("/passes/1/targets/main", "A"), "/passes/1/targets/main: a target's name is made of"},
        {with("/passes/0/parameters/$ref", "#/shared/flaw"),
         "/passes/0/parameters/$ref: nothing stands at \"#/shared/flaw\"; did you mean \"#/shared/flow\"?"},
        {with("/passes/0/parameters/$ref", "#/shared/flow/none"),
         "/passes/0/parameters/$ref: nothing stands at \"#/shared/flow/none\""},
        {with("/passes/0/parameters/$ref", "#/shared/flow/points/2"),
         "/passes/0/parameters/$ref: nothing stands at"},
        {with("/passes/0/parameters/$ref", "other.json"),
         "/passes/0/parameters/$ref: expected \"#/shared/NAME\""},
        {with("/passes/0/parameters/$ref", 3), "/passes/0/parameters/$ref: expected \"#/shared/NAME\""},
        {with("/passes/0/parameters/$ref", "#/shared/three"),
         "/passes/0/parameters: expected an object, not a number"},
        {with("/passes/1/parameters/$ref", "#/shared/three"),
         "/passes/1/parameters/$ref: keys stand beside it, but it names a number"},
        {with("/shared/flow/rate", {{"$ref", "#/shared/flow"}}),
         "/passes/0/parameters/rate/$ref: refers to itself: #/shared/flow -> #/shared/flow"},
        {with("/shared/flow/rate", {{"$ref", "#/shared/fast"}}),
         "/passes/0/parameters/rate/$ref: refers to itself: #/shared/flow -> #/shared/fast -> #/shared/flow"},
        {without("/shared"), "/passes/0/parameters/$ref: nothing stands at \"#/shared/flow\""},
    };
    for (const Fault& fault : faults) {
        EXPECT_THAT(error_of(fault.text), StartsWith("scenes/a.json: " + fault.expected)) << fault.text;
    }
}

TEST(ParseScene, ListsAllFaultsOnePerLine) {
    json document = json::parse(valid_scene);
    document["version"] = 7;
    document["a\nb"] = 1;
    document["passes"][1]["effect"] = false;
    document["outputs"] = json::array();
    EXPECT_EQ(error_of(document.dump()),
              "scenes/a.json: /version: must be 1, is 7\n"
              "scenes/a.json: /a?b: unknown key\n"
              "scenes/a.json: /outputs: expected at least one target\n"
              "scenes/a.json: /passes/1/effect: expected a string, not false");
}

TEST(ParseScene, BoundsTheListOfFaults) {
    json document = json::parse(valid_scene);
    for (int i = 0; i < 150; ++i) {
        document["unknown" + std::to_string(i)] = i;
    }
    const std::string text = error_of(document.dump());
    EXPECT_EQ(std::ranges::count(text, '\n'), 100);
    EXPECT_THAT(text, testing::EndsWith("\nscenes/a.json: and 50 faults more"));
}

TEST(Overrides, ChangeAndAdd) {
    const Scene scene = parse(valid_scene, {{"/time_s", 9},
                                            {"/camera/near_mm", 2},
                                            {"/passes/1/parameters/rate", 11},
                                            {"/shared/three", 33},
                                            {"/outputs/-", "extra"},
                                            {"/outputs/0", "fixed2"},
                                            {"/targets/new.one", json::object()},
                                            {"/targets/new.one/format", "r8"}});
    EXPECT_EQ(scene.time_s, 9.0);
    EXPECT_EQ(scene.camera.near_mm, 2.0);
    EXPECT_EQ(scene.passes[1].parameters["rate"], 11);
    EXPECT_EQ(scene.passes[1].parameters["points"], json::array({33}));
    EXPECT_THAT(scene.outputs, ElementsAre("fixed2", "fixed", "extra"));
    EXPECT_EQ(scene.targets.back().format, PixelFormat::r8);
}

TEST(Overrides, NameWhatDoesNotExist) {
    EXPECT_THAT(error_of(valid_scene, {{"/camra/near_mm", 2}}), HasSubstr("/camra/near_mm: cannot be set"));
    EXPECT_THAT(error_of(valid_scene, {{"/passes/7/enabled", true}}),
                HasSubstr("/passes/7/enabled: cannot be set"));
    EXPECT_THAT(error_of(valid_scene, {{"/outputs/3", "x"}}), HasSubstr("/outputs/3: cannot be set"));
    EXPECT_THAT(error_of(valid_scene, {{"/outputs/x", "x"}}), HasSubstr("/outputs/x: cannot be set"));
    EXPECT_THAT(error_of(valid_scene, {{"/time_s/x", 1}}), HasSubstr("/time_s/x: cannot be set"));
    EXPECT_THAT(error_of(valid_scene, {{"", 1}}), HasSubstr("not a pointer"));
    EXPECT_THAT(error_of(valid_scene, {{"time_s", 1}}), HasSubstr("not a pointer"));
    EXPECT_THAT(error_of(valid_scene, {{"/time", 1}}),
                HasSubstr("/time: unknown key; did you mean \"time_s\"?"));
}

TEST(Overrides, AreParsedFromText) {
    const auto value = [](std::string_view text) { return parse_override(text).value; };
    EXPECT_EQ(parse_override("/a/b~1c=1").pointer, "/a/b~1c");
    EXPECT_EQ(value("/a=1.5"), 1.5);
    EXPECT_EQ(value("/a=[1, 2]"), json::array({1, 2}));
    EXPECT_EQ(value("/a={\"x\": null}"), json({{"x", nullptr}}));
    EXPECT_EQ(value("/a=true"), true);
    EXPECT_EQ(value("/a=\"true\""), "true");
    EXPECT_EQ(value("/a=painter"), "painter");
    EXPECT_EQ(value("/a=../x=y.glb"), "../x=y.glb");
    EXPECT_EQ(value("/a="), "");
    for (const std::string text : {"", "/a", "=1", "a=1", "/~=1", "/a=[1", "/a={", "/a=\"x", "/a=\xFF"}) {
        try {
            (void)parse_override(text);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::usage) << text;
        }
    }
    EXPECT_THROW((void)parse_override("/a=" + std::string(1'000'000, '[')), Error);
}

class SceneFiles : public testing::Test {
  protected:
    SceneFiles() {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_ / "valid");
        std::filesystem::create_directories(folder_ / "invalid");
    }
    ~SceneFiles() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }

    const std::filesystem::path folder_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("scene_test_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(SceneFiles, AreLoaded) {
    const std::filesystem::path file = write("a.json", valid_scene);
    const Scene scene = load_scene(file);
    EXPECT_EQ(scene.file, file);
    EXPECT_EQ(scene.hash, parse(valid_scene).hash);
    const std::vector<SceneOverride> overrides{{"/time_s", 7}};
    EXPECT_EQ(load_scene(file, overrides).time_s, 7.0);
}

TEST_F(SceneFiles, ThatCannotBeReadAreFileErrors) {
    for (const std::filesystem::path& file : {folder_ / "none.json", folder_, std::filesystem::path()}) {
        try {
            (void)load_scene(file);
            ADD_FAILURE() << file;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file) << error.what();
        }
    }
}

struct FlowParams {
    double rate = 1.0;
    AssetPath mesh;
    std::vector<double> points;
    std::optional<glm::dvec2> shift;

    void visit(ParamVisitor& v) {
        v.field({.name = "rate", .doc = "Rate.", .unit = "ml/s", .min = 0.0}, rate);
        v.field({.name = "mesh", .doc = "Mesh."}, mesh);
        v.field({.name = "points", .doc = "Points."}, points);
        v.field({.name = "shift", .doc = "Shift."}, shift);
    }
};

struct NeedyParams {
    int id = 0;
    void visit(ParamVisitor& v) { v.field({.name = "id", .doc = "Which.", .required = true}, id); }
};

[[nodiscard]] json schema() {
    static FlowParams flow;
    static NeedyParams needy;
    const std::vector<EffectSchema> effects{
        {"test.flow", "Flows.", [](ParamVisitor& v) { flow.visit(v); }},
        {"test/needy", "Needs.", [](ParamVisitor& v) { needy.visit(v); }},
    };
    return scene_schema(effects);
}

/// The schema and the reader must agree, for editors and CI see only the schema.
TEST_F(SceneFiles, AgreeWithTheSchema) {
    const std::filesystem::path schema_file = write("schema.json", schema().dump(1));
    const json needy{{"name", "n"}, {"effect", "test/needy"}, {"parameters", {{"id", 3}}}};
    json needy_shared = needy;
    needy_shared["parameters"] = {{"$ref", "#/shared/three"}};
    int count = 0;
    for (const std::string& text :
         {std::string(valid_scene), without("/camera"), without("/targets"),
          with("/passes/0/parameters/rate", {{"$ref", "#/shared/three"}}),
          with("/passes/0/parameters/shift", nullptr), with("/passes/0/parameters/shift", {1, 2}),
          with("/passes/0/parameters/points", {{"$ref", "#/shared/flow/points"}, {"comment", "x"}}),
          with("/passes/1", needy), with("/targets/fixed/format", nullptr)}) {
        EXPECT_NO_THROW((void)parse(text)) << text;
        (void)write("valid/" + std::to_string(count++) + ".json", text);
    }
    (void)write("valid/reference.json", with("/passes/1", needy_shared));
    json lacking = needy;
    lacking.erase("parameters");
    json empty = needy;
    empty["parameters"] = json::object();
    for (const std::string& text : {with("/version", 2),
                                    without("/outputs"),
                                    without("/passes"),
                                    with("/outputs", json::array()),
                                    with("/outputs/0", "../x"),
                                    with("/resolution", {1}),
                                    with("/resolution/0", 0),
                                    with("/pases", 1),
                                    with("/camera/kind", "x"),
                                    with("/targets/Bad", json::object()),
                                    with("/targets/a..b", json::object()),
                                    with("/targets/fixed/scale", 1),
                                    with("/targets/fixed/format", "rgba16"),
                                    with("/targets/fixed/clear", json::array()),
                                    with("/passes/0/enabled", 1),
                                    with("/passes/0/effect", "test.flaw"),
                                    with("/passes/0/name", "a b"),
                                    with("/passes/0/parameters/rate", -1),
                                    with("/passes/0/parameters/rat", 1),
                                    with("/passes/0/parameters/shift", {1}),
                                    with("/passes/0/parameters/points", {"x"}),
                                    with("/passes/0/parameters/$ref", "other.json"),
                                    with("/passes/1/targets/main", "A"),
                                    with("/passes/1", lacking),
                                    with("/passes/1", empty)}) {
        (void)write("invalid/" + std::to_string(count++) + ".json", text);
    }
    const std::string command = "/usr/bin/python3 '" VISCERA_SOURCE_DIR "/tests/core/check_schema.py' '" +
                                schema_file.string() + "' '" + (folder_ / "valid").string() + "' '" +
                                (folder_ / "invalid").string() + "'";
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127) {
        GTEST_SKIP() << "python3-jsonschema is not installed";
    }
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace viscera
