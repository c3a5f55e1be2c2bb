#include "effects/contrast/flow_network.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "engine/core/error.h"
#include "tests/core/not_finite.h"

namespace viscera::contrast {
namespace {

using std::numbers::pi;
constexpr double pascal_per_mmhg = 133.322387415;

// Inflow minus outflow of a node.
double balance(const CentrelineGraph& graph, const FlowNetwork& network, std::size_t node) {
    double sum = 0.0;
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
        sum += graph.edges[e].b == node ? network.flow_mm3_s[e] : 0.0;
        sum -= graph.edges[e].a == node ? network.flow_mm3_s[e] : 0.0;
    }
    return sum;
}

void expect_finite(const FlowNetwork& network) {
    for (const double p : network.pressure_pa) {
        EXPECT_TRUE(std::isfinite(p));
    }
    for (const double q : network.flow_mm3_s) {
        EXPECT_TRUE(std::isfinite(q));
    }
    for (const double t : network.transit_s) {
        EXPECT_TRUE(t >= 0.0);
    }
    for (const double t : network.arrival_s) {
        EXPECT_TRUE(t >= 0.0);
    }
}

CentrelineGraph straight_tube(int edges, double length, double radius) {
    CentrelineGraph graph;
    for (int i = 0; i <= edges; ++i) {
        graph.nodes.push_back({{0.0, 0.0, length * i / edges}, radius});
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(edges); ++i) {
        // Every other edge is drawn against the flow.
        graph.edges.push_back(i % 2 == 0 ? CentrelineGraph::Edge{i, i + 1} : CentrelineGraph::Edge{i + 1, i});
    }
    return graph;
}

TEST(FlowNetwork, TubeArrivesAfterLengthOverSpeed) {
    const CentrelineGraph graph = straight_tube(10, 200.0, 3.0);
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100.0}}, .injection_speed_mm_s = 80.0}, {}, log);
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        EXPECT_NEAR(network.arrival_s[n], graph.nodes[n].position_mm.z / 80.0, 1e-12);
    }
    EXPECT_TRUE(log.faults().empty());
}

TEST(FlowNetwork, GivenPressuresGivePoiseuille) {
    const CentrelineGraph graph = straight_tube(4, 100.0, 0.5);
    Log log;
    const FlowNetwork network = solve_flow(
        graph,
        {.viscosity_pa_s = 0.004, .inlets = {{0, 30.0}}, .outlets = {{4, 10.0}}, .injection_speed_mm_s = 0.0},
        {}, log);
    // In SI: pi r^4 dp / (8 mu L), r = 0.5e-3 m, L = 0.1 m.
    const double q_m3_s = pi * std::pow(0.5e-3, 4) * 20.0 * pascal_per_mmhg / (8.0 * 0.004 * 0.1);
    EXPECT_NEAR(network.flow_mm3_s[0], q_m3_s * 1e9, 1e-9 * q_m3_s * 1e9);
    EXPECT_NEAR(network.flow_mm3_s[1], -q_m3_s * 1e9, 1e-9 * q_m3_s * 1e9);
    EXPECT_NEAR(network.arrival_s[4], pi * 0.25 * 100.0 / (q_m3_s * 1e9), 1e-10);
    EXPECT_NEAR(network.pressure_pa[2], 20.0 * pascal_per_mmhg, 1e-8);
}

// A taper cut into many tubes tends to the closed form of one frustum, in resistance and in volume.
TEST(FlowNetwork, FrustumIsTheLimitOfManyTubes) {
    CentrelineGraph one;
    one.nodes = {{{0, 0, 0}, 4.0}, {{0, 0, 50}, 1.5}};
    one.edges = {{0, 1}};
    const FlowParams params{.inlets = {{0, 10.0}}, .outlets = {{1, 0.0}}, .injection_speed_mm_s = 0.0};
    Log log;
    const FlowNetwork network = solve_flow(one, params, {}, log);
    double resistance = 0.0;
    double volume = 0.0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
        const double r = 4.0 - 2.5 * (i + 0.5) / steps;
        resistance += 8.0 * params.viscosity_pa_s * (50.0 / steps) / (pi * std::pow(r, 4));
        volume += pi * r * r * 50.0 / steps;
    }
    const double q = 10.0 * pascal_per_mmhg / resistance;
    EXPECT_NEAR(network.flow_mm3_s[0], q, 1e-7 * q);
    EXPECT_NEAR(network.transit_s[0], volume / q, 1e-7 * volume / q);
}

