#include <array>
#include <limits>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/core/json_text.h"
#include "engine/core/params_json.h"

namespace viscera {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

enum class Mode { max, depth, painter };
std::span<const std::string_view> choice_names(Mode /*mode*/) {
    static constexpr std::array<std::string_view, 3> names{"max", "depth", "painter"};
    return names;
}

struct Spot {
    glm::dvec2 at_mm{1.0, 2.0};
    double radius_mm = 3.0;
    bool operator==(const Spot&) const = default;

    void visit(ParamVisitor& v) {
        v.field({.name = "at_mm", .doc = "Centre.", .unit = "mm"}, at_mm);
        v.field({.name = "radius_mm", .doc = "Radius.", .unit = "mm", .min = 0.0, .min_excluded = true},
                radius_mm);
    }
};

struct Need {
    std::string id = "none";
    bool operator==(const Need&) const = default;
    void visit(ParamVisitor& v) { v.field({.name = "id", .doc = "Which.", .required = true}, id); }
};

struct Params {
    bool enabled = true;
    int steps = 4;
    double gain = 0.5;
    std::string label = "a";
    Mode mode = Mode::depth;
    AssetPath mesh;
    glm::dvec3 colour{0.1, 0.2, 0.3};
    glm::dvec4 rect{0.0};
    Spot spot;
    std::vector<Spot> spots{Spot{}};
    std::vector<double> times_s{0.0, 1.5};
    std::vector<Mode> modes;
    std::vector<std::vector<int>> grid;
    std::optional<Spot> extra;
    std::optional<double> limit = 7.0;
    bool operator==(const Params&) const = default;

    void visit(ParamVisitor& v) {
        v.field({.name = "enabled", .doc = "On | off."}, enabled);
        v.field({.name = "steps", .doc = "Steps.", .min = 1, .max = 64}, steps);
        v.field({.name = "gain", .doc = "Gain.", .min = 0.0, .max = 1.0}, gain);
        v.field({.name = "label", .doc = "Label."}, label);
        v.field({.name = "mode", .doc = "Mode."}, mode);
        v.field({.name = "mesh", .doc = "Mesh."}, mesh);
        v.field({.name = "colour", .doc = "Colour.", .min = 0.0, .max = 1.0}, colour);
        v.field({.name = "rect", .doc = "Rectangle."}, rect);
        v.field({.name = "spot", .doc = "Spot."}, spot);
        v.field({.name = "spots", .doc = "Spots."}, spots);
        v.field({.name = "times_s", .doc = "Times.", .unit = "s", .min = 0.0}, times_s);
        v.field({.name = "modes", .doc = "Modes."}, modes);
        v.field({.name = "grid", .doc = "Grid.", .max = 9}, grid);
        v.field({.name = "extra", .doc = "Extra."}, extra);
        v.field({.name = "limit", .doc = "Limit.", .min = 0.0}, limit);
    }
};

template <class T>
[[nodiscard]] VisitFunction visiting(T& params) {
    return [&params](ParamVisitor& v) { params.visit(v); };
}

/// Faults as "pointer: message".
template <class T>
[[nodiscard]] std::vector<std::string> read_into(const json& object, T& params, const std::string& base = "",
                                                 const std::string& pointer = "/p") {
    std::vector<JsonFault> faults;
    read_params(object, pointer, base, visiting(params), faults);
    std::vector<std::string> texts;
    for (const JsonFault& fault : faults) {
        texts.push_back(fault.pointer + ": " + fault.message);
    }
    return texts;
}

[[nodiscard]] std::vector<std::string> faults_of(const char* text) {
    Params params;
    return read_into(json::parse(text), params);
}

TEST(ReadParams, KeepsDefaultsOfAnEmptyObject) {
    Params params;
    EXPECT_THAT(read_into(json::object(), params), IsEmpty());
    EXPECT_EQ(params, Params{});
}

TEST(ReadParams, FillsEveryKindOfField) {
    Params params;
    EXPECT_THAT(read_into(json::parse(R"({
        "enabled": false, "steps": 8.0, "gain": 1, "label": "ü", "mode": "painter", "mesh": "../m/a.glb",
        "colour": [0, 0.5, 1], "rect": [1, 2, 3, 4], "spot": {"radius_mm": 9}, "spots": [{}, {"at_mm": [5, 6]}],
        "times_s": [], "modes": ["max", "depth"], "grid": [[1], [], [2, 3]], "extra": {"radius_mm": 2},
        "limit": null, "comment": {"any": "thing"}})"),
                          params, "scenes/x"),
                IsEmpty());
    Params expected;
    expected.enabled = false;
    expected.steps = 8;
    expected.gain = 1.0;
    expected.label = "ü";
    expected.mode = Mode::painter;
    expected.mesh = {"scenes/m/a.glb"};
    expected.colour = {0.0, 0.5, 1.0};
    expected.rect = {1.0, 2.0, 3.0, 4.0};
    expected.spot.radius_mm = 9.0;
    expected.spots = {Spot{}, Spot{{5.0, 6.0}, 3.0}};
    expected.times_s = {};
    expected.modes = {Mode::max, Mode::depth};
    expected.grid = {{1}, {}, {2, 3}};
    expected.extra = Spot{{1.0, 2.0}, 2.0};
    expected.limit = std::nullopt;
    EXPECT_EQ(params, expected);
}

