#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/core/image_compare.h"
#include "tests/effects/stage.h"

// Golden images: scenes whose every target is stored, so that a change of any pass is seen, and the first
// pass that deviates is named.
//
// A case is a folder with scene.json (an ordinary scene), expect.json, and one file per frame and target,
// FRAME.TARGET.exr. expect.json holds
//
//     "times_s": [0.6, 1.8],                                  one frame each, by number
//     "limits":  {"max": M, "mean": M, "fraction": F, "reason": "why not 0"},
//     "targets": {"contrast.main": {like limits}}             where they differ; optional
//
// After a change that is meant, and only after looking at the pictures, one command writes all files anew:
//
//     VISCERA_UPDATE_IMAGES=1 build/tests/test_image --gtest_filter='*Golden*'
namespace viscera::test {

struct Limits {
    CompareLimits values;
    std::string reason;
};

struct GoldenCase {
    std::string name;
    std::filesystem::path scene;   ///< file
    std::filesystem::path folder;  ///< of expect.json and the images
    std::vector<double> times_s;
    Limits limits;
    std::map<std::string, Limits> targets;

    [[nodiscard]] const Limits& limits_of(const std::string& target) const;
    [[nodiscard]] std::filesystem::path file(std::size_t frame, const std::string& target) const;
};

/// Something wrong with a case, in the order in which the passes ran.
struct Finding {
    std::size_t frame = 0;
    std::string pass;    ///< that wrote the target; empty for a surplus file
    std::string target;  ///< or the surplus file
    std::string what;
};
[[nodiscard]] std::string to_string(const Finding& finding);

/// Reads a case. Throws std::runtime_error for an expect.json that is damaged, has unknown keys, or gives
/// limits without a reason.
[[nodiscard]] GoldenCase load_case(const std::filesystem::path& folder);
/// Folders beside this file that hold a scene.json, by name.
[[nodiscard]] std::vector<std::string> case_names();
[[nodiscard]] std::filesystem::path case_folder(const std::string& name);

/// Renders a case and compares every target with its file. The first finding names the pass to blame.
[[nodiscard]] std::vector<Finding> check(const GoldenCase& golden, Stage& stage);
/// Renders a case and replaces its files.
void update(const GoldenCase& golden, Stage& stage);

}  // namespace viscera::test
