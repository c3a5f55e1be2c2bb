#include <cmath>
#include <numbers>

#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/volume_scene.h"

// Cylindrical and spherical volumes, cast directly, beside the same samples by way of a box of as many
// voxels: time and error against a field that is known everywhere.
namespace viscera::app {
namespace {

using nlohmann::json;

using std::numbers::pi;

struct Probe {
    const char* name;
    VolumeShape shape;
    glm::ivec3 dims;
};

std::array<Probe, 2> probes() {
    return {{{"cylindrical",
              {.kind = VolumeKind::cylindrical,
               .r_min_mm = 4.0,
               .r_max_mm = 50.0,
               .angle_rad = 2.0 * pi,
               .wrap = true,
               .height_mm = 60.0},
              {48, 128, 40}},
             {"spherical",
              {.kind = VolumeKind::spherical,
               .r_min_mm = 4.0,
               .r_max_mm = 50.0,
               .angle_rad = 2.0 * pi,
               .wrap = true,
               .latitude_rad = 2.4},
              {112, 56, 48}}}};
}

/// Speckles that widen with the distance from the axis, as a probe's resolution does, around a tube.
double field(const glm::dvec3& p) {
    const double r = std::hypot(p.x, p.y);
    const double speckles = std::sin(9.0 * std::atan2(p.y, p.x)) * std::cos(0.25 * p.z) * std::exp(-r / 15.0);
    const double wall = std::exp(-0.5 * std::pow((r - 24.0 - 4.0 * std::sin(0.1 * p.z)) / 3.0, 2.0));
    return 200.0 * wall * (1.0 + 0.4 * speckles) + 40.0 * speckles;
}

template <class Value>
Volume filled(const VolumeGrid& grid, const Value& value) {
    Volume volume{.grid = grid, .type = ScalarType::f32, .voxels = {}, .source = "probe"};
    std::vector<float> values;
    values.reserve(grid.voxel_count());
    for (int k = 0; k < grid.dims.z; ++k) {
        for (int j = 0; j < grid.dims.y; ++j) {
            for (int i = 0; i < grid.dims.x; ++i) {
                values.push_back(static_cast<float>(value(grid.world_of_index(glm::dvec3(i, j, k)))));
            }
        }
    }
    const auto bytes = std::as_bytes(std::span(values));
    volume.voxels.assign(bytes.begin(), bytes.end());
    return volume;
}

/// What converting to a box gives: as many voxels, cubes as nearly as may be, each interpolated between the
/// samples.
Volume resampled(const Volume& direct) {
    const VolumeGrid& grid = direct.grid;
    const glm::dmat4 box = grid.box_to_world();
    const glm::dvec3 size(glm::length(glm::dvec3(box[0])), glm::length(glm::dvec3(box[1])),
                          glm::length(glm::dvec3(box[2])));
    const double side = std::cbrt(size.x * size.y * size.z / static_cast<double>(grid.voxel_count()));
    VolumeGrid straight{.dims = glm::max(glm::ivec3(size / side), glm::ivec3(1))};
    straight.spacing_mm = size / glm::dvec3(straight.dims);
    straight.origin_mm = box * glm::dvec4(0.5 / glm::dvec3(straight.dims), 1.0);
    const int ring = grid.shape.wrap_axis();
    return filled(straight, [&](const glm::dvec3& world) {
        const glm::dvec3 place = grid.index_of_world(world);
        for (int a = 0; a < 3; ++a) {
            if (a != ring && (place[a] < 0.0 || place[a] > grid.dims[a] - 1.0)) {
                return -1000.0;
            }
        }
        const glm::dvec3 low = glm::floor(place);
        double sum = 0.0;
        for (int c = 0; c < 8; ++c) {
            glm::ivec3 voxel(low);
            double weight = 1.0;
            for (int a = 0; a < 3; ++a) {
                const int up = (c >> a) & 1;
                const double t = place[a] - low[a];
                weight *= up != 0 ? t : 1.0 - t;
                const int i = voxel[a] + up;
                voxel[a] = a == ring ? (i + 2 * grid.dims[a]) % grid.dims[a] : std::min(i, grid.dims[a] - 1);
            }
            sum += weight * direct.stored(voxel);
        }
        return sum;
    });
}

json scene_of(const Lab& lab, json parameters, double scale) {
    parameters["volume"]["host"] = "probe";
    json scene{{"version", 1}};
    scene["resolution"] = {std::max(1, static_cast<int>(scale * lab.options().width)),
                           std::max(1, static_cast<int>(scale * lab.options().height))};
    scene["camera"] = {{"eye_mm", {90, -150, 130}}, {"target_mm", {0, 0, 0}}, {"up", {0, 0, 1}},
                       {"vertical_fov_deg", 34},    {"near_mm", 1},           {"far_mm", 1000}};
    scene["passes"] = {{{"name", "cast"}, {"effect", "volume.ray_cast"}, {"parameters", parameters}}};
    scene["targets"] = {{"volume.colour", {{"format", "rgba32f"}}}};
    scene["outputs"] = {"volume.colour"};
    return scene;
}

/// Absorption shown bright: 0 beside the shape, whether a ray meets the box there or not.
json xray(const char* filter, double step, bool skip = true) {
    return {{"function", "xray"},
            {"xray", {{"water_attenuation_per_mm", 0.01}, {"negative", true}}},
            {"sampling", {{"filter", filter}, {"step", step}, {"skip", skip}}}};
}

json wall_shown(bool skip) {
    json parameters{{"function", "composite"}, {"sampling", {{"skip", skip}}}};
    parameters["transfer_function"]["points"] = {{{"value", 150}, {"opacity", 0.0}},
                                                 {{"value", 220}, {"opacity", 0.3}}};
    return parameters;
}

/// Without alpha, which only tells whether a ray met the box.
Image colours(Image picture) {
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            picture.set(x, y, 3, 0.0F);
        }
    }
    return picture;
}

