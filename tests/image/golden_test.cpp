#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "engine/io/exr.h"
#include "tests/image/golden_case.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, EveryTargetIsAsStored) {
    const GoldenCase golden = load_case(case_folder(GetParam()));
    Stage stage;
    if (std::getenv("VISCERA_UPDATE_IMAGES") != nullptr) {
        update(golden, stage);
        GTEST_SKIP() << "written anew: look at the pictures before you keep them";
    }
    const std::vector<Finding> findings = check(golden, stage);
    EXPECT_TRUE(findings.empty()) << "first deviates " << to_string(findings.front()) << "\n("
                                  << findings.size() << " in all)";
    for (const std::string& complaint : stage.complaints()) {
        // The coronaries' catheter lies upstream of the injection; bakes are small.
        const bool known = complaint.find("no contrast") != std::string::npos ||
                           complaint.find("gutters are narrower") != std::string::npos;
        EXPECT_TRUE(known) << complaint;
    }
}

INSTANTIATE_TEST_SUITE_P(Cases, Golden, testing::ValuesIn(case_names()),
                         [](const auto& info) { return info.param; });

/// The images of a case, to be spoilt.
class WrongImages : public testing::Test {
  protected:
    WrongImages() : golden_(load_case(case_folder("per_vertex"))) {
        for (const auto& entry : std::filesystem::directory_iterator(golden_.folder)) {
            if (entry.path().extension() == ".exr") {
                std::filesystem::copy(entry.path(), folder_.path());
            }
        }
        golden_.folder = folder_.path();
    }
    template <class Change>
    void change(const std::string& target, Change&& change) {
        const std::filesystem::path file = golden_.file(0, target);
        std::vector<io::ExrPart> parts = io::read_exr(file);
        change(parts.front().image);
        io::write_exr(file, parts);
    }
    /// Expects one finding about a target.
    void expect(const std::string& pass, const std::string& target) {
        const std::vector<Finding> findings = check(golden_, stage_);
        ASSERT_EQ(findings.size(), 1U);
        EXPECT_EQ(findings.front().pass, pass);
        EXPECT_EQ(findings.front().target, target);
        EXPECT_FALSE(findings.front().what.empty());
    }

    TempFolder folder_;
    GoldenCase golden_;
    Stage stage_;
};

TEST_F(WrongImages, TheCopyItselfPasses) {
    EXPECT_TRUE(check(golden_, stage_).empty());
}

TEST_F(WrongImages, AMissingImageFails) {
    std::filesystem::remove(golden_.file(0, "contrast.main"));
    expect("vessels", "contrast.main");
}

TEST_F(WrongImages, ASurplusImageFails) {
    std::filesystem::copy(golden_.file(0, "contrast.main"), golden_.file(7, "contrast.main"));
    expect("", "7.contrast.main.exr");
}

TEST_F(WrongImages, OneWrongPixelFails) {
    change("contrast.main", [](Image& image) { image.set(64, 64, 0, image.at(64, 64, 0) + 0.01F); });
    expect("vessels", "contrast.main");
}

TEST_F(WrongImages, ASmallShiftOfTheWholePictureFails) {
    change("final", [](Image& image) {
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                image.set(x, y, 0, image.at(x, y, 0) * 1.0015F);
            }
        }
    });
    expect("composite", "final");
}

TEST_F(WrongImages, NanAndInfinityFail) {
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        change("final", [&](Image& image) { image.set(3, 3, 0, value); });
        expect("composite", "final");
    }
}

TEST_F(WrongImages, AnotherSizeFails) {
    change("final", [](Image& image) { image = make_image(image.width / 2, image.height, image.format); });
    expect("composite", "final");
}

TEST_F(WrongImages, TheFirstPassIsNamedFirst) {
    change("final", [](Image& image) { image.set(0, 0, 0, 0.0F); });
    change("contrast.main", [](Image& image) { image.set(0, 0, 0, 1.0F); });
    const std::vector<Finding> findings = check(golden_, stage_);
    ASSERT_EQ(findings.size(), 2U);
    EXPECT_EQ(findings[0].pass, "vessels");
    EXPECT_EQ(findings[1].pass, "composite");
}

TEST(Expectations, LimitsNeedAReasonAndKnownKeys) {
    const TempFolder folder;
    const auto limits = [](const std::string& reason) {
        return R"({"max": 0.1, "mean": 0.1, "fraction": 0, "reason": ")" + reason + "\"}";
    };
    (void)folder.write("expect.json", R"({"times_s": [1], "limits": )" + limits("because") + "}");
    EXPECT_EQ(load_case(folder.path()).limits.reason, "because");
    (void)folder.write("expect.json", R"({"times_s": [1], "limits": )" + limits("") + "}");
    EXPECT_THROW((void)load_case(folder.path()), std::runtime_error);
    (void)folder.write("expect.json", R"({"times_s": [1], "limit": 3, "limits": )" + limits("because") + "}");
    EXPECT_THROW((void)load_case(folder.path()), std::runtime_error);
    (void)folder.write("expect.json", R"({"times_s": [], "limits": )" + limits("because") + "}");
    EXPECT_THROW((void)load_case(folder.path()), std::runtime_error);
}

}  // namespace
}  // namespace viscera::test
