#include <algorithm>
#include <random>

#include "tests/io/sample_files.h"
#include "tests/stress/stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using Malformed = Stage;

struct Wrong {
    const char* pointer;  ///< of what is replaced or added
    json value;
    const char* said;  ///< in the message
};

std::vector<Wrong> wrongs() {
    return {{"/version", 99, "version"},
            {"/version", nullptr, "version"},
            {"/nonsense", 1, "nonsense"},
            {"/resolution", {64}, "/resolution"},
            {"/resolution", {0, 5}, "/resolution"},
            {"/resolution", {-4, 5}, "/resolution"},
            {"/resolution", "64x48", "/resolution"},
            {"/resolution", {64.5, 48}, "/resolution"},
            {"/frames_per_second", 0, "/frames_per_second"},
            {"/time_s", "now", "/time_s"},
            {"/camera", 5, "/camera"},
            {"/camera/kind", "fisheye", "fisheye"},
            {"/camera/eye_mm", {1, 2}, "/camera/eye_mm"},
            {"/camera/far_mm", "far", "/camera/far_mm"},
            {"/passes", json::object(), "/passes"},
            {"/passes/0", 7, "/passes/0"},
            {"/passes/0/name", 7, "/passes/0/name"},
            {"/passes/0/name", "summarize", "summarize"},
            {"/passes/0/effect", "contrast.geometri", "contrast.geometry"},
            {"/passes/0/effect", nullptr, "/passes/0/effect"},
            {"/passes/0/parameters", {1, 2}, "/passes/0/parameters"},
            {"/passes/0/parameters/vesel", 1, "vessel"},
            {"/passes/0/parameters/vessel", json::object(), "/passes/0/parameters/vessel"},
            {"/passes/0/parameters/vessel/mesh", 12, "/passes/0/parameters/vessel/mesh"},
            {"/passes/0/parameters/vessel/mesh", "", "/passes/0/parameters/vessel/mesh"},
            {"/passes/0/parameters/vessel/density", "thick", "thick"},
            {"/passes/0/parameters/vessel/mm_per_unit", 0, "mm_per_unit"},
            {"/passes/0/parameters/vessel/injection_mm", nullptr, "injection_mm"},
            {"/passes/0/parameters/vessel/injection_mm", {0, 0, "z"}, "injection_mm"},
            {"/passes/0/parameters/bolus/rise_s", -1, "rise_s"},
            {"/passes/0/parameters/bolus/table", 5, "/passes/0/parameters/bolus/table"},
            {"/passes/0/parameters/cloud/radius_mm", -5, "radius_mm"},
            {"/passes/0/parameters/cloud/brightness", 2, "brightness"},
            {"/passes/0/parameters/method", "depth", "/method"},
            {"/passes/0/parameters/delay_s", -1, "delay_s"},
            {"/passes/0/enabled", "yes", "/passes/0/enabled"},
            {"/passes/0/targets", {{"nonsense", "x"}}, "nonsense"},
            {"/passes/0/targets", {{"main", "Not A Name"}}, "/passes/0/targets/main"},
            {"/passes/0/targets", {{"main", ""}}, "/passes/0/targets"},
            {"/passes/1/targets", {{"main", "contrast.later"}}, "contrast.later"},
            {"/passes/1/targets",
             {{"summary", "contrast.main"}, {"main", "contrast.summary"}},
             "contrast.summary"},
            {"/passes/2/parameters/views", json::array(), "/views"},
            {"/passes/2/parameters/views", nullptr, "/views"},
            {"/passes/2/parameters/views/0/angle_deg", 91, "angle_deg"},
            {"/passes/2/parameters/emitters/0/size", 0, "size"},
            {"/passes/2/parameters/emitters/0/tip_mm", "up", "tip_mm"},
            {"/passes/3/parameters/sigma", 1, "sigma"},
            {"/passes/3/parameters/axis", "z", "axis"},
            {"/passes/3/targets/source", "contrast.nowhere", "contrast.nowhere"},
            {"/passes/4/parameters/darkest", 0, "darkest"},
            {"/passes/4/parameters/tone", 3, "tone"},
            {"/targets", {{"contrast.main", {{"format", "r17f"}}}}, "r17f"},
            {"/targets", {{"contrast.main", {{"scale", 0}}}}, "scale"},
            {"/targets", {{"contrast.main", {{"scale", 1}, {"size", {4, 4}}}}}, "contrast.main"},
            {"/targets", {{"contrast.nobody", {{"scale", 1}}}}, "contrast.nobody"},
            {"/targets", {{"contrast.main", {{"format", "depth32f"}}}}, "summarize"},
            {"/outputs", json::array(), "/outputs"},
            {"/outputs", {"nothing"}, "nothing"},
            {"/outputs", {"final", "final"}, "final"},
            {"/outputs", {3}, "/outputs"},
            {"/shared", 3, "/shared"}};
}