struct CurvilinearShot {
    Samples time;
    Image picture;
};

CurvilinearShot shoot(Lab& lab, const LiveVolume& volume, const json& scene, int repeats) {
    const HostVolume given{"probe", &volume};
    Stage stage(lab, scene, {.by_pass = false, .repeats = repeats});
    stage.run([&](Frame& frame) {
        frame.volumes = std::span(&given, 1);
        nudge(frame);
    });
    return {stage.whole(), colours(stage.read("volume.colour"))};
}

}  // namespace

void run_curvilinear(Lab& lab) {
    const double scale = lab.hardware() ? 1.0 : 0.25;
    for (const Probe& probe : probes()) {
        VolumeGrid grid{.dims = probe.dims, .shape = probe.shape};
        grid.origin_mm = {0.0, 0.0, -0.5 * probe.shape.height_mm};
        const auto at = [&](const glm::dvec3& world) { return field(world - grid.origin_mm); };
        const Volume samples = filled(grid, at);
        const LiveVolume direct(samples);
        const LiveVolume box(resampled(samples));
        // The truth: three times as many samples along each axis, between the same ends.
        VolumeGrid fine = grid;
        for (int a = 0; a < 3; ++a) {
            fine.dims[a] = a == grid.shape.wrap_axis() ? 3 * grid.dims[a] : 3 * (grid.dims[a] - 1) + 1;
        }
        const CurvilinearShot exact =
            shoot(lab, LiveVolume(filled(fine, at)), scene_of(lab, xray("linear_fp32", 0.5), scale), 1);
        const std::string name = probe.name;
        const CurvilinearShot plain = shoot(lab, box, scene_of(lab, xray("linear", 0.5), scale), 0);
        const auto row = [&](const std::string& what, const CurvilinearShot& shot) {
            const CompareResult off = compare(shot.picture, exact.picture, {});
            lab.add({.group = "curvilinear",
                     .name = name + ", " + what,
                     .samples = shot.time,
                     .error = off.max,
                     .rms = off.rms,
                     .error_of = "three times the samples",
                     .ceiling = "the box",
                     .base = plain.time});
        };
        row("box of as many voxels", plain);
        for (const char* filter : {"linear", "linear_fp32", "bspline"}) {
            row(std::string("direct, ") + filter,
                shoot(lab, direct, scene_of(lab, xray(filter, 0.5), scale), 0));
        }
        const CurvilinearShot whole = shoot(lab, direct, scene_of(lab, wall_shown(false), scale), 0);
        const CurvilinearShot skipped = shoot(lab, direct, scene_of(lab, wall_shown(true), scale), 0);
        lab.add({.group = "curvilinear",
                 .name = name + ", wall, skipped in",
                 .samples = skipped.time,
                 .error = largest_difference(whole.picture, skipped.picture),
                 .error_of = "not skipped in",
                 .ceiling = "not skipped in",
                 .base = whole.time});
    }
}

}  // namespace viscera::app
