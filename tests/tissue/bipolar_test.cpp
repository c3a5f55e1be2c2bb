#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "effects/tissue/held_triangles.h"
#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "tests/tissue/energy_stage.h"

namespace viscera::test {
namespace {

/// A pose in the plane: x axis turned by `degrees`, centre at (x, y).
std::vector<float> pose(double x, double y, double degrees, double z = 0.0) {
    const double a = degrees * std::numbers::pi / 180.0;
    const std::vector<double> m{std::cos(a), std::sin(a), 0, 0, -std::sin(a), std::cos(a), 0, 0, 0, 0, 1, 0,
                                x,           y,           z, 1};
    return {m.begin(), m.end()};
}

/// Whose triangles are small enough in the texture to be held.
Plane fine_plane(bool seam = false) {
    Plane plane;
    plane.cells = 32;
    plane.seam = seam;
    return plane;
}

class BipolarStage {
  public:
    explicit BipolarStage(const nlohmann::json& tool, const Plane& plane = fine_plane(),
                          const std::string& name = "bipolar") {
        const nlohmann::json mesh{{"file", plane.write(name).string()}};
        nlohmann::json scene =
            scene_of(nullptr, nlohmann::json::array(), {"tissue.energy", "tissue.position"}, 32, 32);
        scene.erase("camera");
        scene["passes"].push_back(pass("bake", "tissue.bake", {{"mesh", mesh}, {"size", 128}}));
        scene["passes"].push_back(pass("coagulate", "tissue.coagulate", {{"mesh", mesh}, {"size", 128}}));
        scene["passes"].push_back(
            pass("bipolar", "tissue.coagulate_bipolar", {{"mesh", mesh}, {"size", 128}, {"tool", tool}}));
        stage.load(scene);
    }
    PassReport frame(double time_s) { return pass_of(stage.render(time_s, &values), "bipolar"); }

    /// Compares every texel inside charts with a rule for its place.
    template <class Rule>
    void expect(Rule rule) {
        const Image places = stage.renderer().read("tissue.position");
        const Image energies = stage.renderer().read("tissue.energy");
        std::size_t burnt = 0;
        for (int y = 0; y < 128; ++y) {
            for (int x = 0; x < 128; ++x) {
                if (places.at(x, y, 3) == 0.0F) {
                    EXPECT_EQ(energies.at(x, y, 0), 0.0F);
                    continue;
                }
                const glm::dvec3 p(places.at(x, y, 0), places.at(x, y, 1), places.at(x, y, 2));
                const int expected = rule(p);  // 1, 0, or -1: too close to tell
                if (expected >= 0) {
                    ASSERT_EQ(energies.at(x, y, 0), static_cast<float>(expected)) << p.x << "," << p.y;
                    burnt += expected == 1 ? 1 : 0;
                }
            }
        }
        EXPECT_GT(burnt, 20U);
    }

