#include <cmath>
#include <fstream>
#include <limits>

#include "tests/core/not_finite.h"
#include "tests/stress/stage.h"
#include "tests/tissue/plane.h"

namespace viscera::test {
namespace {

using nlohmann::json;

/// Energy on a plane of 40 mm; every target of each frame must be finite.
class DegenerateEnergy : public Stage {
  protected:
    static json scene(const std::filesystem::path& file, double mm_per_unit = 1.0) {
        const json mesh{{"file", file.string()}, {"mm_per_unit", mm_per_unit}};
        json scene{{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.energy"}}};
        scene["passes"] = {
            {{"name", "bake"}, {"effect", "tissue.bake"}, {"parameters", {{"mesh", mesh}, {"size", 64}}}},
            {{"name", "coagulate"},
             {"effect", "tissue.coagulate"},
             {"parameters", {{"mesh", mesh}, {"size", 64}}}},
            {{"name", "bipolar"},
             {"effect", "tissue.coagulate_bipolar"},
             {"parameters", {{"mesh", mesh}, {"size", 64}}}}};
        return scene;
    }
    Image frame(double time_s, const std::vector<float>& contacts) {
        values_.set("tissue.contacts", contacts);
        Frame frame = renderer().still(time_s);
        frame.values = &values_;
        return render(frame).at("tissue.energy");
    }
    static float lowest(const Image& image) {
        float least = 0.0F;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                least = std::min(least, image.at(x, y, 0));
            }
        }
        return least;
    }
    HostValues values_;
};

TEST_F(DegenerateEnergy, ContactsThatAreNone) {
    load(scene(Plane().write("stress")));
    frame(0.0, {});
    const Image image =
        frame(0.1, {nan_float,      20, 0,  1,  2, 0, 20, 20, 0,  nan_float, 2, 0, 20, 20,        0,  1,
                    infinity_float, 0,  20, 20, 0, 1, 2,  9,  20, 20,        0, 1, 2,  nan_float, 20, 20,
                    infinity_float, 1,  2,  0,  1, 2});
    EXPECT_EQ(largest(image), 0.0F);
    expect_said_once("tissue.contact", "left out");
    EXPECT_GT(largest(frame(0.2, {20, 20, 0, 1, 2, 0})), 0.05F) << "and the next one counts";
}

TEST_F(DegenerateEnergy, PowersWidthsAndTimesOfAnySize) {
    load(scene(Plane().write("stress")));
    frame(0.0, {});
    double time = 0.0;
    for (const float power : {1e-38F, 1e-6F, 1.0F, 1e20F, 3e38F}) {
        for (const float sigma : {0.0F, 1e-30F, 1e-6F, 2.0F, 1e6F, 1e30F}) {
            for (const float action : {0.0F, 1.0F, 2.0F}) {
                time += power > 1.0F ? 1e6 : 1e-3;
                const Image image = frame(
                    time, {20, 20, 0, power, sigma, action, 1e30F, -1e30F, 1e30F, power, sigma, action});
                EXPECT_LE(largest(image), 60000.0F);
                EXPECT_GE(lowest(image), -60000.0F);
            }
        }
    }
    expect_said_once("tissue.contact", "of no width");
    expect_said_once("tissue.long_frame", "more than 10 s");
    const Image before = frame(time, {20, 20, 0, 1, 2, 0});
    expect_same(frame(time, {20, 20, 0, 5, 9, 1}), before, "no time, no change");
    EXPECT_GT(largest(frame(1e15, {20, 20, 0, 1, 2, 0})), 100.0F) << "a dose of 30 million years";
    EXPECT_EQ(largest(frame(0.0, {20, 20, 0, 1, 2, 0})), 0.0F) << "back to the beginning";
}

TEST_F(DegenerateEnergy, PlacesAndLimitsThatAreNone) {
    load(scene(Plane().write("stress")));
    frame(0.0, {});
    double time = 0.0;
    float most = 0.0F;
    const auto expect_burnt = [&](const char* what) {
        const float now = largest(frame(time += 0.01, {20, 20, 0, 1, 2, 0}));
        EXPECT_GT(now, most) << what;
        most = now;
    };
    for (const std::vector<float>& from :
         {std::vector<float>{nan_float, 20, 0}, {20, infinity_float, 0}, {20, 20}, {20, 20, 0, 20, 20, 0}}) {
        values_.set("tissue.contacts_from", from);
        expect_burnt("from");
    }
    expect_said_once("tissue.contacts_from", "3 finite numbers");
    values_.erase("tissue.contacts_from");
    for (const std::vector<float>& limit : {std::vector<float>{20, 20, 0, nan_float},
                                            {20, 20, 0, -1},
                                            {infinity_float, 20, 0, 5},
                                            {20, 20, 0}}) {
        values_.set("tissue.limit_to", limit);
        expect_burnt("limit");
    }
    expect_said_once("tissue.limit_to", "4 finite numbers");
}

TEST_F(DegenerateEnergy, TenThousandContacts) {
    load(scene(Plane().write("stress")));
    frame(0.0, {});
    std::vector<float> contacts;
    for (int i = 0; i < 10000; ++i) {
        contacts.insert(contacts.end(), {0.4F * static_cast<float>(i % 100),
                                         0.4F * static_cast<float>(i / 100), 0.0F, 0.5F, 0.3F, 0.0F});
    }
    const Image image = frame(0.5, contacts);
    EXPECT_NEAR(largest(image), 0.25F, 1e-5F) << "cut off at what one of them gives";
    std::vector<float> many(std::size_t{6} * 60003, 1.0F);
    for (std::size_t i = 5; i < many.size(); i += 6) {
        many[i] = 0.0F;
        many[i - 5] = -500.0F;  // far away: only their number matters
    }
    EXPECT_EQ(largest(frame(0.6, many)), largest(image)) << "what was burnt is still there";
    expect_said_once("tissue.contact", "60,000");
}

TEST_F(DegenerateEnergy, OrgansOfAnySize) {
    for (const double scale : {1e-3, 1e4}) {
        load(scene(Plane().write("stress"), scale));
        frame(0.0, {});
        const auto at = static_cast<float>(20.0 * scale);
        const Image image = frame(0.25, {at, at, 0, 2.0F, static_cast<float>(3.0 * scale), 0});
        EXPECT_NEAR(largest(image), 0.5F, 0.01F) << scale;
    }
}

TEST_F(DegenerateEnergy, ChartsThatOverlapAndTrianglesWithoutArea) {
    const auto file = folder().path() / "overlap.obj";
    std::ofstream(file)
        << "v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 9\nv 20 0 9\nv 20 20 9\nv 0 20 9\n"
           "vt 0.1 0.1\nvt 0.9 0.1\nvt 0.9 0.9\nvt 0.1 0.9\nvt 0.5 0.5\n"
           "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 5/2 6/1 7/4\nf 5/2 7/4 8/3\nf 1/5 2/5 3/5\nf 1/1 1/1 2/2\n";
    json overlapping = scene(file);
    for (json& pass : overlapping["passes"]) {
        pass["parameters"]["mesh"]["atlas"] = "file";
    }
    load(overlapping);
    frame(0.0, {});
    values_.set("tissue.held", std::vector<float>{0, 4});
    EXPECT_GT(largest(frame(0.25, {10, 10, 0, 2, 3, 0})), 0.4F) << "whichever has the texels";
}

}  // namespace
}  // namespace viscera::test
