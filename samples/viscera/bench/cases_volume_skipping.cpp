#include <algorithm>
#include <ctime>
#include <random>

#include "effects/volume/skip_map.h"
#include "engine/gl/timer.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/volume_scene.h"

namespace viscera::app {
namespace {

using nlohmann::json;

constexpr int side = 256;  // voxels
/// Occupancy is told in bricks of so many voxels, whatever the ray caster takes: the same volumes for all.
constexpr int brick = 4;
constexpr int bricks = side / brick;
constexpr std::size_t brick_count = static_cast<std::size_t>(bricks) * bricks * bricks;

std::size_t at(const glm::ivec3& b) {
    return static_cast<std::size_t>(b.x) +
           bricks * (static_cast<std::size_t>(b.y) + bricks * static_cast<std::size_t>(b.z));
}

template <class Visit>
void each_brick(const Visit& visit) {
    for (int z = 0; z < bricks; ++z) {
        for (int y = 0; y < bricks; ++y) {
            for (int x = 0; x < bricks; ++x) {
                visit(glm::ivec3(x, y, z));
            }
        }
    }
}

/// Distance of each brick to the surface of the nearest of some balls, the same in every run.
std::vector<float> distances_to_balls() {
    std::mt19937 random(7);
    const auto unit = [&] { return static_cast<double>(random() >> 8U) / 16777216.0; };
    std::vector<glm::dvec4> balls(40);
    for (glm::dvec4& ball : balls) {
        ball = glm::dvec4(unit(), unit(), unit(), 0.02 + 0.1 * unit()) * static_cast<double>(bricks);
    }
    std::vector<float> distance(brick_count);
    each_brick([&](const glm::ivec3& b) {
        double nearest = 1e30;
        for (const glm::dvec4& ball : balls) {
            nearest = std::min(nearest, glm::length(glm::dvec3(b) + 0.5 - glm::dvec3(ball)) - ball.w);
        }
        distance[at(b)] = static_cast<float>(nearest);
    });
    return distance;
}

/// Least distance of a brick and its neighbours: a brick's range includes voxels around it, so those beside a
/// ball are occupied too.
std::vector<float> with_neighbours(const std::vector<float>& distance) {
    std::vector<float> least(brick_count, 1e30F);
    each_brick([&](const glm::ivec3& b) {
        for (int n = 0; n < 27; ++n) {
            const glm::ivec3 beside = b + glm::ivec3(n % 3, n / 3 % 3, n / 9) - 1;
            if (glm::all(glm::greaterThanEqual(beside, glm::ivec3(0))) &&
                glm::all(glm::lessThan(beside, glm::ivec3(bricks)))) {
                least[at(b)] = std::min(least[at(b)], distance[at(beside)]);
            }
        }
    });
    return least;
}

/// Clusters in nothing, so that `share` of all bricks are occupied; u8.
Volume clusters(const std::vector<float>& distance, const std::vector<float>& least, double share) {
    std::vector<float> sorted = least;
    std::ranges::sort(sorted);
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(brick_count));
    const float border = wanted == 0 ? -1e30F : sorted[wanted - 1];
    Volume volume{.grid = {.dims = glm::ivec3(side),
                           .spacing_mm = glm::dvec3(1.0),
                           .origin_mm = glm::dvec3(-0.5 * (side - 1))},
                  .type = ScalarType::u8,
                  .voxels = std::vector<std::byte>(static_cast<std::size_t>(side) * side * side),
                  .source = "clusters"};
    std::mt19937 random(11);
    each_brick([&](const glm::ivec3& b) {
        if (distance[at(b)] > border) {
            return;
        }
        for (int i = 0; i < brick * brick * brick; ++i) {
            const glm::ivec3 v = brick * b + glm::ivec3(i % brick, i / brick % brick, i / (brick * brick));
            volume.voxels[static_cast<std::size_t>(v.x) +
                          side * (static_cast<std::size_t>(v.y) + side * static_cast<std::size_t>(v.z))] =
                static_cast<std::byte>(120U + random() % 64U);
        }
    });
    return volume;
}

/// On this thread alone; what other programs take of the machine does not count.
template <class Work>
Samples processor_time(int repeats, const Work& work) {
    Samples samples;
    for (int i = -1; i < repeats; ++i) {
        const double start = 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
        const gl::CpuTimer wall;
        work(i + 1);
        const double end = 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
        if (i >= 0) {  // the first one allocates
            samples.push_back({wall.milliseconds(), end - start});
        }
    }
    return samples;
}

void processor_work(Lab& lab, const Volume& volume) {
    const int repeats = lab.options().repeats;
    volume::BrickGrid grid;
    const int size = volume::brick_size_for(volume.grid.dims);
    const Samples building =
        processor_time(repeats, [&](int) { grid = volume::summarise(volume, 0, size, 1, 0.0F); });
    lab.add({.group = "skipping",
             .name = "building the bricks, once a volume",
             .samples = building,
             .value = static_cast<double>(volume.grid.voxel_count()) / (1e3 * works(building).median),
             .unit = "M voxels/s"});
    // Rays of most pictures go one or two ways, of those along an axis four, of eyes inside all eight.
    volume::SkipMap map;
    for (const std::size_t ways : {1, 4, 8}) {
        const Samples edit = processor_time(repeats, [&](int i) {
            const float low = 100.0F + static_cast<float>(i % 20);
            const std::array<volume::StoredRange, 1> visible{{{low, 255.0F}}};
            const std::array<volume::BrickLayer, 1> layers{{{&grid, visible}}};
            map.update(layers, {{}, volume.grid.dims}, {}, 100 * ways + static_cast<std::uint64_t>(i));
            for (std::size_t way = 0; way < ways; ++way) {
                (void)map.cubes(way);
            }
        });
        lab.add({.group = "skipping",
                 .name = "after an edit: what is seen, rays that go " + std::to_string(ways) + " of 8 ways",
                 .samples = edit,
                 .ceiling = "2 ms",
                 .base = Samples(edit.size(), {2.0, 2.0}),
                 .goal = ways == 8 ? std::nullopt : std::optional(1.0)});
    }
}

}  // namespace