    Stage stage;
    HostValues values;
};

/// Vertices of that plane (32 x 32 squares of 1.25 mm) around (x, y): its numbers run row by row.
std::vector<float> vertices_near(double x, double y, int reach, int row = 33) {
    std::vector<float> numbers;
    const int i = static_cast<int>(std::lround(x / 1.25));
    const int j = static_cast<int>(std::lround(y / 1.25));
    for (int v = j - reach; v <= j + reach; ++v) {
        for (int u = i - reach; u <= i + reach; ++u) {
            numbers.push_back(static_cast<float>(v * row + u));
        }
    }
    return numbers;
}

int inside_or_close(double distance) {
    return std::abs(distance) < 1e-4 ? -1 : (distance < 0.0 ? 1 : 0);
}

TEST(Bipolar, EachShapeBurnsWhatLiesWithinIt) {
    constexpr double angle = 30.0;
    const double c = std::cos(angle * std::numbers::pi / 180.0);
    const double s = std::sin(angle * std::numbers::pi / 180.0);
    for (const std::string shape : {"capsule", "box", "sphere", "cylinder"}) {
        BipolarStage stage(nlohmann::json{{"shape", shape}, {"size_mm", {7.0, 5.0, 2.5}}});
        stage.values.set("tissue.held", vertices_near(20, 20, 8));
        stage.values.set("tissue.tool", pose(20.0, 20.0, angle, 0.5));
        stage.frame(0.0);
        const PassReport report = stage.frame(0.1);
        EXPECT_EQ(report.status, PassStatus::reduced);
        EXPECT_EQ(report.reason, "only what the tool holds");
        stage.expect([&](const glm::dvec3& p) {
            const glm::dvec3 q(c * (p.x - 20) + s * (p.y - 20), -s * (p.x - 20) + c * (p.y - 20), p.z - 0.5);
            const double beyond = std::max(std::abs(q.x) - 3.5, 0.0);
            const double off_axis = std::hypot(q.y, q.z);
            const double distance =
                shape == "capsule" ? std::hypot(beyond, off_axis) - 2.5
                : shape == "box" ? std::max({std::abs(q.x) - 3.5, std::abs(q.y) - 2.5, std::abs(q.z) - 1.25})
                : shape == "sphere" ? glm::length(q) - 2.5
                                    : std::max(std::abs(q.x) - 3.5, off_axis - 2.5);
            return inside_or_close(distance);
        });
    }
}

TEST(Bipolar, OnlyTrianglesThatTouchAHeldVertexAreBurnt) {
    BipolarStage stage(nlohmann::json{{"shape", "sphere"}, {"size_mm", {1.0, 1.0, 30.0}}});
    stage.values.set("tissue.held", vertices_near(20, 20, 0));
    stage.values.set("tissue.tool", pose(20.0, 20.0, 0.0));
    stage.frame(0.0);
    // Six triangles: the square around the vertex but for two corners, as its diagonals run.
    stage.expect([](const glm::dvec3& p) {
        const double x = (p.x - 20.0) / 1.25;
        const double y = (p.y - 20.0) / 1.25;
        return inside_or_close(std::max({std::abs(x), std::abs(y), std::abs(x - y)}) - 1.0);
    });
}

TEST(Bipolar, BurntTissueStaysAndWhatIsHeldIsDrawnOnly) {
    BipolarStage stage(nlohmann::json{{"size_mm", {4.0, 1.0, 2.0}}});
    EXPECT_EQ(stage.frame(0.0).reason, "nothing is held");
    stage.values.set("tissue.held", vertices_near(20, 20, 6));
    stage.values.set("tissue.tool", pose(20.0, 20.0, 0.0));
    stage.frame(0.1);
    const Image once = stage.stage.renderer().read("tissue.energy");
    stage.values.set("tissue.held", std::vector<float>{});
    EXPECT_EQ(stage.frame(0.2).status, PassStatus::idle);
    EXPECT_TRUE(stage.stage.renderer().read("tissue.energy").data == once.data);
    stage.values.set("tissue.held", vertices_near(20, 20, 6));
    stage.values.set("tissue.tool", pose(20.0, 20.0, 0.0, 40.0));
    EXPECT_EQ(stage.frame(0.3).reason, "what is held lies outside the tool");
    EXPECT_TRUE(stage.stage.renderer().read("tissue.energy").data == once.data);
}

TEST(Bipolar, GoesAcrossASeamWithItsGutters) {
    const Plane plane = fine_plane(true);
    BipolarStage stage(nlohmann::json{{"size_mm", {9.0, 1.0, 2.0}}}, plane, "bipolar_seam");
    stage.values.set("tissue.tool", pose(20.0, 20.0, 0.0));
    std::vector<float> held;
    Log log;
    const std::vector<MeshData> meshes = io::load_meshes(plane.write("bipolar_seam"), {}, log);
    // Those on one side of the seam suffice where others lie at the same places.
    for (std::size_t v = 0; v < meshes[0].positions.size(); ++v) {
        const glm::vec3& p = meshes[0].positions[v];
        if (std::abs(p.x - 20.0F) < 8.0F && std::abs(p.y - 20.0F) < 6.0F) {
            held.push_back(static_cast<float>(v));
        }
    }
    stage.values.set("tissue.held", held);
    stage.frame(0.0);
    stage.expect([](const glm::dvec3& p) {
        return inside_or_close(std::hypot(std::max(std::abs(p.x - 20) - 4.5, 0.0), p.y - 20) - 2.0);
    });
}

TEST(Bipolar, BadInputIsSaidAndHarmless) {
    BipolarStage stage(nlohmann::json{{"size_mm", {4.0, 1.0, 2.0}}});
    const float nan = std::nanf("");
    stage.values.set("tissue.held", std::vector<float>{nan, -1, 1e9F, 3.5F});
    EXPECT_EQ(stage.frame(0.0).reason, "no triangle is held");
    stage.values.set("tissue.held", vertices_near(20, 20, 1));
    stage.values.set("tissue.tool", std::vector<float>(16, nan));
    EXPECT_EQ(stage.frame(0.1).reason, "the tool is nowhere");
    stage.values.set("tissue.tool", std::vector<float>(16, 0.0F));
    EXPECT_EQ(stage.frame(0.2).reason, "the tool is nowhere");
    stage.values.set("tissue.tool", std::vector<float>(3, 0.0F));
    EXPECT_EQ(stage.frame(0.3).reason, "the tool is nowhere");
    EXPECT_EQ(stage.stage.complaints().size(), 3U) << "each once";
}

TEST(Bipolar, HoldingACoarseMeshSaysWhichParameterKeepsItFromBurning) {
    Plane plane;
    plane.cells = 8;  // squares of an eighth of the plane, which covers 0.875 of the texture
    BipolarStage coarse(nlohmann::json{{"size_mm", {4.0, 1.0, 2.0}}}, plane, "bipolar_coarse");
    coarse.values.set("tissue.held", std::vector<float>{40});
    coarse.values.set("tissue.tool", pose(20.0, 20.0, 0.0));
    for (const double time_s : {0.0, 0.1}) {
        EXPECT_EQ(coarse.frame(time_s).reason, "all triangles that are held connect parts of the texture");
    }
    ASSERT_EQ(coarse.stage.complaints().size(), 1U);
    const std::string& said = coarse.stage.complaints().front();
    EXPECT_NE(said.find("'max_uv_perimeter' is 0.15"), std::string::npos) << said;
    // The number that is said is the one to give.
    const double shortest = std::stod(said.substr(said.find("perimeter of ") + 13));
    EXPECT_NEAR(shortest, 0.875 * (2.0 + std::numbers::sqrt2) / 8.0, 0.002) << said;
    const auto& faults = coarse.stage.renderer().log().faults();
    EXPECT_EQ(faults.at("tissue.held_connect"), 12U) << "six triangles in two frames";
}

TEST(HeldTriangles, ConnectingTrianglesAreNotHeld) {
    // Two charts, each a strip of squares, far apart in the texture, and a triangle that joins them; and one
    // that is merely long.
    MeshData mesh;
    for (int strip = 0; strip < 2; ++strip) {
        for (int i = 0; i <= 6; ++i) {
            for (int j = 0; j < 2; ++j) {
                mesh.positions.emplace_back(i, j + strip, 0);
                mesh.uvs.emplace_back(0.01F * static_cast<float>(i),
                                      0.01F * static_cast<float>(j) + 0.05F * static_cast<float>(strip));
            }
        }
        for (std::uint32_t i = 0; i < 6; ++i) {
            const std::uint32_t v = static_cast<std::uint32_t>(strip) * 14 + 2 * i;
            mesh.indices.insert(mesh.indices.end(), {v, v + 2, v + 1, v + 1, v + 2, v + 3});
        }
    }
    const auto bridge = static_cast<std::uint32_t>(mesh.triangle_count());
    mesh.indices.insert(mesh.indices.end(), {1, 3, 14});
    mesh.positions.emplace_back(0, 0.5, 0);
    mesh.uvs.emplace_back(0.9F, 0.9F);
    const std::uint32_t distant = bridge + 1;
    mesh.indices.insert(mesh.indices.end(), {0, 2, 28});
    std::vector<std::uint32_t> place(mesh.positions.size());
    std::iota(place.begin(), place.end(), 0U);
    tissue::HeldTriangles triangles(mesh, place, 0.15);
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        EXPECT_EQ(triangles.connecting()[t] != 0, t == bridge || t == distant) << t;
    }
    EXPECT_EQ(triangles.hold(std::vector<float>{1, 0}).useless, 0U);
    EXPECT_EQ(triangles.count(), 2U);
    EXPECT_EQ(triangles.held()[bridge], 0);
    EXPECT_EQ(triangles.hold(std::vector<float>{500}).useless, 1U);
    EXPECT_EQ(triangles.count(), 0U);
    // The lone vertex has one triangle, which connects.
    const tissue::HoldResult lone = triangles.hold(std::vector<float>{28});
    EXPECT_EQ(lone.connecting, 1U);
    EXPECT_GT(lone.shortest_uv_perimeter, 2.0F);
}

}  // namespace
}  // namespace viscera::test
