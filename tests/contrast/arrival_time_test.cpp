#include "effects/contrast/arrival_time.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "effects/contrast/density.h"
#include "effects/contrast/tube_tree.h"

namespace viscera::contrast {
namespace {

CentrelineGraph line_along_z(int edges, double length, double radius) {
    CentrelineGraph graph;
    for (int i = 0; i <= edges; ++i) {
        graph.nodes.push_back({{0.0, 0.0, length * i / edges}, radius});
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(edges); ++i) {
        graph.edges.push_back({i, i + 1});
    }
    return graph;
}

TEST(VertexArrival, IsLinearAlongATube) {
    const CentrelineGraph graph = line_along_z(7, 100.0, 4.0);
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100}}, .injection_speed_mm_s = 50}, {}, log);
    std::vector<glm::vec3> wall;
    std::vector<double> expected;
    for (int i = 0; i <= 300; ++i) {
        const float z = static_cast<float>(i) / 3.0F;
        wall.emplace_back(4.0F * std::cos(z), 4.0F * std::sin(z), z);
        expected.push_back(static_cast<double>(z) / 50.0);
    }
    const std::vector<float> arrival = vertex_arrival(graph, network, vertex_feet(graph, wall), log);
    for (std::size_t i = 0; i < wall.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(arrival[i]), expected[i], 2e-7);
    }
}

// A radius that wobbles must not move the foot: the wobble picks an edge, plain distance finds the foot.
TEST(VertexArrival, NoisyRadiiDoNotMoveTheFoot) {
    CentrelineGraph graph = line_along_z(400, 100.0, 5.0);
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100}}, .injection_speed_mm_s = 50}, {}, log);
    std::mt19937 random(5);
    std::normal_distribution<double> wobble(0.0, 0.1);
    for (CentrelineGraph::Node& node : graph.nodes) {
        node.radius_mm += wobble(random);
    }
    std::vector<glm::vec3> wall;
    for (int i = 10; i <= 290; ++i) {
        wall.emplace_back(5.0F, 0.0F, static_cast<float>(i) / 3.0F);
    }
    const std::vector<float> arrival = vertex_arrival(graph, network, vertex_feet(graph, wall), log);
    for (std::size_t i = 0; i < wall.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(arrival[i]), static_cast<double>(wall[i].z) / 50.0, 1e-6);
    }
}

// A thin vessel runs along a wide one, nearer to the wide one's wall than the wide one's axis is.
TEST(VertexArrival, ThinNeighbourDoesNotCaptureTheWideVessel) {
    CentrelineGraph graph = line_along_z(10, 100.0, 10.0);
    graph.nodes.push_back({{12.0, 0.0, 0.0}, 0.5});
    graph.nodes.push_back({{12.0, 0.0, 100.0}, 0.5});
    graph.edges.push_back({11, 12});
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100}}, .outlets = {{10, 0}}, .injection_speed_mm_s = 50}, {}, log);
    const std::vector<glm::vec3> points{{10.0F, 0.0F, 50.0F}, {11.5F, 0.0F, 50.0F}, {12.4F, 0.0F, 50.0F}};
    const std::vector<float> arrival = vertex_arrival(graph, network, vertex_feet(graph, points), log);
    EXPECT_NEAR(static_cast<double>(arrival[0]), 1.0, 1e-6);
    EXPECT_EQ(arrival[1], unreached_s);
    EXPECT_EQ(arrival[2], unreached_s);
    EXPECT_EQ(log.faults().at("contrast.unreached_vertices"), 2U);
}

TEST(VertexArrival, BadInputIsUnreached) {
    Log log;
    const std::vector<glm::vec3> points{{0, 0, 0},
                                        {std::numeric_limits<float>::quiet_NaN(), 0, 0},
                                        {std::numeric_limits<float>::infinity(), 0, 0}};
    const CentrelineGraph none;
    const FlowNetwork nothing = solve_flow(none, {}, {}, log);
    for (const float tau : vertex_arrival(none, nothing, vertex_feet(none, points), log)) {
        EXPECT_EQ(tau, unreached_s);
    }
    const CentrelineGraph graph = line_along_z(3, 10.0, 1.0);
    const FlowNetwork network = solve_flow(graph, {.inlets = {{0, 100}}}, {}, log);
    const std::vector<float> arrival = vertex_arrival(graph, network, vertex_feet(graph, points), log);
    EXPECT_EQ(arrival, (std::vector<float>{0.0F, unreached_s, unreached_s}));
    EXPECT_TRUE(vertex_arrival(graph, network, {}, log).empty());
}

// A strip of two rows whose times grow along it.
struct Strip {
    std::vector<glm::vec3> positions;
    std::vector<float> arrival;
    std::vector<std::uint32_t> indices;
};
Strip make_strip() {
    Strip strip;
    for (std::uint32_t i = 0; i < 20; ++i) {
        const auto at = static_cast<float>(i);
        strip.positions.insert(strip.positions.end(), {{at, 0.0F, 0.0F}, {at, 1.0F, 0.0F}});
        strip.arrival.insert(strip.arrival.end(), {at, at});
        if (i > 0) {
            const std::uint32_t v = 2 * i;
            strip.indices.insert(strip.indices.end(), {v - 2, v, v - 1, v, v + 1, v - 1});
        }
    }
    strip.arrival[20] += 8.0F;                            // one wild vertex
    strip.arrival[38] = strip.arrival[39] = unreached_s;  // and an end that nothing reaches
    return strip;
}

