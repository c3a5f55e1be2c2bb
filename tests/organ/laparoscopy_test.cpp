#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "engine/io/file_bytes.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"

// What assets/scenes/laparoscopy.json tells: a cut bleeds, the blood runs down and gathers, a hook coagulates
// along the cut, and bleeding stops there.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int tissue_size = 512;  // half the scene's own
constexpr double frames_per_s = 20.0;

class Laparoscopy : public testing::Test {
  protected:
    void SetUp() override {
        const auto file = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets/scenes/laparoscopy.json";
        scene_ = json::parse(io::read_file(file, 1U << 20U));
        scene_["resolution"] = {96, 54};
        scene_["shared"]["tissue_size"] = tissue_size;
        scene_["passes"].push_back(pass("account", "tissue.blood_account", {{"state", "blood"}}));
        stage_.load(scene_);
        stage_.renderer().keep({"tissue.blood_account", "tissue.blood_height", "tissue.position",
                                "tissue.metric", "tissue.energy", "final"});
    }
    /// Renders on to a time.
    void go_to(double time_s) {
        for (; frame_ <= std::lround(time_s * frames_per_s); ++frame_) {
            stage_.render(static_cast<double>(frame_) / frames_per_s);
        }
    }
    /// Given, and what of it lies on the surface or flies [mm^3].
    struct Account {
        double given_mm3 = 0.0;
        double kept_mm3 = 0.0;
    };
    Account account() {
        const Image picture = stage_.renderer().read("tissue.blood_account");
        Account sum;
        for (int y = 0; y < picture.height; ++y) {
            for (int x = 0; x < picture.width; ++x) {
                sum.given_mm3 += static_cast<double>(picture.at(x, y, 0));
                sum.kept_mm3 += static_cast<double>(picture.at(x, y, 1) + picture.at(x, y, 2));
            }
        }
        return sum;
    }
    std::vector<json> wounds() const {
        for (const json& pass : scene_["passes"]) {
            if (pass["effect"] == "tissue.blood") {
                return pass["parameters"]["wounds"];
            }
        }
        return {};
    }
    static glm::dvec3 place(const json& wound) {
        const json& p = wound["position_mm"];
        return {p[0], p[1], p[2]};
    }
    /// Of the texel whose place is nearest.
    float energy_at(const glm::dvec3& point) {
        const Image energy = stage_.renderer().read("tissue.energy");
        const Image position = stage_.renderer().read("tissue.position");
        double least = 1e30;
        float nearest = 0.0F;
        for (int y = 0; y < position.height; ++y) {
            for (int x = 0; x < position.width; ++x) {
                const double away = glm::distance(
                    point, glm::dvec3(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2)));
                if (position.at(x, y, 3) == 1.0F && away < least) {
                    least = away;
                    nearest = energy.at(x, y, 0);
                }
            }
        }
        return nearest;
    }
    /// Given per second by the wounds together, with the jet's pulse as its mean.
    static double rate_mm3_s(const std::vector<json>& wounds) {
        double sum = 0.0;
        for (const json& wound : wounds) {
            sum += wound["rate_mm3_s"].get<double>();
        }
        return sum;
    }
    /// Of what stands higher than a film that stays behind: volume [mm^3] and centre of mass.
    struct Lying {
        double volume_mm3 = 0.0;
        glm::dvec3 centre_mm{0.0};
        double highest_mm = 0.0;
    };
    Lying lying() {
        const Image height = stage_.renderer().read("tissue.blood_height");
        const Image position = stage_.renderer().read("tissue.position");
        const Image metric = stage_.renderer().read("tissue.metric");
        Lying sum;
        for (int y = 0; y < height.height; ++y) {
            for (int x = 0; x < height.width; ++x) {
                const double h = static_cast<double>(height.at(x, y, 0));
                if (position.at(x, y, 3) != 1.0F || h < 0.1) {
                    continue;
                }
                const double volume = h * static_cast<double>(metric.at(x, y, 3));
                sum.volume_mm3 += volume;
                sum.centre_mm +=
                    volume * glm::dvec3(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
                sum.highest_mm = std::max(sum.highest_mm, h);
            }
        }
        sum.centre_mm /= std::max(sum.volume_mm3, 1e-9);
        return sum;
    }

    json scene_;
    Stage stage_;
    long frame_ = 0;
};

TEST_F(Laparoscopy, TellsItsStory) {
    const std::vector<json> cut = wounds();
    ASSERT_GE(cut.size(), 4U);
    glm::dvec3 middle(0.0);
    for (const json& wound : cut) {
        middle += place(wound) / static_cast<double>(cut.size());
    }
    go_to(0.4);
    EXPECT_EQ(account().given_mm3, 0.0) << "nothing bleeds yet";
    const Image whole = stage_.renderer().read("final");

    go_to(3.8);
    const Account before = account();
    EXPECT_NE(stage_.renderer().read("final").data, whole.data);
    go_to(4.8);
    const double in_a_second = account().given_mm3 - before.given_mm3;
    EXPECT_NEAR(in_a_second, rate_mm3_s(cut), 0.1 * rate_mm3_s(cut)) << "the cut bleeds";
    EXPECT_GT(account().kept_mm3 - before.kept_mm3, 0.5 * in_a_second) << "onto the organ";
    for (const json& wound : cut) {
        EXPECT_EQ(energy_at(place(wound)), 0.0F) << "not burnt yet";
    }
    const Lying wet = lying();
    EXPECT_GT(wet.volume_mm3, 100.0);
    // The scene's gravity pulls along +y.
    EXPECT_GT(wet.centre_mm.y, middle.y + 3.0) << "the blood runs down";

    go_to(9.4);
    for (const json& wound : cut) {
        EXPECT_GT(energy_at(place(wound)), 0.5F) << wound.dump() << " is sealed";
    }
    const double sealed = account().kept_mm3;
    const Lying pool = lying();
    EXPECT_GT(pool.centre_mm.y, wet.centre_mm.y) << "and on";
    EXPECT_GT(pool.highest_mm, 0.8) << "it gathers";
    go_to(10.0);
    // A sealed jet's particles still fly, unseen, and count as given until they come down.
    EXPECT_LE(account().kept_mm3 - sealed, 0.01 * in_a_second) << "bleeding has stopped";
    EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front();
}

}  // namespace
}  // namespace viscera::test