void run_skipping(Lab& lab) {
    const double scale = lab.hardware() ? 1.0 : 0.5;  // unskipped rays through 256^3 take their time
    VolumeScene scene(lab, "head");
    scene.view({{"eye_mm", {360, -490, 300}}, {"target_mm", {0, 0, 0}}, {"vertical_fov_deg", 30}});
    scene.change(
        {{"volume", {{"$ref", nullptr}, {"host", "clusters"}}},
         {"shading", nullptr},
         {"transfer_function",
          {{"points",
            {{{"value", 40}, {"opacity", 0.0}, {"colour", {1, 0.8, 0.6}}},
             {{"value", 200}, {"opacity", 0.02}, {"colour", {0.9, 0.9, 1}}}}}}},
         {"sampling", {{"scheme", "gauss"}, {"step", 0.5}, {"termination", 0.0}, {"tolerance", 0.0}}}});
    const std::vector<Variant> variants{{"off", {{"sampling", {{"skip", false}}}}},
                                        {"on", {{"sampling", {{"skip", true}}}}}};
    const std::vector<float> distance = distances_to_balls();
    const std::vector<float> least = with_neighbours(distance);
    const std::map<int, double> goals{{100, 1.03}, {25, 1 / 2.5}, {5, 1 / 6.0}};
    for (const int percent : {100, 50, 25, 5, 0}) {
        const LiveVolume volume(clusters(distance, least, 0.01 * percent));
        const HostVolume host{"clusters", &volume};
        Stage stage(lab, scene.json(variants, "rgba16f", scale));
        stage.run([&](Frame& frame) {
            frame.volumes = std::span(&host, 1);
            nudge(frame);
        });
        const std::string name = std::to_string(percent) + " % occupied";
        const Samples& off = stage.pass(key(0));
        lab.add({.group = "skipping", .name = name + ", not skipped", .samples = off});
        Row row{.group = "skipping", .name = name + ", skipped", .samples = stage.pass_or_none(key(1))};
        if (row.samples.empty()) {
            row.value = 0.0;
            row.unit = "passes drawn: nothing is to be seen";
        } else {
            row.error = largest_difference(stage.read(key(0)), stage.read(key(1)));
            row.error_of = "not skipped";
            row.ceiling = "not skipped";
            row.base = off;
            if (const auto goal = goals.find(percent); goal != goals.end()) {
                row.goal = goal->second;
            }
        }
        lab.add(std::move(row));
        if (percent == 25) {
            processor_work(lab, volume.volume());
        }
    }
}

}  // namespace viscera::app
