#include "assets/generate/tube.h"

#include <algorithm>

namespace viscera::assets {
namespace {

constexpr double stem_mm = 40.0;
constexpr double arm_mm = 30.0;
constexpr double step_mm = 5.0;

}  // namespace

VesselTree make_tube() {
    const std::vector<glm::dvec3> stem{{0.0, 0.0, -stem_mm}, {0.0, 0.0, 0.0}};
    const glm::dvec3 left = arm_mm * glm::normalize(glm::dvec3(0.6, 0.0, 0.8));
    const glm::dvec3 right = left * glm::dvec3(-1.0, 1.0, 1.0);
    std::vector<Course> courses{{.name = "stem", .points = resample(stem, step_mm)}};
    const std::size_t fork = courses[0].points.size() - 1;
    for (const glm::dvec3& tip : {left, right}) {
        courses.push_back({.name = tip.x > 0.0 ? "left arm" : "right arm",
                           .parent = 0,
                           .parent_point = fork,
                           .points = resample({glm::dvec3(0.0), tip}, step_mm)});
    }
    return join_courses(courses, {.root_radius_mm = 3.0, .taper_per_mm = 0.0});
}

VertexScalars tube_density(const VesselTree& tube, const MeshData& mesh) {
    std::vector<double> travelled(tube.graph.nodes.size(),
                                  0.0);  // edges run from proximal to distal, in order
    for (const CentrelineGraph::Edge& edge : tube.graph.edges) {
        travelled[edge.b] = travelled[edge.a] + glm::distance(tube.graph.nodes[edge.a].position_mm,
                                                              tube.graph.nodes[edge.b].position_mm);
    }
    VertexScalars density{.name = "_DENSITY", .values = {}};
    for (const glm::vec3& position : mesh.positions) {
        const glm::dvec3 p(position);
        double nearest = 1e9;
        double at_mm = 0.0;
        for (const CentrelineGraph::Edge& edge : tube.graph.edges) {
            const glm::dvec3 a = tube.graph.nodes[edge.a].position_mm;
            const glm::dvec3 along = tube.graph.nodes[edge.b].position_mm - a;
            const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
            const double distance = glm::distance(p, a + t * along);
            if (distance < nearest) {
                nearest = distance;
                at_mm = glm::mix(travelled[edge.a], travelled[edge.b], t);
            }
        }
        density.values.push_back(static_cast<float>(std::clamp(1.0 - at_mm / (stem_mm + arm_mm), 0.0, 1.0)));
    }
    return density;
}

}  // namespace viscera::assets