TEST(ReadParams, WritingAndReadingBackGivesTheSame) {
    Params params;
    params.extra = Spot{{0.1, 1e-300}, 2.5};
    params.limit = std::nullopt;
    params.spots.clear();
    params.grid = {{1, 2}, {}};
    params.mesh = {"a/b.glb"};
    params.gain = 0.1;
    Params back;
    EXPECT_THAT(read_into(json::parse(write_params(visiting(params)).dump()), back), IsEmpty());
    EXPECT_EQ(back, params);
}

TEST(ReadParams, ListElementsStartFromTheirTypesDefault) {
    Params params;
    params.spots = {Spot{{8.0, 8.0}, 8.0}};
    EXPECT_THAT(read_into(json::parse(R"({"spots": [{}]})"), params), IsEmpty());
    EXPECT_EQ(params.spots, std::vector<Spot>{Spot{}});
}

TEST(ReadParams, AbsentOptionalStaysAndGroupsMerge) {
    Params params;
    params.spot.at_mm = {7.0, 7.0};
    EXPECT_THAT(read_into(json::parse(R"({"spot": {"radius_mm": 1}})"), params), IsEmpty());
    EXPECT_EQ(params.spot, (Spot{{7.0, 7.0}, 1.0}));
    EXPECT_EQ(params.limit, 7.0);
    EXPECT_FALSE(params.extra.has_value());
}

TEST(ReadParams, NamesUnknownKeys) {
    EXPECT_THAT(faults_of(R"({"gian": 1})"), ElementsAre("/p/gian: unknown key; did you mean \"gain\"?"));
    EXPECT_THAT(faults_of(R"({"times": [1]})"),
                ElementsAre("/p/times: unknown key; did you mean \"times_s\"?"));
    EXPECT_THAT(faults_of(R"({"spot": {"radius_cm": 1}})"),
                ElementsAre("/p/spot/radius_cm: unknown key; did you mean \"radius_mm\"?"));
    EXPECT_THAT(faults_of(R"({"a/b~c": 1})"), ElementsAre("/p/a~1b~0c: unknown key"));
    EXPECT_THAT(faults_of(R"({"spots": [{}, {"y": 1}]})"), ElementsAre("/p/spots/1/y: unknown key"));
}