TEST(FlowNetwork, BifurcationSplitsByRadiusToTheFourthOverLength) {
    CentrelineGraph graph;
    graph.nodes = {{{0, 0, 0}, 3},   {{0, 0, 40}, 3}, {{0, 0, 40}, 2},
                   {{0, 30, 40}, 2}, {{0, 0, 40}, 1}, {{60, 0, 40}, 1}};
    // Branch nodes of their own radius at the fork, joined to it by edges of no length.
    graph.edges = {{0, 1}, {1, 2}, {2, 3}, {1, 4}, {4, 5}};
    Log log;
    const FlowNetwork network = solve_flow(
        graph, {.inlets = {{0, 100}}, .outlets = {{3, 10}, {5, 10}}, .injection_speed_mm_s = 100}, {}, log);
    const double split = (16.0 / 30.0) / (1.0 / 60.0);
    EXPECT_NEAR(network.flow_mm3_s[2] / network.flow_mm3_s[4], split, 1e-4 * split);
    const double q = pi * 9.0 * 100.0;
    EXPECT_NEAR(network.flow_mm3_s[0], q, 1e-9 * q);
    const double thin = q / (1.0 + split);
    EXPECT_NEAR(network.arrival_s[5], 40.0 / 100.0 + pi * 60.0 / thin, 1e-4 * network.arrival_s[5]);
    EXPECT_EQ(log.faults().at("contrast.graph_length"), 2U);
}

TEST(FlowNetwork, SymmetricLoopMeetsInTheMiddle) {
    CentrelineGraph graph;
    graph.nodes = {{{0, 0, 0}, 2},   {{10, 0, 0}, 2}, {{20, 8, 0}, 2},
                   {{20, -8, 0}, 2}, {{30, 0, 0}, 2}, {{40, 0, 0}, 2}};
    graph.edges = {{0, 1}, {1, 2}, {1, 3}, {2, 4}, {4, 3}, {4, 5}};
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100}}, .injection_speed_mm_s = 50}, {}, log);
    EXPECT_NEAR(network.arrival_s[2], network.arrival_s[3], 1e-12);
    // Half the flow: half the speed on the arms.
    const double arm = std::hypot(10.0, 8.0);
    EXPECT_NEAR(network.arrival_s[5], 10.0 / 50 + 2.0 * arm / 25 + 10.0 / 50, 1e-12);
    EXPECT_TRUE(log.faults().empty());
}

TEST(FlowNetwork, ArrivalIsTheFlowWeightedMeanOfItsPaths) {
    CentrelineGraph graph;  // a short wide and a long thin way round
    graph.nodes = {{{0, 0, 0}, 2}, {{10, 0, 0}, 2}, {{20, 0, 0}, 2}, {{15, 40, 0}, 2}, {{30, 0, 0}, 2}};
    graph.edges = {{0, 1}, {1, 2}, {1, 3}, {3, 2}, {2, 4}};
    Log log;
    const FlowNetwork n = solve_flow(graph, {.inlets = {{0, 100}}, .outlets = {{4, 0}}}, {}, log);
    const double q1 = n.flow_mm3_s[1];
    const double q2 = n.flow_mm3_s[3];
    EXPECT_GT(q1, 5.0 * q2);
    const double expected =
        (q1 * (n.arrival_s[1] + n.transit_s[1]) + q2 * (n.arrival_s[3] + n.transit_s[3])) / (q1 + q2);
    EXPECT_NEAR(n.arrival_s[2], expected, 1e-13);
}

