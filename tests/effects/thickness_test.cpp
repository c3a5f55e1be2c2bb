#include <cmath>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"

// Walls that add up by the way of the ray, against the chords of cylinders.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int thickness_side = 96;
constexpr double height_mm = 24.0;
constexpr double radius_mm = 4.0;
constexpr double calibre_mm = 10.0;

/// Cylinders through the origin around axes in the xz plane, in one mesh with one centreline.
class Thickness : public testing::Test {
  protected:
    void add_cylinder(double angle_deg, bool inward = false) {
        constexpr int sides = 128;
        constexpr int rings = 40;
        constexpr double half_length_mm = 40.0;
        const double angle = angle_deg * std::numbers::pi / 180.0;
        const glm::dvec3 axis(std::sin(angle), 0.0, std::cos(angle));
        const glm::dvec3 right(std::cos(angle), 0.0, -std::sin(angle));
        const auto first = static_cast<int>(points_.size());
        for (int ring = 0; ring <= rings; ++ring) {
            for (int i = 0; i < sides; ++i) {
                const double turn = 2.0 * std::numbers::pi * i / sides;
                points_.push_back(half_length_mm * (2.0 * ring / rings - 1.0) * axis +
                                  radius_mm *
                                      (std::cos(turn) * right + std::sin(turn) * glm::dvec3(0, 1, 0)));
            }
        }
        for (int ring = 0; ring < rings; ++ring) {
            for (int i = 0; i < sides; ++i) {
                const int a = first + ring * sides + i;
                const int b = first + ring * sides + (i + 1) % sides;
                const std::string up = std::to_string(a) + " " + std::to_string(b + sides);
                faces_.push_back(inward ? up + " " + std::to_string(b) : std::to_string(b) + " " + up);
                faces_.push_back(inward ? std::to_string(a + sides) + " " + std::to_string(b + sides) + " " +
                                              std::to_string(a)
                                        : up + " " + std::to_string(a + sides));
            }
        }
        const auto node = static_cast<int>(nodes_.size());
        for (const double end : {-1.0, 1.0}) {
            const glm::dvec3 p = end * half_length_mm * axis;
            nodes_.push_back({p.x, p.y, p.z, radius_mm});
        }
        edges_.push_back({node, node + 1});
        inlets_.push_back({{"node", node}, {"pressure_mmhg", 90}});
        outlets_.push_back({{"node", node + 1}, {"pressure_mmhg", 10}});
    }

    /// contrast.main on the plateau, seen along +y turned by `tilt_deg` towards z.
    Image picture(double tilt_deg = 0.0, double full_calibre_mm = calibre_mm) {
        std::ofstream ply(folder_ / "cylinders.ply");
        ply << "ply\nformat ascii 1.0\nelement vertex " << points_.size()
            << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << faces_.size()
            << "\nproperty list uchar int vertex_indices\nend_header\n";
        for (const glm::dvec3& p : points_) {
            ply << p.x << " " << p.y << " " << p.z << "\n";
        }
        for (const std::string& face : faces_) {
            ply << "3 " << face << "\n";
        }
        ply.close();
        const auto line =
            folder_.write("line.json", json{{"unit", "mm"}, {"nodes", nodes_}, {"edges", edges_}}.dump());
        const double tilt = tilt_deg * std::numbers::pi / 180.0;
        const json camera{{"kind", "orthographic"},
                          {"eye_mm", {0.0, -200.0 * std::cos(tilt), -200.0 * std::sin(tilt)}},
                          {"height_mm", height_mm}};
        const json parameters{
            {"vessel",
             {{"mesh", (folder_ / "cylinders.ply").string()},
              {"centreline", line.string()},
              {"full_calibre_mm", full_calibre_mm},
              {"flow", {{"inlets", inlets_}, {"outlets", outlets_}, {"injection_speed_mm_s", 1000}}}}},
            {"bolus", {{"rise_s", 0.1}, {"duration_s", 100}}},
            {"method", "thickness"}};
        json scene = scene_of(camera, json::array({pass("main", "contrast.main", parameters)}),
                              {"contrast.main"}, thickness_side, thickness_side);
        use_floats(scene, {"contrast.main"});
        stage_.load(scene);
        Image image = stage_.shot("contrast.main", 50.0);
        EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front();
        return image;
    }

    /// Distance [mm] of a pixel from the middle, to the right or upwards.
    static double off_mm(int pixel) {
        return (pixel + 0.5 - thickness_side / 2) * height_mm / thickness_side;
    }
    static double chord(double off) {
        return 2.0 * std::sqrt(std::max(0.0, radius_mm * radius_mm - off * off));
    }

