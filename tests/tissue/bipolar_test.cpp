#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "effects/tissue/held_triangles.h"
#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "tests/tissue/bake_stage.h"
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

std::vector<std::uint32_t> own_places(const MeshData& mesh) {
    std::vector<std::uint32_t> place(mesh.positions.size());
    std::iota(place.begin(), place.end(), 0U);
    return place;
}

tissue::TexelSurface texels_of(const MeshData& mesh, std::span<const std::uint32_t> place) {
    return {.positions = mesh.positions, .uvs = mesh.uvs, .indices = mesh.indices, .place = place};
}

std::size_t connecting_of(const MeshData& mesh, double max_uv_perimeter = 0.15) {
    const std::vector<std::uint32_t> place = own_places(mesh);
    return static_cast<std::size_t>(
        std::ranges::count(tissue::find_connecting(texels_of(mesh, place), max_uv_perimeter), 1));
}

/// 8 x 6 squares, whose columns lie in space and in the texture where `x_mm` and `u` say.
MeshData columns(const std::function<double(int)>& x_mm, const std::function<double(int)>& u) {
    const auto column = [](double s) { return static_cast<int>(std::lround(8.0 * s)); };
    return sheet(
        8, 6, [&](double s, double t) { return glm::dvec3(x_mm(column(s)), 6.0 * t, 0.0); },
        [&](double s, double t) { return glm::dvec2(u(column(s)), 0.1 + 0.06 * t); });
}

double even(int i) {
    return i;
}