TEST_F(Malformed, EachIsRefusedByNameAndTheSceneBeforeStays) {
    const Image before = render(chain()).at("final");
    for (const Wrong& wrong : wrongs()) {
        json scene = chain();
        scene[json::json_pointer(wrong.pointer)] = wrong.value;
        try {
            load(scene);
            ADD_FAILURE() << wrong.pointer << " = " << wrong.value << " was taken";
            load(chain());
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::scene) << error.what();
            EXPECT_THAT(error.what(), HasSubstr(wrong.said)) << wrong.pointer << " = " << wrong.value;
            EXPECT_THAT(error.what(), HasSubstr("scene.json"));
        }
    }
    expect_same(render(1.0).at("final"), before, "the scene before");
}

TEST_F(Malformed, MissingFilesAreNamedWhenTheyAreNeeded) {
    for (const char* pointer : {"/passes/0/parameters/vessel/mesh", "/passes/2/parameters/views/0/image",
                                "/passes/2/parameters/front"}) {
        json scene = chain();
        scene[json::json_pointer(pointer)] = "gone.ply";
        load(scene);
        try {
            (void)render(1.0);
            ADD_FAILURE() << pointer;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file) << error.what();
            EXPECT_THAT(error.what(), HasSubstr("gone.ply"));
        }
    }
    (void)render(chain());
}

TEST_F(Malformed, NestingAndSizeHaveBounds) {
    const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
    EXPECT_THROW((void)parse_scene("{\"version\":1,\"passes\":" + deep + "}", "deep.json"), Error);
    EXPECT_THROW((void)parse_scene(deep, "deep.json"), Error);
    json scene = chain();
    scene["shared"] = {{"a", {{"$ref", "#/shared/b"}}}, {"b", {{"$ref", "#/shared/a"}}}};
    scene["passes"][0]["parameters"] = {{"$ref", "#/shared/a"}};
    EXPECT_THROW(load(scene), Error);
}

/// Pointers of all leaves of a document.
void leaves(const json& value, const std::string& pointer, std::vector<std::string>& found) {
    if (!value.is_structured() || value.empty()) {
        found.push_back(pointer);
        return;
    }
    for (const auto& [key, child] : value.items()) {
        leaves(child, pointer + "/" + key, found);
    }
}

/// Any value anywhere: a typed error, or a picture that is finite.
TEST_F(Malformed, AnyValueAnywhereIsRefusedOrRendered) {
    std::vector<std::string> pointers;
    leaves(chain(), "", pointers);
    const std::vector<json> values{nullptr,
                                   true,
                                   0,
                                   -1,
                                   1,
                                   2,
                                   1e300,
                                   -1e300,
                                   1e-300,
                                   0.5,
                                   "",
                                   "x",
                                   "final",
                                   "contrast.main",
                                   "smoke.exr",
                                   "tube.ply",
                                   json::array(),
                                   json::object(),
                                   {0, 0, 0},
                                   {1e300, -1e300, 1e300},
                                   {64, 48}};
    std::mt19937 random(20250117U);
    int rendered = 0;
    for (int round = 0; round < 800; ++round) {
        json scene = chain();
        for (int changes = 0; changes <= round % 3; ++changes) {
            const std::string& pointer = pointers[random() % pointers.size()];
            try {
                scene[json::json_pointer(pointer)] = values[random() % values.size()];
            } catch (const json::exception&) {
                // an earlier change has taken the place away
            }
        }
        try {
            load(scene);
            Frame frame = renderer().still(1.0);
            if (static_cast<long>(frame.width) * frame.height > 1 << 20) {
                continue;
            }
            (void)render(frame);
            ++rendered;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(),
                        testing::AnyOf(HasSubstr("scene.json"), HasSubstr(folder().path().string()),
                                       HasSubstr("camera")))
                << error.what();
        }
        if (HasFailure()) {
            FAIL() << scene.dump();
        }
    }
    EXPECT_GT(rendered, 50);
}

/// A damaged mesh in a whole scene: an error that names the file, or a finite picture.
TEST_F(Malformed, DamagedMeshesNeverCrashAScene) {
    std::mt19937 random(20250118U);
    int refused = 0;
    const std::string good = tetra_glb();
    for (int round = 0; round < 150; ++round) {
        std::string bytes = good;
        if (round % 3 == 0) {
            bytes.resize(random() % bytes.size());
        } else {
            for (int flips = 0; flips <= round % 5; ++flips) {
                bytes[random() % bytes.size()] = static_cast<char>(random());
            }
        }
        const std::string name = "damaged" + std::to_string(round) + ".glb";
        (void)folder().write(name, bytes);
        json scene = chain();
        scene["passes"][0]["parameters"]["vessel"]["mesh"] = name;
        load(scene);
        try {
            (void)render(1.0);
        } catch (const Error& error) {
            ++refused;
            EXPECT_TRUE(error.code() == ErrorCode::file || error.code() == ErrorCode::limit) << error.what();
            EXPECT_THAT(error.what(), HasSubstr(name));
        }
    }
    EXPECT_GT(refused, 50);
    (void)render(chain());
}

}  // namespace
}  // namespace viscera::test