    TempFolder folder_;
    std::vector<glm::dvec3> points_;
    std::vector<std::string> faces_;
    json nodes_ = json::array();
    json edges_ = json::array();
    json inlets_ = json::array();
    json outlets_ = json::array();
    Stage stage_;
};

TEST_F(Thickness, IsTheChordOfACylinderAtAnySlant) {
    add_cylinder(0.0);
    for (const double tilt_deg : {0.0, 35.0, -60.0}) {
        const Image image = picture(tilt_deg);
        const double slant = std::cos(tilt_deg * std::numbers::pi / 180.0);
        for (int y = thickness_side / 4; y < thickness_side; y += thickness_side / 4) {
            for (int x = 0; x < thickness_side; ++x) {
                const double off = off_mm(x);
                // The polygon lies within the circle by 3e-4 of the radius, which shows most at the outline.
                const double bound = std::abs(off) < 0.95 * radius_mm ? 0.005 : 0.06;
                EXPECT_NEAR(static_cast<double>(image.at(x, y, 0)), chord(off) / slant / calibre_mm, bound)
                    << x << ", " << y << " at " << tilt_deg;
            }
        }
    }
}

TEST_F(Thickness, AddsUpWhereVesselsCross) {
    add_cylinder(0.0);
    add_cylinder(90.0);
    const Image image = picture();
    for (int y = 2; y < thickness_side; y += 7) {
        for (int x = 3; x < thickness_side; x += 7) {
            const double u = off_mm(x);
            const double v = off_mm(y);
            if (std::max(std::abs(u), std::abs(v)) < 0.95 * radius_mm) {
                EXPECT_NEAR(static_cast<double>(image.at(x, y, 0)), (chord(u) + chord(v)) / calibre_mm, 0.01);
            }
        }
    }
    EXPECT_GT(image.at(thickness_side / 2, thickness_side / 2, 0), 1.5F)
        << "more than the density of one vessel";
}

TEST_F(Thickness, DoesNotLookHowTrianglesAreWound) {
    add_cylinder(20.0);
    const Image outward = picture(10.0);
    faces_.clear();
    points_.clear();
    nodes_ = edges_ = inlets_ = outlets_ = json::array();
    add_cylinder(20.0, true);
    const Image inward = picture(10.0);
    EXPECT_NE(outward.data, inward.data) << "other triangles, other roundings";
    // Depths of 200 mm lie 1.5e-5 mm apart as floats, and each of two walls may come out as either neighbour.
    const auto bound = static_cast<float>(2.0 * 2.0 * 1.5e-5 / calibre_mm);
    for (int y = 0; y < thickness_side; ++y) {
        for (int x = 0; x < thickness_side; ++x) {
            // At the outline walls are steep, and where a triangle lies is rounded, too.
            const bool steep = outward.at(x, y, 0) < 0.1F;
            ASSERT_NEAR(outward.at(x, y, 0), inward.at(x, y, 0), steep ? 4.0F * bound : bound);
        }
    }
}

TEST_F(Thickness, StaysFiniteWhateverTheCalibre) {
    add_cylinder(0.0);
    for (const double tiny : {1e-300, 1e-5}) {
        const std::vector<float> values = to_floats(picture(0.0, tiny));
        EXPECT_TRUE(std::ranges::all_of(values, [](float v) { return v >= 0.0F && v <= 128.0F; }));
        EXPECT_EQ(std::ranges::max(values), 128.0F) << "two walls";
    }
    EXPECT_EQ(std::ranges::max(to_floats(picture(0.0, 1e300))), 0.0F);
}

TEST_F(Thickness, NeedsRadiiAndATargetOfItsOwn) {
    const auto refusal = [&](const json& changes, const char* effect) {
        json parameters = tube_parameters();
        parameters["method"] = "thickness";
        parameters["vessel"]["full_calibre_mm"] = 5;
        parameters["vessel"].update(changes);
        try {
            stage_.load(scene_of(tube_camera(), json::array({pass("vessels", effect, parameters)}),
                                 {"contrast.main"}));
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal(json::object(), "contrast.main"), "");
    EXPECT_NE(refusal(json::object(), "contrast.geometry").find("/method: only max draws several"),
              std::string::npos);
    EXPECT_NE(refusal({{"centreline", ""}}, "contrast.main").find("/method: thickness needs a centreline"),
              std::string::npos);
    EXPECT_NE(
        refusal({{"full_calibre_mm", 0}}, "contrast.main").find("/method: thickness needs a centreline"),
        std::string::npos);
}

}  // namespace
}  // namespace viscera::test
