#include "assets/generate/volume_cryosections.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "engine/core/pixel_index.h"

namespace viscera::assets {
namespace {

/// A colour at a CT number.
struct Stop {
    double hu;
    glm::dvec3 colour;
};

constexpr glm::dvec3 fat(0.86, 0.70, 0.34);
constexpr glm::dvec3 skin(0.78, 0.53, 0.43);
constexpr glm::dvec3 muscle(0.54, 0.16, 0.13);
constexpr glm::dvec3 marrow(0.58, 0.27, 0.21);
constexpr glm::dvec3 compact_bone(0.94, 0.89, 0.77);
constexpr glm::dvec3 white_matter(0.90, 0.81, 0.70);
constexpr glm::dvec3 gray_matter(0.68, 0.50, 0.44);

constexpr Stop soft[] = {{-180.0, skin}, {-125.0, fat}, {-40.0, fat}, {20.0, skin}, {55.0, muscle}};
constexpr Stop bones[] = {{250.0, marrow}, {550.0, marrow}, {1100.0, compact_bone}};
constexpr Stop nerves[] = {{26.0, white_matter}, {40.0, gray_matter}};
constexpr Stop fluids[] = {{0.0, {0.30, 0.34, 0.36}}};
constexpr Stop eyeballs[] = {{10.0, {0.35, 0.40, 0.42}}, {55.0, {0.90, 0.90, 0.88}}};
constexpr Stop enamel[] = {{900.0, {0.90, 0.83, 0.66}}, {2000.0, {0.97, 0.96, 0.92}}};
constexpr Stop blood[] = {{0.0, {0.28, 0.02, 0.03}}};

std::span<const Stop> stops_of(std::uint8_t label) {
    switch (label) {
        case skull:
        case mandible:
        case vertebrae:
            return bones;
        case brain:
        case cerebellum:
            return nerves;
        case ventricles:
            return fluids;
        case eyes:
            return eyeballs;
        case teeth:
            return enamel;
        case bleed:
            return blood;
        default:
            return soft;
    }
}

glm::dvec3 colour_at(double hu, std::uint8_t label) {
    if (label == no_label) {
        return glm::dvec3(0.0);
    }
    const std::span<const Stop> stops = stops_of(label);
    const auto right = std::ranges::upper_bound(stops, hu, {}, &Stop::hu);
    if (right == stops.begin() || right == stops.end()) {
        return right == stops.end() ? stops.back().colour : right->colour;
    }
    const Stop& left = *std::prev(right);
    return glm::mix(left.colour, right->colour, (hu - left.hu) / (right->hu - left.hu));
}

}  // namespace

Volume make_cryosections(const HeadVolumes& head) {
    constexpr int fine = 2;  // voxels of the CT along each side of a voxel
    Volume sections{.grid = head.ct.grid, .type = ScalarType::u8, .channels = 3};
    sections.grid.dims /= fine;
    sections.grid.spacing_mm *= fine;
    sections.grid.origin_mm += 0.5 * (sections.grid.spacing_mm - head.ct.grid.spacing_mm);
    glm::ivec3 v;
    for (v.z = 0; v.z < sections.grid.dims.z; ++v.z) {
        for (v.y = 0; v.y < sections.grid.dims.y; ++v.y) {
            for (v.x = 0; v.x < sections.grid.dims.x; ++v.x) {
                glm::dvec3 sum(0.0);
                for (int i = 0; i < fine * fine * fine; ++i) {
                    const glm::ivec3 at = fine * v + glm::ivec3(i & 1, (i >> 1) & 1, i >> 2);
                    const std::size_t voxel = voxel_index(at, head.ct.grid.dims);
                    std::int16_t hu = 0;
                    std::memcpy(&hu, head.ct.voxels.data() + voxel * sizeof hu, sizeof hu);
                    sum += colour_at(hu, static_cast<std::uint8_t>(head.labels.voxels[voxel]));
                }
                const glm::dvec3 mean = sum / static_cast<double>(fine * fine * fine);
                for (int c = 0; c < 3; ++c) {
                    sections.voxels.push_back(static_cast<std::byte>(std::lround(255.0 * mean[c])));
                }
            }
        }
    }
    return sections;
}

}  // namespace viscera::assets
