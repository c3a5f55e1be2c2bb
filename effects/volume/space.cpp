#include "effects/volume/space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace viscera::volume {
namespace {

using std::numbers::pi;

glm::dmat4 turned_and_scaled(double angle, double scale) {
    const double c = std::cos(angle) * scale;
    const double s = std::sin(angle) * scale;
    return {glm::dvec4(c, s, 0.0, 0.0), glm::dvec4(-s, c, 0.0, 0.0), glm::dvec4(0.0, 0.0, scale, 0.0),
            glm::dvec4(0.0, 0.0, 0.0, 1.0)};
}

}  // namespace

glm::dmat4 Space::box_to_world() const {
    glm::dmat4 box(1.0);
    for (int a = 0; a < 3; ++a) {
        box[a][a] = high[a] - low[a];
    }
    box[3] = glm::dvec4(low, 1.0);
    return local_to_world * box;
}

Space::SampleMap Space::sample_map() const {
    const ShapeAxes axes = axes_of(shape, dims);
    SampleMap map;
    for (int a = 0; a < 3; ++a) {
        // One sample is all there is, from end to end.
        const bool one = dims[a] == 1 && a != shape.wrap_axis();
        map.scale[a] = 1.0 / (axes.step[a] * dims[a]);
        map.offset[a] = (one ? 0.0 : 0.5 / dims[a]) - axes.first[a] * map.scale[a];
    }
    return map;
}

Space::Range Space::coordinates(const glm::dvec3& texture_low, const glm::dvec3& texture_high) const {
    const ShapeAxes axes = axes_of(shape, dims);
    const SampleMap map = sample_map();
    Range range{(texture_low - map.offset) / map.scale, (texture_high - map.offset) / map.scale};
    for (int a = 0; a < 3; ++a) {
        const double end = axes.first[a] + axes.extent[a];
        if (a == shape.wrap_axis()) {
            range.high[a] = std::min(range.high[a], range.low[a] + 2.0 * pi);
            continue;
        }
        range.low[a] = std::clamp(range.low[a], axes.first[a], end);
        range.high[a] = std::clamp(range.high[a], axes.first[a], end);
    }
    return range;
}

FrameBox Space::box_of(const glm::dvec3& texture_low, const glm::dvec3& texture_high) const {
    if (!shape.curvilinear()) {
        return {texture_low, texture_high};
    }
    const Range range = coordinates(texture_low, texture_high);
    return box_around(shape, range.low, range.high);
}

Space make_space(const VolumeGrid& grid, const PlacementParams& placement) {
    Space space{.shape = grid.shape, .dims = grid.dims};
    if (!grid.curvilinear()) {
        space.local_to_unplaced = grid.texture_to_world();
        space.local_to_world = placed(grid, placement);
        return space;
    }
    VolumeShape& shape = space.shape;
    const double unit = std::max(shape.r_max_mm, 1e-300);
    // A ring has no gap whose middle would have to be away from x: left as it is, rays do not depend on which
    // of its samples is the first.
    const double middle = shape.wrap ? 0.0 : shape.first_angle_rad + 0.5 * shape.angle_rad;
    space.local_to_unplaced = grid.frame_to_world() * turned_and_scaled(middle, unit);
    shape.r_min_mm /= unit;
    shape.r_max_mm /= unit;
    shape.height_mm /= unit;
    shape.first_angle_rad =
        shape.wrap ? std::remainder(shape.first_angle_rad, 2.0 * pi) : -0.5 * shape.angle_rad;
    const glm::dvec3 centre = grid.box_to_world() * glm::dvec4(0.5, 0.5, 0.5, 1.0);
    space.local_to_world = placement_matrix(placement, centre) * space.local_to_unplaced;
    const FrameBox box = box_around(shape);
    space.low = box.min;
    space.high = box.max;
    return space;
}

bool same_shape(const VolumeGrid& a, const VolumeGrid& b) {
    return a.curvilinear() && a.shape == b.shape && a.origin_mm == b.origin_mm && a.direction == b.direction;
}

