#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// One vessel of a tree: a chain of nodes, the first of which is the node of its parent that it leaves from.
struct Branch {
    std::string name;
    std::vector<std::uint32_t> nodes;  ///< node indices, proximal first, at least 2
    double start_radius_mm = 0.0;      ///< its own radius at nodes[0], where the node carries the parent's
};

/// A vessel tree: the graph as it is written to disk, and which chain of nodes is which vessel.
/// Node 0 is the inlet; each edge runs from proximal (a) to distal (b).
struct VesselTree {
    CentrelineGraph graph;
    std::vector<Branch> branches;
};

/// The way one vessel takes, and how much it feeds, before radii are known.
struct Course {
    std::string name;
    int parent = -1;                 ///< index of the parent course; -1: the inlet
    std::size_t parent_point = 0;    ///< index of the point of the parent where it leaves
    std::vector<glm::dvec3> points;  ///< [mm], proximal first, at least 2; points[0] is the parent's point
    double tip_weight = 1.0;      ///< radius of its tip relative to other tips, > 0 (unused where it forks)
    double pipe_radius_mm = 0.0;  ///< > 0: a rigid pipe of this radius, outside Murray's law (a catheter)
};

/// How the radii of a tree are found.
struct Calibre {
    double root_radius_mm = 2.0;  ///< of the first vessel that is no pipe, at its root
    double taper_per_mm = 0.0;    ///< relative growth towards the root between branchings: unseen twigs
};

/// Gives each course its radii, from the tips to the root, and joins them to a tree. At every branching the
/// cubes of the radii add up (Murray's law): the node carries the parent's radius, the first node of the rest
/// of the parent and of each branch carry theirs. Parents must stand before their children.
[[nodiscard]] VesselTree join_courses(const std::vector<Course>& courses, const Calibre& calibre);

/// Points at equal distances (as near to step_mm as fits) along a polyline; keeps both ends.
[[nodiscard]] std::vector<glm::dvec3> resample(const std::vector<glm::dvec3>& polyline, double step_mm);

/// Catmull-Rom spline (uniform) through points, `per_span` samples for each span; keeps both ends.
[[nodiscard]] std::vector<glm::dvec3> spline(const std::vector<glm::dvec3>& points, int per_span);

/// Length of a polyline [mm].
[[nodiscard]] double polyline_length(const std::vector<glm::dvec3>& polyline);

}  // namespace viscera::assets