// Random meshed networks against a dense solve; Wheatstone's bridge among them.
TEST(FlowNetwork, AgreesWithADenseSolve) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(0.0, 100.0);
    std::uniform_real_distribution<double> width(0.3, 6.0);
    for (int trial = 0; trial < 20; ++trial) {
        CentrelineGraph graph;
        const std::uint32_t count = trial == 0 ? 4 : 30;
        for (std::uint32_t n = 0; n < count; ++n) {
            graph.nodes.push_back({{place(random), place(random), place(random)}, width(random)});
        }
        if (trial == 0) {
            graph.edges = {{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}};
        } else {
            for (std::uint32_t n = 1; n < count; ++n) {
                graph.edges.push_back({static_cast<std::uint32_t>(random() % n), n});
                graph.edges.push_back({n, static_cast<std::uint32_t>(random() % n)});
            }
        }
        const auto last = static_cast<int>(count) - 1;
        const FlowParams params{
            .inlets = {{0, 100.0}}, .outlets = {{last, 10.0}}, .injection_speed_mm_s = 0.0};
        Log log;
        const FlowNetwork network = solve_flow(graph, params, {}, log);

        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
        std::vector<double> conductance;
        for (const CentrelineGraph::Edge& e : graph.edges) {
            const double ra = graph.nodes[e.a].radius_mm;
            const double rb = graph.nodes[e.b].radius_mm;
            const double length = glm::distance(graph.nodes[e.a].position_mm, graph.nodes[e.b].position_mm);
            const double r4 = 3.0 * std::pow(ra * rb, 3) / (ra * ra + ra * rb + rb * rb);
            const double g = pi * r4 / (8.0 * params.viscosity_pa_s * length);
            conductance.push_back(g);
            matrix(e.a, e.a) += g;
            matrix(e.b, e.b) += g;
            matrix(e.a, e.b) -= g;
            matrix(e.b, e.a) -= g;
        }
        for (const auto& [node, p] : {std::pair{0, 100.0}, std::pair{last, 10.0}}) {
            matrix.row(node).setZero();
            matrix(node, node) = 1.0;
            right[node] = p * pascal_per_mmhg;
        }
        const Eigen::VectorXd pressure = matrix.fullPivLu().solve(right);
        double total = 0.0;
        for (const double q : network.flow_mm3_s) {
            total = std::max(total, std::abs(q));
        }
        for (std::size_t e = 0; e < graph.edges.size(); ++e) {
            const double q = conductance[e] * (pressure[graph.edges[e].a] - pressure[graph.edges[e].b]);
            EXPECT_NEAR(network.flow_mm3_s[e], q, 1e-9 * total);
        }
        for (std::size_t n = 1; n + 1 < count; ++n) {
            EXPECT_NEAR(network.pressure_pa[n], pressure[static_cast<Eigen::Index>(n)], 1e-8);
            EXPECT_NEAR(balance(graph, network, n), 0.0, 1e-13 * total);
        }
        expect_finite(network);
    }
}

TEST(FlowNetwork, DeadEndsAndOtherTreesAreNotReached) {
    CentrelineGraph graph = straight_tube(4, 100.0, 2.0);
    const auto first = static_cast<std::uint32_t>(graph.nodes.size());
    graph.nodes.push_back({{20, 0, 50}, 1.0});  // blind branch: no outlet named there
    graph.edges.push_back({2, first});
    graph.nodes.push_back({{90, 0, 0}, 1.0});  // isolated
    graph.nodes.push_back({{90, 0, 9}, 1.0});  // a tree of its own
    graph.nodes.push_back({{90, 0, 19}, 1.0});
    graph.edges.push_back({first + 2, first + 3});
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100}}, .outlets = {{4, 10}}, .injection_speed_mm_s = 50}, {}, log);
    EXPECT_NEAR(network.arrival_s[4], 2.0, 1e-12);
    for (std::uint32_t n = first; n < first + 4; ++n) {
        EXPECT_TRUE(std::isinf(network.arrival_s[n])) << n;
    }
    EXPECT_EQ(network.flow_mm3_s[4], 0.0);
    EXPECT_EQ(log.faults().at("contrast.unreached_nodes"), 4U);
    expect_finite(network);
}

TEST(FlowNetwork, InjectionPartWayReachesOnlyWhatLiesDownstream) {
    const CentrelineGraph graph = straight_tube(10, 100.0, 2.0);
    Log log;
    const FlowNetwork network = solve_flow(graph, {.inlets = {{0, 100}}, .injection_speed_mm_s = 50},
                                           glm::dvec3(3.0, 0.0, 41.0), log);
    EXPECT_TRUE(std::isinf(network.arrival_s[3]));
    EXPECT_EQ(network.arrival_s[4], 0.0);
    EXPECT_NEAR(network.arrival_s[10], 60.0 / 50.0, 1e-12);
    EXPECT_FALSE(network.carries_contrast(graph, 3));
    EXPECT_TRUE(network.carries_contrast(graph, 4));
}