TEST(ReadParams, NamesWrongKinds) {
    EXPECT_THAT(faults_of(R"({"enabled": 1})"),
                ElementsAre("/p/enabled: expected true or false, not a number"));
    EXPECT_THAT(faults_of(R"({"steps": "4"})"),
                ElementsAre("/p/steps: expected a whole number, not a string"));
    EXPECT_THAT(faults_of(R"({"steps": 4.5})"), ElementsAre("/p/steps: expected a whole number, not 4.5"));
    EXPECT_THAT(faults_of(R"({"gain": null})"), ElementsAre("/p/gain: expected a number, not null"));
    EXPECT_THAT(faults_of(R"({"label": []})"), ElementsAre("/p/label: expected a string, not a list"));
    EXPECT_THAT(faults_of(R"({"mesh": 3})"),
                ElementsAre("/p/mesh: expected the path of a file, not a number"));
    EXPECT_THAT(faults_of(R"({"mesh": "a\u0000b"})"), ElementsAre("/p/mesh: a path cannot hold a zero byte"));
    EXPECT_THAT(faults_of(R"({"mode": 2})"), ElementsAre("/p/mode: expected a word, not a number"));
    EXPECT_THAT(faults_of(R"({"spot": []})"), ElementsAre("/p/spot: expected an object, not a list"));
    EXPECT_THAT(faults_of(R"({"extra": 1})"), ElementsAre("/p/extra: expected an object, not a number"));
    EXPECT_THAT(faults_of(R"({"spots": {}})"), ElementsAre("/p/spots: expected a list, not an object"));
    EXPECT_THAT(faults_of(R"([])"), ElementsAre("/p: expected an object, not a list"));
}

TEST(ReadParams, NamesValuesOutOfRange) {
    EXPECT_THAT(faults_of(R"({"steps": 0})"),
                ElementsAre("/p/steps: must be at least 1 and at most 64, is 0"));
    EXPECT_THAT(faults_of(R"({"steps": 1e300})"), ElementsAre(HasSubstr("is 1e+300")));
    EXPECT_THAT(faults_of(R"({"spot": {"radius_mm": 0}})"),
                ElementsAre("/p/spot/radius_mm: must be above 0 mm, is 0"));
    EXPECT_THAT(faults_of(R"({"times_s": [0, -1, "x"]})"),
                ElementsAre("/p/times_s/1: must be at least 0 s, is -1",
                            "/p/times_s/2: expected a number, not a string"));
    EXPECT_THAT(faults_of(R"({"grid": [[1], [2, 10]]})"),
                ElementsAre("/p/grid/1/1: must be at most 9, is 10"));
    EXPECT_THAT(faults_of(R"({"grid": [[-1e15]]})"),
                ElementsAre("/p/grid/0/0: -1e+15 is too large for a whole number"));
    EXPECT_THAT(faults_of(R"({"limit": -1})"), ElementsAre("/p/limit: must be at least 0, is -1"));
}

TEST(ReadParams, RefusesNumbersThatAreNotFinite) {
    for (const double value :
         {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        Params params;
        EXPECT_THAT(read_into(json{{"rect", {0.0, value, 0.0, 0.0}}}, params),
                    ElementsAre("/p/rect/1: the number is not finite"));
        EXPECT_EQ(params, Params{});
    }
}

TEST(ReadParams, NamesVectorsOfTheWrongLengthOrKind) {
    EXPECT_THAT(faults_of(R"({"colour": [1, 1]})"),
                ElementsAre("/p/colour: expected a list of 3 numbers, not of 2"));
    EXPECT_THAT(faults_of(R"({"colour": 1})"),
                ElementsAre("/p/colour: expected a list of 3 numbers, not a number"));
    EXPECT_THAT(faults_of(R"({"colour": [1, 2, true]})"),
                ElementsAre("/p/colour/1: must be at least 0 and at most 1, is 2",
                            "/p/colour/2: expected a number, not true"));
}

TEST(ReadParams, NamesUnknownWords) {
    EXPECT_THAT(faults_of(R"({"mode": "Depht"})"),
                ElementsAre("/p/mode: unknown value \"Depht\"; did you mean \"depth\"?"));
    EXPECT_THAT(
        faults_of(R"({"modes": ["max", "zzzzzz"]})"),
        ElementsAre("/p/modes/1: unknown value \"zzzzzz\"; expected one of \"max\", \"depth\", \"painter\""));
}

TEST(ReadParams, FieldsAtFaultKeepTheirValue) {
    Params params;
    EXPECT_THAT(
        read_into(json::parse(R"({"enabled": 0, "steps": 99, "gain": "x", "label": 1, "mode": "no", "mesh": 1,
        "colour": [0, 0, 5], "rect": [], "spot": 1, "spots": 1, "times_s": "x", "modes": {}, "grid": 0,
        "extra": {"radius_mm": -1}, "limit": "x"})"),
                  params),
        testing::SizeIs(15));
    EXPECT_EQ(params, Params{});
}