TEST(SmoothArrival, KeepsAGradientAndEvensOutAJump) {
    const Strip strip = make_strip();
    std::vector<float> smooth = strip.arrival;
    smooth_arrival(smooth, strip.positions, strip.indices, 0);
    EXPECT_EQ(smooth, strip.arrival);
    smooth_arrival(smooth, strip.positions, strip.indices, 2);
    EXPECT_LT(smooth[20], 14.0F);
    EXPECT_NEAR(static_cast<double>(smooth[30]), 15.0, 0.35);
    EXPECT_EQ(smooth[38], unreached_s);
    EXPECT_LE(*std::max_element(smooth.begin(), smooth.begin() + 38), 18.0F);
    const std::vector<std::uint32_t> lying{0, 1, 999};
    smooth_arrival(smooth, strip.positions, lying, 1);
}

// Flat-shaded meshes have three vertices of their own for each triangle: the front must not follow its edges.
TEST(SmoothArrival, TrianglesWithVerticesOfTheirOwnAreAsSmooth) {
    const Strip strip = make_strip();
    std::vector<float> whole = strip.arrival;
    smooth_arrival(whole, strip.positions, strip.indices, 3);
    Strip apart;
    for (const std::uint32_t v : strip.indices) {
        apart.indices.push_back(static_cast<std::uint32_t>(apart.indices.size()));
        apart.positions.push_back(strip.positions[v]);
        apart.arrival.push_back(strip.arrival[v]);
    }
    smooth_arrival(apart.arrival, apart.positions, apart.indices, 3);
    for (std::size_t i = 0; i < strip.indices.size(); ++i) {
        EXPECT_EQ(apart.arrival[i], whole[strip.indices[i]]) << "corner " << i;
    }
}

TEST(TubeTree, FindsWhatATryOfEveryEdgeFinds) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-50.0, 50.0);
    std::uniform_real_distribution<double> radius(0.1, 9.0);
    CentrelineGraph graph;
    for (std::uint32_t n = 0; n < 600; ++n) {
        graph.nodes.push_back({{place(random), place(random), place(random)}, radius(random)});
        graph.edges.push_back({n, static_cast<std::uint32_t>(random() % (n + 1))});
    }
    const TubeTree tree(graph);
    std::optional<std::size_t> guess;
    for (int trial = 0; trial < 2000; ++trial) {
        const glm::dvec3 p(place(random), place(random), place(random));
        double best = std::numeric_limits<double>::infinity();
        for (const CentrelineGraph::Edge& e : graph.edges) {
            const auto& [a, ra] = graph.nodes[e.a];
            const auto& [b, rb] = graph.nodes[e.b];
            if (e.a == e.b) {
                continue;
            }
            const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
            best = std::min(best, glm::distance(p, a + t * (b - a)) - std::lerp(ra, rb, t));
        }
        const auto foot = tree.nearest_wall(p, guess);
        ASSERT_TRUE(foot.has_value());
        ASSERT_NEAR(foot->wall_mm, best, 1e-10);
        guess = foot->edge;
    }
}

TEST(VertexArrival, IsFastEnoughToBeDoneAtLoad) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> turn(-0.5, 0.5);
    CentrelineGraph graph;
    graph.nodes.push_back({{0, 0, 0}, 3.0});
    glm::dvec3 heading(0, 0, 1);
    for (std::uint32_t n = 1; n <= 1000; ++n) {
        heading = glm::normalize(heading + glm::dvec3(turn(random), turn(random), turn(random)));
        graph.nodes.push_back({graph.nodes[n - 1].position_mm + 2.0 * heading, 3.0});
        graph.edges.push_back({n - 1, n});
    }
    std::vector<glm::vec3> points;
    for (int i = 0; i < 100000; ++i) {
        const auto& node = graph.nodes[static_cast<std::size_t>(i) / 100];
        points.emplace_back(node.position_mm + 3.0 * glm::dvec3(std::cos(i), std::sin(i), turn(random)));
    }
    Log log;
    const FlowNetwork network = solve_flow(graph, {.inlets = {{0, 100}}}, {}, log);
    const std::clock_t start = std::clock();  // CPU time: other processes do not count
    const std::vector<float> arrival = vertex_arrival(graph, network, vertex_feet(graph, points), log);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    RecordProperty("seconds", std::to_string(seconds));
    std::printf("100,000 vertices x 1,000 edges: %.0f ms\n", 1e3 * seconds);
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__)
    EXPECT_LT(seconds, 0.3);
#endif
    EXPECT_EQ(arrival.size(), points.size());
}

}  // namespace
}  // namespace viscera::contrast