/// Two charts of 4 and 3 columns, and a column of triangles that joins them over a gap in the texture.
MeshData bridged(double gap) {
    return columns(even, [=](int i) { return 0.1 + 0.01 * i + (i > 4 ? gap : 0.0); });
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

/// The scene's targets follow the frame's size; so do the map and the tiles that the tool's part is found by.
TEST(Bipolar, AnotherSizeOfTheTextureIsNoticed) {
    const nlohmann::json mesh{{"file", fine_plane().write("resized").string()}};
    const nlohmann::json parameters{{"mesh", mesh}};
    nlohmann::json scene = scene_of(nullptr, nlohmann::json::array(), {"tissue.energy"}, 64, 64);
    scene.erase("camera");
    scene["passes"].push_back(pass("bake", "tissue.bake", parameters));
    scene["passes"].push_back(pass("coagulate", "tissue.coagulate", parameters));
    scene["passes"].push_back(pass("bipolar", "tissue.coagulate_bipolar", parameters));
    scene["passes"][2]["parameters"]["tool"] = {{"size_mm", {4.0, 1.0, 2.0}}};
    for (const char* target : {"tissue.energy", "tissue.position"}) {
        scene["targets"][target]["scale"] = 1.0;
    }
    Image resized;
    for (const bool small_first : {true, false}) {
        Stage stage;
        stage.load(scene);
        HostValues values;
        values.set("tissue.held", vertices_near(20, 20, 6));
        values.set("tissue.tool", pose(20.0, 20.0, 0.0));
        for (const int size : {small_first ? 64 : 128, 128}) {
            Frame frame = stage.renderer().still(0.0);
            frame.width = frame.height = size;
            frame.values = &values;
            stage.renderer().render(frame);
        }
        const Image energy = stage.renderer().read("tissue.energy");
        ASSERT_EQ(energy.width, 128);
        if (small_first) {
            resized = energy;
        } else {
            EXPECT_TRUE(resized.data == energy.data);
        }
    }
}

/// Which triangles connect hangs on the file's shape, not on where a host has them when parameters change.
TEST(Bipolar, AMovedBridgeIsStillABridge) {
    BakeStage writer;
    writer.use(bridged(0.03));
    const std::string file = writer.parameters["mesh"]["file"];
    const nlohmann::json parameters{{"mesh", {{"file", file}, {"host_positions", "moved"}}}, {"size", 512}};
    nlohmann::json scene = scene_of(nullptr, nlohmann::json::array(), {"tissue.energy"}, 32, 32);
    scene.erase("camera");
    scene["passes"].push_back(pass("bake", "tissue.bake", parameters));
    scene["passes"].push_back(pass("coagulate", "tissue.coagulate", parameters));
    scene["passes"].push_back(pass("bipolar", "tissue.coagulate_bipolar", parameters));
    scene["passes"][2]["parameters"]["tool"] = {{"shape", "sphere"}, {"size_mm", {1.0, 1.0, 1000.0}}};
    Stage stage;
    stage.load(scene);
    Log log;
    const MeshData mesh = io::load_meshes(file, {}, log).front();
    std::vector<float> moved;
    std::vector<float> held;
    for (const glm::vec3& p : mesh.positions) {
        held.push_back(static_cast<float>(held.size()));
        // The gap opens, as wide as in the texture.
        moved.insert(moved.end(), {p.x > 4.5F ? p.x + 3.0F : p.x, p.y, p.z});
    }
    HostValues values;
    values.set("moved", moved);
    values.set("tissue.held", held);
    stage.render(0.0, &values);
    stage.renderer().set_parameter("bipolar", "/energy", 0.5);
    stage.render(0.1, &values);
    const Image energy = stage.renderer().read("tissue.energy");
    const auto at = [&](double u) {
        return energy.at(static_cast<int>(512 * u), static_cast<int>(512 * 0.13), 0);
    };
    EXPECT_GT(at(0.12), 0.0F);
    EXPECT_GT(at(0.20), 0.0F);
    EXPECT_EQ(at(0.16), 0.0F) << "between the charts";
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

TEST(HeldTriangles, ABridgeIsFoundHoweverNearTheChartsLie) {
    // 2.7 times the others' perimeter for its size.
    const MeshData mesh = bridged(0.03);
    const std::vector<std::uint32_t> place = own_places(mesh);
    const std::vector<char> connecting = tissue::find_connecting(texels_of(mesh, place), 0.15);
    for (std::size_t t = 0; t < connecting.size(); ++t) {
        EXPECT_EQ(connecting[t] != 0, t / 2 % 8 == 4) << t;
    }
    // Also when no two triangles share a vertex, as where each has its own normal.
    MeshData apart;
    std::vector<std::uint32_t> places;
    for (const std::uint32_t v : mesh.indices) {
        apart.indices.push_back(static_cast<std::uint32_t>(apart.indices.size()));
        apart.positions.push_back(mesh.positions[v]);
        apart.uvs.push_back(mesh.uvs[v]);
        places.push_back(v);
    }
    EXPECT_EQ(tissue::find_connecting(texels_of(apart, places), 0.15), connecting);
}

TEST(HeldTriangles, ChartsOfAnyScaleAreHeld) {
    // An organ whose texture is 6 times as dense as that of a larger one beside it.
    const MeshData large = columns(even, [](int i) { return 0.5 + 0.01 * i; });
    MeshData small = columns(even, [](int i) { return 0.1 + 0.01 * i; });
    for (glm::vec3& p : small.positions) {
        p = p / 6.0F + glm::vec3(50.0F, 0.0F, 0.0F);
    }
    EXPECT_EQ(connecting_of(together(together(large, large), small)), 0U);
    EXPECT_EQ(connecting_of(together(large, bridged(0.03))), 12U) << "the bridge alone";
}

TEST(HeldTriangles, NarrowLargeAndDenseTrianglesOfAChartAreHeld) {
    EXPECT_EQ(connecting_of(
                  columns([](int i) { return i > 4 ? i - 0.9 : i; }, [](int i) { return 0.1 + 0.01 * i; })),
              0U)
        << "a narrow row that has as much texture as others";
    EXPECT_EQ(connecting_of(columns([](int i) { return i > 4 ? i + 3.0 : i; },
                                    [](int i) { return 0.1 + 0.01 * i + (i > 4 ? 0.03 : 0.0); })),
              0U)
        << "a row of large triangles";
    EXPECT_EQ(connecting_of(columns(even, [](int i) { return 0.1 + (i > 4 ? 0.04 * i - 0.12 : 0.01 * i); })),
              0U)
        << "half of the chart with 4 times the texture";
}

TEST(HeldTriangles, NumbersBeyondTheHostsVerticesAreNone) {
    // The last vertices repeat others, as an atlas has them.
    const MeshData mesh = bridged(0.03);
    const std::vector<std::uint32_t> place = own_places(mesh);
    tissue::HeldTriangles triangles(texels_of(mesh, place), 60, 0.15);
    EXPECT_EQ(triangles.hold(std::vector<float>{59, 60, 62, 63}).useless, 3U);
    EXPECT_GT(triangles.count(), 0U);
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
    const std::vector<std::uint32_t> place = own_places(mesh);
    tissue::HeldTriangles triangles(texels_of(mesh, place), mesh.positions.size(), 0.15);
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