TEST(ReadParams, WantsRequiredKeys) {
    struct Holder {
        Need need;
        std::vector<Need> list;
        std::optional<Need> maybe;
        void visit(ParamVisitor& v) {
            v.field({.name = "need", .doc = ""}, need);
            v.field({.name = "list", .doc = "", .required = true}, list);
            v.field({.name = "maybe", .doc = ""}, maybe);
        }
    };
    Holder holder;
    EXPECT_THAT(read_into(json::object(), holder), ElementsAre("/p/need/id: missing", "/p/list: missing"));
    EXPECT_THAT(read_into(json::parse(R"({"need": 1, "list": [{}], "maybe": {}})"), holder),
                ElementsAre("/p/need: expected an object, not a number", "/p/list/0/id: missing",
                            "/p/maybe/id: missing"));
    struct Strict {
        Need need;
        void visit(ParamVisitor& v) { v.field({.name = "need", .doc = "", .required = true}, need); }
    };
    Strict strict;
    EXPECT_THAT(read_into(json::object(), strict), ElementsAre("/p/need: missing"));
}

TEST(ReadParams, ResolvesPathsWithoutLookingAtThem) {
    const auto resolved = [](const char* path, const char* base) {
        Params params;
        EXPECT_THAT(read_into(json{{"mesh", path}}, params, base), IsEmpty());
        return params.mesh.path.generic_string();
    };
    EXPECT_EQ(resolved("a.glb", "assets/scenes"), "assets/scenes/a.glb");
    EXPECT_EQ(resolved("../meshes/./a.glb", "assets/scenes"), "assets/meshes/a.glb");
    EXPECT_EQ(resolved("/abs/x/../a.glb", "assets"), "/abs/a.glb");
    EXPECT_EQ(resolved("a.glb", ""), "a.glb");
    EXPECT_EQ(resolved("", "assets"), "");
}

TEST(WriteParams, WritesEveryField) {
    Params params;
    const json written = write_params(visiting(params));
    EXPECT_EQ(written,
              json::parse(R"({"enabled": true, "steps": 4, "gain": 0.5, "label": "a", "mode": "depth",
        "mesh": "", "colour": [0.1, 0.2, 0.3], "rect": [0.0, 0.0, 0.0, 0.0],
        "spot": {"at_mm": [1.0, 2.0], "radius_mm": 3.0}, "spots": [{"at_mm": [1.0, 2.0], "radius_mm": 3.0}],
        "times_s": [0.0, 1.5], "modes": [], "grid": [], "extra": null, "limit": 7.0})"));
}

TEST(ParamsSchema, DescribesEveryField) {
    Params params;
    const json schema = params_schema(visiting(params));
    EXPECT_EQ(params, Params{}) << "left as it was";
    EXPECT_EQ(schema["type"], "object");
    EXPECT_EQ(schema["additionalProperties"], false);
    EXPECT_FALSE(schema.contains("required"));
    const json& p = schema["properties"];
    EXPECT_EQ(p["steps"], json::parse(R"({"type": "integer", "minimum": 1, "maximum": 64, "default": 4,
        "description": "Steps."})"));
    EXPECT_EQ(p["mode"], json::parse(R"({"enum": ["max", "depth", "painter"], "default": "depth",
        "description": "Mode."})"));
    EXPECT_EQ(p["colour"], json::parse(R"({"type": "array", "minItems": 3, "maxItems": 3,
        "items": {"type": "number", "minimum": 0, "maximum": 1}, "default": [0.1, 0.2, 0.3],
        "description": "Colour."})"));
    EXPECT_EQ(p["spot"]["properties"]["radius_mm"], json::parse(R"({"type": "number", "exclusiveMinimum": 0,
        "default": 3.0, "description": "Radius. [mm]"})"));
    EXPECT_EQ(p["spots"]["items"]["properties"]["at_mm"]["default"], json::parse("[1.0, 2.0]"));
    EXPECT_EQ(p["spots"]["default"], json::parse(R"([{"at_mm": [1.0, 2.0], "radius_mm": 3.0}])"));
    EXPECT_EQ(p["grid"]["items"]["items"], json::parse(R"({"type": "integer", "maximum": 9})"));
    EXPECT_EQ(p["extra"]["default"], nullptr);
    EXPECT_EQ(p["extra"]["anyOf"][0]["properties"]["radius_mm"]["default"], 3.0);
    EXPECT_EQ(p["limit"], json::parse(R"({"anyOf": [{"type": "number", "minimum": 0}, {"type": "null"}],
        "default": 7.0, "description": "Limit."})"));
    Need need;
    EXPECT_EQ(params_schema(visiting(need))["required"], json::parse(R"(["id"])"));
}