Space::SampleMap between(const glm::ivec3& from, const glm::ivec3& to, int wrap_axis) {
    Space::SampleMap map;
    for (int a = 0; a < 3; ++a) {
        const double n = from[a];
        const double m = to[a];
        if (a == wrap_axis) {  // index = turns * n
            map.offset[a] = 0.5 / m - 0.5 / n;
            continue;
        }
        // share of the extent = (t n - 1/2) / (n - 1), or t itself along one sample
        const double share_scale = n > 1.0 ? n / (n - 1.0) : 1.0;
        const double share_offset = n > 1.0 ? -0.5 / (n - 1.0) : 0.0;
        const double scale = m > 1.0 ? (m - 1.0) / m : 1.0;
        map.scale[a] = scale * share_scale;
        map.offset[a] = scale * share_offset + (m > 1.0 ? 0.5 / m : 0.0);
    }
    return map;
}

std::vector<std::string> coordinate_defines(VolumeKind kind) {
    return kind == VolumeKind::cartesian
               ? std::vector<std::string>{}
               : std::vector<std::string>{"COORDINATES " + std::to_string(static_cast<int>(kind))};
}

void set_places(const gl::Program& program, const Space& space) {
    program.set("u_metric", glm::mat3(glm::transpose(glm::inverse(glm::dmat3(space.local_to_world)))));
    if (!space.shape.curvilinear()) {
        return;
    }
    const Space::SampleMap map = space.sample_map();
    const ShapeAxes axes = axes_of(space.shape, space.dims);
    constexpr double rounding = 1e-6;
    constexpr double all_around = 1e9;
    glm::dvec3 low = map.scale * axes.first + map.offset - rounding;
    glm::dvec3 high = map.scale * (axes.first + axes.extent) + map.offset + rounding;
    if (const int ring = space.shape.wrap_axis(); ring >= 0) {
        low[ring] = -all_around;
        high[ring] = all_around;
    }
    program.set("u_sample_scale", glm::vec3(map.scale));
    program.set("u_sample_offset", glm::vec3(map.offset));
    program.set("u_sample_low", glm::vec3(low));
    program.set("u_sample_high", glm::vec3(high));
    program.set("u_ring", space.shape.wrap ? 1 : 0);
    program.set("u_axis_guard",
                static_cast<float>(std::max(0.01 * axes.step[space.shape.radius_axis()], 1e-6)));
}

void set_coordinates(const gl::Program& program, const Space& space, const glm::dvec3& crop_low,
                     const glm::dvec3& crop_high) {
    set_places(program, space);
    const VolumeShape& shape = space.shape;
    if (!shape.curvilinear()) {
        program.set("u_box_min", glm::vec3(crop_low));
        program.set("u_box_max", glm::vec3(crop_high));
        return;
    }
    const Space::Range range = space.coordinates(crop_low, crop_high);
    const int radius = shape.radius_axis();
    const int angle = shape.angle_axis();
    program.set("u_radius_low", static_cast<float>(range.low[radius]));
    program.set("u_radius_high", static_cast<float>(range.high[radius]));
    const double a = range.low[angle];
    const double b = range.high[angle];
    constexpr double slack = 1e-9;
    program.set("u_wedge", b - a >= 2.0 * pi - slack ? 0 : (b - a <= pi + slack ? 1 : 2));
    program.set("u_wedge_low", glm::vec2(glm::dvec2(-std::sin(a), std::cos(a))));
    program.set("u_wedge_high", glm::vec2(glm::dvec2(std::sin(b), -std::cos(b))));
    if (shape.kind == VolumeKind::cylindrical) {
        program.set("u_height", glm::vec2(glm::dvec2(range.low.z, range.high.z)));
    } else {
        program.set("u_latitude", glm::vec4(glm::dvec4(std::cos(range.low.y), std::sin(range.low.y),
                                                       std::cos(range.high.y), std::sin(range.high.y))));
    }
}

double voxel_spacing_mm(const Space& space) {
    glm::dvec3 scale;
    for (int a = 0; a < 3; ++a) {
        scale[a] = glm::length(glm::dvec3(space.local_to_world[a]));
    }
    if (!space.shape.curvilinear()) {
        const glm::dvec3 spacing = scale / glm::dvec3(space.dims);
        return std::min({spacing.x, spacing.y, spacing.z});
    }
    const ShapeAxes axes = axes_of(space.shape, space.dims);
    const double across = std::min(scale.x, scale.y);
    const double all = std::min(across, scale.z);
    const double radius = 0.5 * (space.shape.r_min_mm + space.shape.r_max_mm);
    if (space.shape.kind == VolumeKind::cylindrical) {
        return std::min({axes.step.x * across, axes.step.y * radius * across, axes.step.z * scale.z});
    }
    return std::min({axes.step.x * radius * across, axes.step.y * radius * all, axes.step.z * all});
}

}  // namespace viscera::volume
