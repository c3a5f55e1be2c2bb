#include "effects/contrast/flow_pressures.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

namespace viscera::contrast {
namespace {

constexpr double smallest_flow = 1.0e-12;

// Nodes joined to a terminal through open edges; the others have no defined pressure.
std::vector<bool> connected_nodes(const CentrelineGraph& graph, std::span<const Tube> tubes,
                                  const Terminals& terminals) {
    std::vector<std::vector<std::size_t>> neighbours(graph.nodes.size());
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (tubes[e].conductance > 0.0) {
            neighbours[graph.edges[e].a].push_back(graph.edges[e].b);
            neighbours[graph.edges[e].b].push_back(graph.edges[e].a);
        }
    }
    std::vector<bool> seen(graph.nodes.size(), false);
    std::vector<std::size_t> stack;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        if (!std::isnan(terminals.pressure_pa[n])) {
            seen[n] = true;
            stack.push_back(n);
        }
    }
    while (!stack.empty()) {
        const std::size_t node = stack.back();
        stack.pop_back();
        for (const std::size_t next : neighbours[node]) {
            if (!seen[next]) {
                seen[next] = true;
                stack.push_back(next);
            }
        }
    }
    return seen;
}

}  // namespace

TubeFlow solve_pressures(const CentrelineGraph& graph, std::span<const Tube> tubes,
                         const Terminals& terminals) {
    TubeFlow flow;
    flow.pressure_pa.assign(graph.nodes.size(), 0.0);
    flow.flow_mm3_s.assign(graph.edges.size(), 0.0);
    const std::vector<bool> connected = connected_nodes(graph, tubes, terminals);
    double unit = 0.0;
    for (const Tube& tube : tubes) {
        unit = std::max(unit, tube.conductance);
    }
    std::vector<Eigen::Index> row(graph.nodes.size(), -1);
    Eigen::Index unknowns = 0;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        if (!std::isnan(terminals.pressure_pa[n])) {
            flow.pressure_pa[n] = terminals.pressure_pa[n];
        } else if (connected[n]) {
            row[n] = unknowns++;
        }
    }
    std::vector<Eigen::Triplet<double>> triplets;
    for (std::size_t e = 0; e < tubes.size(); ++e) {
        if (tubes[e].conductance > 0.0) {
            const double g = tubes[e].conductance / unit;
            const Eigen::Index a = row[graph.edges[e].a];
            const Eigen::Index b = row[graph.edges[e].b];
            if (a >= 0) {
                triplets.emplace_back(a, a, g);
            }
            if (b >= 0) {
                triplets.emplace_back(b, b, g);
            }
            if (a >= 0 && b >= 0) {
                triplets.emplace_back(a, b, -g);
                triplets.emplace_back(b, a, -g);
            }
        }
    }
    Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
    laplacian.setFromTriplets(triplets.begin(), triplets.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
    if (unknowns > 0) {
        solver.compute(laplacian);
    }
    // The first round finds the pressures from the flows that the terminals alone drive; the next two put
    // right what flows in and does not flow out. The drop of a short wide edge drowns in its pressures, but
    // the sum of its rounds does not.
    std::vector<double> correction = flow.pressure_pa;
    for (int round = 0; round < 3; ++round) {
        Eigen::VectorXd surplus = Eigen::VectorXd::Zero(unknowns);
        if (round > 0) {
            std::ranges::fill(correction, 0.0);
        }
        for (std::size_t e = 0; e < tubes.size(); ++e) {
            if (tubes[e].conductance > 0.0) {
                const auto [a, b] = graph.edges[e];
                const double q =
                    round > 0 ? flow.flow_mm3_s[e] : tubes[e].conductance * (correction[a] - correction[b]);
                if (row[a] >= 0) {
                    surplus[row[a]] -= q / unit;
                }
                if (row[b] >= 0) {
                    surplus[row[b]] += q / unit;
                }
            }
        }
        if (unknowns > 0) {
            const Eigen::VectorXd solution = solver.solve(surplus);
            for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
                if (row[n] >= 0) {
                    correction[n] = solution[row[n]];
                    flow.pressure_pa[n] += correction[n];
                }
            }
        }
        for (std::size_t e = 0; e < tubes.size(); ++e) {
            const auto [a, b] = graph.edges[e];
            if (tubes[e].conductance > 0.0) {
                flow.flow_mm3_s[e] += tubes[e].conductance * (correction[a] - correction[b]);
            }
        }
    }
    double largest = 0.0;
    for (const double q : flow.flow_mm3_s) {
        largest = std::max(largest, std::abs(q));
    }
    for (double& q : flow.flow_mm3_s) {
        q = std::isfinite(q) && std::abs(q) > smallest_flow * largest ? q : 0.0;
    }
    return flow;
}

}  // namespace viscera::contrast
