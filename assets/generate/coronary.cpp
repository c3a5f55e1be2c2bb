#include "assets/generate/coronary.h"

#include <array>
#include <span>
#include <utility>

#include "assets/generate/grower.h"

namespace viscera::assets {
namespace {

constexpr double catheter_radius_mm = 1.0;  // 6 French
constexpr double left_main_radius_mm = 2.2;

/// A left Judkins catheter: down the right wall of the ascending aorta, across, and into the ostium.
/// It comes from above the picture.
int add_catheter(Grower& grower, const glm::dvec3& ostium, const glm::dvec3& inward) {
    const std::vector<glm::dvec3> corners{ostium + glm::dvec3(6.0, 30.0, 92.0),
                                          ostium + glm::dvec3(-4.0, 18.0, 76.0),
                                          ostium + glm::dvec3(-15.0, 8.0, 54.0),
                                          ostium + glm::dvec3(-21.5, 3.5, 30.0),
                                          ostium + glm::dvec3(-19.5, 1.5, 11.5),
                                          ostium + glm::dvec3(-12.0, 0.3, 2.0) - 1.0 * inward,
                                          ostium - 5.5 * inward + glm::dvec3(0.0, 0.0, -0.6),
                                          ostium};
    return grower.add({.name = "catheter",
                       .points = resample(spline(corners, 24), Grower::step_mm),
                       .pipe_radius_mm = catheter_radius_mm});
}

/// A large branch that leaves its parent at an acute angle and then runs down towards the apex.
struct SurfaceBranch {
    double at;  ///< fraction of the parent's length
    double tip_weight;
    double beta_to_deg;    ///< where it ends
    double phi_by_deg;     ///< how far it swings to the side
    double tortuosity_mm;  ///< amplitude
    int twigs;
};

/// Adds the large branches of one parent; returns those that found room, with the number of twigs of each.
std::vector<std::pair<int, int>> add_surface_branches(Grower& grower, const Heart& heart, int parent,
                                                      const std::string& name,
                                                      std::span<const SurfaceBranch> branches) {
    std::vector<std::pair<int, int>> added;
    int number = 0;
    for (const SurfaceBranch& b : branches) {
        const std::size_t point = grower.free_point(parent, b.at);
        const glm::dvec2 from = heart.angles(grower.course(parent).points[point]);
        const double fall = from.x - b.beta_to_deg;
        const std::vector<glm::dvec2> way{from,
                                          {from.x - 0.17 * fall, from.y + 0.43 * b.phi_by_deg},
                                          {from.x - 0.55 * fall, from.y + 0.87 * b.phi_by_deg},
                                          {b.beta_to_deg, from.y + b.phi_by_deg}};
        const int branch =
            grower.along(name + std::to_string(++number), parent, point, way, b.tip_weight, b.tortuosity_mm);
        if (branch >= 0) {
            added.emplace_back(branch, b.twigs);
        }
    }
    return added;
}

/// Side branches of the LAD that are no diagonals: septals into the muscle, and to the right ventricle.
void add_lad_twigs(Grower& grower, int lad) {
    int number = 0;
    for (const double at : {0.13, 0.22, 0.31, 0.41, 0.5, 0.6, 0.7}) {
        const double length_mm = 34.0 - 24.0 * at + grower.random().uniform(-3.0, 3.0);
        grower.septal("septal " + std::to_string(++number), lad, grower.free_point(lad, at), length_mm, 1.0);
    }
    number = 0;
    for (const double at : {0.1, 0.28, 0.46, 0.64}) {
        const double angle_deg = grower.random().uniform(48.0, 62.0);
        const double length_mm = grower.random().uniform(20.0, 30.0);
        grower.twig("right ventricular " + std::to_string(++number), lad, grower.free_point(lad, at),
                    angle_deg, length_mm, 1.0);
    }
}

/// Branches of the circumflex to the left atrium: seen from outside, the base lies to its left.
void add_atrial_twigs(Grower& grower, int circumflex) {
    int number = 0;
    for (const double at : {0.1, 0.34, 0.58}) {
        grower.twig("left atrial " + std::to_string(++number), circumflex, grower.free_point(circumflex, at),
                    -52.0, grower.random().uniform(20.0, 30.0), 1.0);
    }
}

CoronaryLandmarks landmarks_of(const VesselTree& tree, const Heart& heart, int left_main, int lad) {
    const auto position = [&](int branch, std::size_t i) {
        const Branch& b = tree.branches[static_cast<std::size_t>(branch)];
        return tree.graph.nodes[b.nodes[i]].position_mm;
    };
    const Branch& lad_branch = tree.branches[static_cast<std::size_t>(lad)];
    const std::size_t middle = lad_branch.nodes.size() * 2 / 5;
    CoronaryLandmarks marks;
    marks.ostium_mm = position(left_main, 0);
    marks.into_root_mm = glm::normalize(marks.ostium_mm - position(left_main, 2));
    marks.lad_middle_mm = position(lad, middle);
    marks.lad_outward_mm = heart.normal(marks.lad_middle_mm);
    marks.lad_middle_radius_mm = tree.graph.nodes[lad_branch.nodes[middle]].radius_mm;
    return marks;
}

}  // namespace

Coronary grow_coronary(std::uint64_t seed) {
    const Heart heart;
    Grower grower(heart, seed);
    const glm::dvec3 fork = heart.point(107.0, 4.0);
    const glm::dvec3 leftward = glm::normalize(glm::dvec3(0.93, -0.32, -0.12));
    const glm::dvec3 ostium = fork - 12.5 * leftward;

    const int catheter = add_catheter(grower, ostium, leftward);
    const std::vector<glm::dvec3> stem{ostium, ostium + 6.0 * leftward + glm::dvec3(0.0, 0.0, 0.7), fork};
    const int left_main = grower.add({.name = "left main",
                                      .parent = catheter,
                                      .parent_point = grower.course(catheter).points.size() - 1,
                                      .points = resample(spline(stem, 12), Grower::step_mm)});
    const std::size_t end = grower.course(left_main).points.size() - 1;
    const glm::dvec2 at = heart.angles(fork);
    const int lad = grower.along(
        "LAD", left_main, end,
        {at, {98.0, 4.0}, {82.0, -3.0}, {62.0, 2.0}, {42.0, -2.0}, {22.0, 3.0}, {6.0, 10.0}, {14.0, 176.0}},
        1.9, 1.7);
    const int circumflex = grower.along(
        "LCx", left_main, end,
        {at, {109.0, 14.0}, {112.0, 38.0}, {109.0, 66.0}, {112.0, 96.0}, {108.0, 124.0}, {98.0, 146.0}}, 1.25,
        2.4);

    // Large vessels first, so that twigs yield to them.
    constexpr std::array<SurfaceBranch, 3> diagonals{
        {{0.16, 1.2, 34.0, 42.0, 1.8, 5}, {0.35, 1.15, 27.0, 40.0, 1.7, 4}, {0.55, 1.1, 16.0, 40.0, 1.5, 3}}};
    constexpr std::array<SurfaceBranch, 3> marginals{
        {{0.16, 1.25, 34.0, 33.0, 2.2, 5}, {0.44, 1.2, 36.0, 22.0, 2.4, 5}, {0.7, 1.15, 44.0, 14.0, 2.2, 4}}};
    auto large = add_surface_branches(grower, heart, lad, "diagonal ", diagonals);
    for (const auto& marginal :
         add_surface_branches(grower, heart, circumflex, "obtuse marginal ", marginals)) {
        large.push_back(marginal);
    }
    add_lad_twigs(grower, lad);
    add_atrial_twigs(grower, circumflex);
    for (const auto& [branch, twigs] : large) {
        for (const int twig : grower.twigs_along(branch, twigs, 1.05)) {
            grower.twigs_along(twig, 1, 1.0);
        }
    }
    grower.twigs_along(lad, 5, 1.0);
    grower.twigs_along(circumflex, 3, 1.0);

    Coronary coronary{.tree = join_courses(grower.courses(), {left_main_radius_mm, 0.0035}), .landmarks = {}};
    coronary.landmarks = landmarks_of(coronary.tree, heart, left_main, lad);
    return coronary;
}

}  // namespace viscera::assets
