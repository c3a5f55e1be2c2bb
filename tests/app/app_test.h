#pragma once

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/process.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {

/// A folder with a small scene: a tetrahedron that fills with contrast, and a pass that nobody needs and
/// whose file is not there.
class AppTest : public testing::Test {
  protected:
    AppTest() {
        (void)folder_.write("tetra.glb", tetra_glb());
        write_scene(scene_);
    }

    static nlohmann::json small_scene() {
        return nlohmann::json::parse(R"({
            "version": 1, "name": "tetra", "resolution": [48, 32], "time_s": 1, "frames_per_second": 10,
            "camera": {"eye_mm": [0.3, -4, 0.3], "target_mm": [0.3, 0, 0.3], "near_mm": 0.1, "far_mm": 100},
            "passes": [
                {"name": "vessels", "effect": "contrast.main", "parameters": {
                    "vessel": {"mesh": "tetra.glb", "mm_per_unit": 1, "injection_mm": [0, 0, 0],
                               "geodesic": {"speed_mm_s": 2}}}},
                {"name": "unused", "effect": "picture.image", "parameters": {"file": "not-there.png"},
                 "targets": {"image": "unused"}},
                {"name": "composite", "effect": "contrast.composite", "parameters": {},
                 "targets": {"summary": "contrast.main"}}
            ],
            "outputs": ["final"]})");
    }
    void write_scene(const nlohmann::json& scene) { (void)folder_.write("scene.json", scene.dump(2)); }
    [[nodiscard]] std::string path(std::string_view name) const { return (folder_ / name).string(); }

    /// `viscera render scene.json -o out --backend osmesa` and more.
    [[nodiscard]] Ended render(std::vector<std::string> more = {}, const Call& call = {}) const {
        std::vector<std::string> arguments{"render",    path("scene.json"), "-o",
                                           path("out"), "--backend",        "osmesa"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return viscera(arguments, call);
    }
    [[nodiscard]] nlohmann::json report() const { return nlohmann::json::parse(slurp(path("report.json"))); }
    [[nodiscard]] std::set<std::string> files(std::string_view folder = "out") const {
        std::set<std::string> names;
        if (std::filesystem::exists(folder_ / folder)) {
            for (const auto& entry : std::filesystem::directory_iterator(folder_ / folder)) {
                names.insert(entry.path().filename().string());
            }
        }
        return names;
    }

    TempFolder folder_;
    nlohmann::json scene_ = small_scene();
};

/// Ended as it should, with a message on stderr and no half results on stdout.
inline void expect_refused(const Ended& ended, int code, const std::string& said) {
    EXPECT_EQ(ended.code, code) << "signal " << ended.signal << "\n" << ended.err;
    EXPECT_THAT(ended.err, testing::HasSubstr(said));
    EXPECT_EQ(ended.out, "");
}
inline void expect_fine(const Ended& ended) {
    EXPECT_EQ(ended.code, 0) << "signal " << ended.signal << "\n" << ended.err;
}

}  // namespace viscera::test