TEST(FlowNetwork, BadGraphsStayFiniteAndSaySo) {
    const auto faults_of = [](const CentrelineGraph& graph, const FlowParams& params) {
        Log log;
        const FlowNetwork network = solve_flow(graph, params, {}, log);
        expect_finite(network);
        return log.faults();
    };
    EXPECT_TRUE(faults_of({}, {}).contains("contrast.no_inlet"));

    CentrelineGraph ring;
    ring.nodes = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0, 1, 0}, 1}};
    ring.edges = {{0, 1}, {1, 2}, {2, 0}};
    EXPECT_TRUE(faults_of(ring, {}).contains("contrast.no_inlet"));
    EXPECT_TRUE(faults_of(ring, {.inlets = {{0, 100}}}).contains("contrast.no_outlet"));
    EXPECT_TRUE(faults_of(ring, {.inlets = {{0, 50}}, .outlets = {{1, 50}}}).contains("contrast.no_flow"));

    CentrelineGraph tube = straight_tube(4, 100.0, 2.0);
    tube.nodes[2].radius_mm = 0.0;
    const auto closed = faults_of(tube, {.inlets = {{0, 100}}});
    EXPECT_EQ(closed.at("contrast.graph_radius"), 2U);
    EXPECT_TRUE(closed.contains("contrast.no_flow"));

    tube = straight_tube(4, 100.0, 2.0);
    tube.nodes[2].position_mm.x = nan;
    tube.edges.push_back({1, 1});
    tube.edges.push_back({0, 99});
    EXPECT_EQ(faults_of(tube, {.inlets = {{0, 100}}, .outlets = {{4, 0}}}).at("contrast.graph_edge"), 4U);

    tube = straight_tube(4, 0.0, 2.0);  // all at one place
    EXPECT_EQ(faults_of(tube, {.inlets = {{0, 100}}}).at("contrast.graph_length"), 4U);

    tube = straight_tube(4, 100.0, 1e-90);  // r^4 is no double
    EXPECT_TRUE(faults_of(tube, {.inlets = {{0, 100}}}).contains("contrast.graph_radius"));
}

TEST(FlowNetwork, RefusesWrongSettings) {
    const CentrelineGraph graph = straight_tube(4, 100.0, 2.0);
    Log log;
    for (const FlowParams& params :
         {FlowParams{.inlets = {{5, 100}}}, FlowParams{.inlets = {{-1, 100}}},
          FlowParams{.inlets = {{0, nan}}}, FlowParams{.inlets = {{0, 100}}, .outlets = {{0, 10}}},
          FlowParams{.viscosity_pa_s = 0.0}, FlowParams{.injection_speed_mm_s = nan}}) {
        try {
            (void)solve_flow(graph, params, {}, log);
            ADD_FAILURE() << "no error";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::scene) << error.what();
        }
    }
}

// A wide trunk over hair-thin branches: the trunk's pressure drop is far below the digits of its pressures.
TEST(FlowNetwork, KeepsFlowInBalanceOverTwentyOrdersOfConductance) {
    CentrelineGraph graph;
    graph.nodes = {
        {{0, 0, 0}, 12}, {{0, 0, 0.1}, 12}, {{0, 0, 0.2}, 12}, {{0, 50, 0}, 0.01}, {{50, 0, 0}, 0.01}};
    graph.edges = {{0, 1}, {1, 2}, {2, 3}, {2, 4}};
    Log log;
    const FlowNetwork network =
        solve_flow(graph, {.inlets = {{0, 100}}, .injection_speed_mm_s = 100}, {}, log);
    const double q = network.flow_mm3_s[0];
    EXPECT_GT(q, 0.0);
    EXPECT_NEAR(network.flow_mm3_s[1], q, 1e-12 * q);
    EXPECT_NEAR(network.flow_mm3_s[2] + network.flow_mm3_s[3], q, 1e-12 * q);
}

}  // namespace
}  // namespace viscera::contrast