TEST(ParamsMarkdown, HasARowForEveryField) {
    Params params;
    const std::string table = params_markdown(visiting(params));
    EXPECT_EQ(params, Params{});
    EXPECT_THAT(table, testing::StartsWith("| key | type | default | range | unit | meaning |\n|---|"));
    for (const char* row : {
             "| `enabled` | true or false | `true` |  |  | On \\| off. |\n",
             "| `steps` | whole number | `4` | ≥ 1, ≤ 64 |  | Steps. |\n",
             "| `mode` | choice | `\"depth\"` | `max`, `depth`, `painter` |  | Mode. |\n",
             "| `colour` | 3 numbers | `[0.1, 0.2, 0.3]` | ≥ 0, ≤ 1 |  | Colour. |\n",
             "| `spot` | object |  |  |  | Spot. |\n",
             "| `spot.radius_mm` | number | `3` | > 0 | mm | Radius. |\n",
             "| `spots[].at_mm` | 2 numbers | `[1, 2]` |  | mm | Centre. |\n",
             "| `times_s` | list of number | `[0, 1.5]` | ≥ 0 | s | Times. |\n",
             "| `modes` | list of choice | `[]` | `max`, `depth`, `painter` |  | Modes. |\n",
             "| `extra` | object or null | `null` |  |  | Extra. |\n",
             "| `extra.radius_mm` | number | `3` | > 0 | mm | Radius. |\n",
         }) {
        EXPECT_THAT(table, HasSubstr(row));
    }
    EXPECT_LT(table.find("`enabled`"), table.find("`steps`"));
    Need need;
    EXPECT_THAT(params_markdown(visiting(need)), HasSubstr("| `id` | text | required |  |  | Which. |"));
}

TEST(NearestWord, SuggestsWhatIsNear) {
    const std::vector<std::string> words{"radius_mm", "height_mm", "time_s", "up"};
    EXPECT_EQ(nearest_word("radius_mm", words), "radius_mm");
    EXPECT_EQ(nearest_word("radius", words), "radius_mm");
    EXPECT_EQ(nearest_word("RadiusMM", words), "radius_mm");
    EXPECT_EQ(nearest_word("height-mm", words), "height_mm");
    EXPECT_EQ(nearest_word("itme_s", words), "time_s");
    EXPECT_EQ(nearest_word("pu", words), "up");
    EXPECT_EQ(nearest_word("", words), "");
    EXPECT_EQ(nearest_word("x", words), "");
    EXPECT_EQ(nearest_word("colour", words), "");
    EXPECT_EQ(nearest_word("radius", {}), "");
    EXPECT_EQ(nearest_word(std::string(1 << 20, 'a'), words), "");
}

TEST(JsonPointer, EscapesAndSplits) {
    EXPECT_EQ(child_pointer("/a", "b/c~d"), "/a/b~1c~0d");
    EXPECT_EQ(child_pointer("", std::size_t{3}), "/3");
    EXPECT_THAT(*pointer_tokens("/a/b~1c~0d//"), ElementsAre("a", "b/c~d", "", ""));
    EXPECT_THAT(*pointer_tokens(""), IsEmpty());
    EXPECT_EQ(pointer_tokens("a"), std::nullopt);
    EXPECT_EQ(pointer_tokens("/~2"), std::nullopt);
    EXPECT_EQ(pointer_tokens("/~"), std::nullopt);
}

}  // namespace
}  // namespace viscera
