#include "effects/contrast/tube_tree.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/core/finite.h"

namespace viscera::contrast {
namespace {

constexpr std::uint32_t leaf_size = 4;

}  // namespace

TubeTree::TubeTree(const CentrelineGraph& graph) : graph_(graph), edges_at_node_(graph.nodes.size()) {
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
        if (graph.joins(graph.edges[e])) {
            edges_.push_back(e);
            edges_at_node_[graph.edges[e].a].push_back(e);
            edges_at_node_[graph.edges[e].b].push_back(e);
        }
    }
    if (!edges_.empty()) {
        boxes_.reserve(2 * edges_.size());
        boxes_.emplace_back();
        build(0, 0, static_cast<std::uint32_t>(edges_.size()));
    }
}

void TubeTree::build(std::size_t box, std::uint32_t first, std::uint32_t count) {
    Box bounds{.min = glm::dvec3(std::numeric_limits<double>::max()),
               .max = glm::dvec3(std::numeric_limits<double>::lowest()),
               .first = first,
               .count = count};
    for (std::uint32_t i = first; i < first + count; ++i) {
        for (const std::uint32_t n : {graph_.edges[edges_[i]].a, graph_.edges[edges_[i]].b}) {
            bounds.min = glm::min(bounds.min, graph_.nodes[n].position_mm);
            bounds.max = glm::max(bounds.max, graph_.nodes[n].position_mm);
            bounds.radius_mm = std::max(bounds.radius_mm, graph_.nodes[n].radius_mm);
        }
    }
    if (count > leaf_size) {
        const glm::dvec3 size = bounds.max - bounds.min;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const auto middle = [&](std::uint32_t e) {
            return graph_.nodes[graph_.edges[e].a].position_mm[axis] +
                   graph_.nodes[graph_.edges[e].b].position_mm[axis];
        };
        const auto begin = edges_.begin() + first;
        const std::uint32_t half = count / 2;
        std::nth_element(begin, begin + half, begin + count,
                         [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
        bounds.first = static_cast<std::uint32_t>(boxes_.size());
        bounds.count = 0;
        boxes_.resize(boxes_.size() + 2);
        build(bounds.first, first, half);
        build(bounds.first + 1, first + half, count - half);
    }
    boxes_[box] = bounds;
}

TubeFoot TubeTree::foot(const glm::dvec3& point_mm, std::size_t edge) const {
    const CentrelineGraph::Node& a = graph_.nodes[graph_.edges[edge].a];
    const CentrelineGraph::Node& b = graph_.nodes[graph_.edges[edge].b];
    const glm::dvec3 axis = b.position_mm - a.position_mm;
    const glm::dvec3 offset = point_mm - a.position_mm;
    const double length2 = glm::dot(axis, axis);
    const double along = length2 > 0.0 ? std::clamp(glm::dot(offset, axis) / length2, 0.0, 1.0) : 0.0;
    const double distance = glm::length(offset - along * axis);
    const double radius = std::max(0.0, std::lerp(a.radius_mm, b.radius_mm, along));
    return {.edge = edge, .along = along, .distance_mm = distance, .wall_mm = distance - radius};
}

std::optional<TubeFoot> TubeTree::nearest_wall(const glm::dvec3& point_mm,
                                               std::optional<std::size_t> guess) const {
    if (boxes_.empty() || !finite(point_mm)) {
        return {};
    }
    TubeFoot best = foot(point_mm, guess.value_or(edges_.front()));
    const auto bound = [&](const Box& box) {
        const glm::dvec3 gap = glm::max(glm::dvec3(0.0), glm::max(box.min - point_mm, point_mm - box.max));
        return glm::length(gap) - box.radius_mm;
    };
    struct Visit {
        std::uint32_t box = 0;
        double bound = 0.0;
    };
    std::array<Visit, 80> stack{};  // halving 2^32 edges goes 32 deep, and each level leaves one box waiting
    std::size_t depth = 0;
    stack[depth++] = {0, bound(boxes_[0])};
    while (depth > 0) {
        const Visit visit = stack[--depth];
        if (visit.bound >= best.wall_mm) {
            continue;
        }
        const Box& box = boxes_[visit.box];
        for (std::uint32_t i = box.first; i < box.first + box.count; ++i) {
            const TubeFoot candidate = foot(point_mm, edges_[i]);
            if (candidate.wall_mm < best.wall_mm) {
                best = candidate;
            }
        }
        if (box.count == 0) {
            Visit near{box.first, bound(boxes_[box.first])};
            Visit far{box.first + 1, bound(boxes_[box.first + 1])};
            if (far.bound < near.bound) {
                std::swap(near, far);
            }
            stack[depth++] = far;
            stack[depth++] = near;
        }
    }
    return best;
}

TubeFoot TubeTree::slide(const glm::dvec3& point_mm, TubeFoot from) const {
    while (true) {
        TubeFoot best = from;
        for (const std::uint32_t node : {graph_.edges[from.edge].a, graph_.edges[from.edge].b}) {
            for (const std::uint32_t edge : edges_at_node_[node]) {
                const TubeFoot candidate = foot(point_mm, edge);
                if (candidate.distance_mm < best.distance_mm) {
                    best = candidate;
                }
            }
        }
        if (best.edge == from.edge) {
            return from;
        }
        from = best;
    }
}

}  // namespace viscera::contrast
