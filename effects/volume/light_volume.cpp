#include "effects/volume/light_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/pixel_index.h"

namespace viscera::volume {
namespace {

constexpr int samples_per_axis = 4;

template <class Visit>
void each_cell(const glm::ivec3& dims, Visit visit) {
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            for (int x = 0; x < dims.x; ++x) {
                visit(glm::ivec3(x, y, z));
            }
        }
    }
}

/// Towards the faces and corners of a cube: evenly spread, the same from all sides.
std::vector<glm::dvec3> all_around() {
    std::vector<glm::dvec3> directions;
    for (int a = 0; a < 3; ++a) {
        glm::dvec3 axis(0.0);
        axis[a] = 1.0;
        directions.push_back(axis);
        directions.push_back(-axis);
    }
    for (int i = 0; i < 8; ++i) {
        directions.push_back(glm::normalize(glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
    }
    return directions;
}

/// Cells along the sides of a box, `resolution` along the longest, no more than `most`.
glm::ivec3 cells_of(const glm::dmat4& box_to_world, int resolution, const glm::ivec3& most) {
    glm::dvec3 sides;
    for (int a = 0; a < 3; ++a) {
        sides[a] = glm::length(glm::dvec3(box_to_world[a]));
    }
    const double longest = std::max({sides.x, sides.y, sides.z});
    glm::ivec3 dims;
    for (int a = 0; a < 3; ++a) {
        dims[a] = std::clamp(static_cast<int>(std::lround(resolution * sides[a] / longest)), 1,
                             std::min(resolution, most[a]));
    }
    return dims;
}

}  // namespace

void LightVolumeParams::visit(ParamVisitor& v) {
    v.field({.name = "shadow",
             .doc = "How dark the volume's shadow on itself is, of the first light; 0: none is computed.",
             .min = 0.0,
             .max = 1.0},
            shadow);
    v.field({.name = "ambient_occlusion",
             .doc = "How much of the ambient light what is around a place keeps from it; 0: nothing.",
             .min = 0.0,
             .max = 1.0},
            ambient_occlusion);
    v.field({.name = "resolution",
             .doc = "Cells along the longest side of the grid that the light is computed on.",
             .min = 2,
             .max = 96},
            resolution);
    v.field({.name = "radius_mm",
             .doc = "How far away what occludes the ambient light may be.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            radius_mm);
}

double ExtinctionGrid::at(const glm::dvec3& texture) const {
    const glm::dvec3 last = glm::dvec3(dims - 1);
    const glm::dvec3 place = glm::clamp(texture * glm::dvec3(dims) - 0.5, glm::dvec3(0.0), last);
    const glm::ivec3 low = glm::ivec3(place);
    const glm::ivec3 high = glm::min(low + 1, dims - 1);
    const glm::dvec3 t = place - glm::dvec3(low);
    double sum = 0.0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
        const double weight =
            (i & 1 ? t.x : 1.0 - t.x) * (i & 2 ? t.y : 1.0 - t.y) * (i & 4 ? t.z : 1.0 - t.z);
        sum += weight * static_cast<double>(per_mm[voxel_index(corner, dims)]);
    }
    return sum;
}

VoxelExtinction of_values(const Volume& volume, int channel, std::function<double(double value)> extinction) {
    return [&volume, channel, extinction = std::move(extinction)](const glm::ivec3& voxel) {
        const double stored = volume.stored(voxel, channel);
        return is_number(stored) ? extinction(volume.value_of(stored)) : 0.0;
    };
}

ExtinctionGrid extinction_grid(const glm::ivec3& voxels, const glm::dmat4& texture_to_world, int resolution,
                               const VoxelExtinction& extinction) {
    ExtinctionGrid grid{.dims = cells_of(texture_to_world, resolution, voxels),
                        .texture_to_world = texture_to_world};
    each_cell(grid.dims, [&](const glm::ivec3& cell) {
        const glm::ivec3 first = cell * voxels / grid.dims;
        const glm::ivec3 size = (cell + 1) * voxels / grid.dims - first;
        const glm::ivec3 count = glm::min(size, glm::ivec3(samples_per_axis));
        double sum = 0.0;
        each_cell(count,
                  [&](const glm::ivec3& i) { sum += extinction(first + (2 * i + 1) * size / (2 * count)); });
        grid.per_mm.push_back(static_cast<float>(sum / (count.x * count.y * count.z)));
    });
    return grid;
}

ExtinctionGrid extinction_in_box(const VolumeGrid& voxels, const glm::dmat4& box_to_world, int resolution,
                                 const VoxelExtinction& extinction) {
    ExtinctionGrid grid{.dims = cells_of(box_to_world, resolution, glm::ivec3(resolution)),
                        .texture_to_world = box_to_world};
    const glm::dmat4 to_unplaced = voxels.box_to_world();
    const int ring = voxels.shape.wrap_axis();
    each_cell(grid.dims, [&](const glm::ivec3& cell) {
        double sum = 0.0;
        each_cell(glm::ivec3(2), [&](const glm::ivec3& i) {
            const glm::dvec3 place = (glm::dvec3(cell) + 0.25 + 0.5 * glm::dvec3(i)) / glm::dvec3(grid.dims);
            glm::ivec3 voxel =
                glm::ivec3(glm::floor(voxels.index_of_world(to_unplaced * glm::dvec4(place, 1.0)) + 0.5));
            if (ring >= 0) {
                voxel[ring] = (voxel[ring] % voxels.dims[ring] + voxels.dims[ring]) % voxels.dims[ring];
            }
            if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
                glm::any(glm::greaterThanEqual(voxel, voxels.dims))) {
                return;
            }
            sum += extinction(voxel);
        });
        grid.per_mm.push_back(static_cast<float>(sum / 8.0));
    });
    return grid;
}

double transmittance(const ExtinctionGrid& grid, const glm::dvec3& texture, const glm::dvec3& towards,
                     double reach_mm) {
    const glm::dvec3 direction = glm::inverse(glm::dmat3(grid.texture_to_world)) * towards;  // per mm
    double length = reach_mm;
    double cells_per_mm = 0.0;
    for (int a = 0; a < 3; ++a) {
        if (direction[a] != 0.0) {
            const double face = direction[a] > 0.0 ? 1.0 : 0.0;
            length = std::min(length, std::max((face - texture[a]) / direction[a], 0.0));
            cells_per_mm = std::max(cells_per_mm, std::abs(direction[a]) * grid.dims[a]);
        }
    }
    // A surface lies within one cell; it must not darken itself.
    const double start = std::min(length, cells_per_mm > 0.0 ? 1.0 / cells_per_mm : 0.0);
    length -= start;
    const int steps = std::max(1, static_cast<int>(std::ceil(std::min(length * cells_per_mm, 4096.0))));
    double depth = 0.0;
    for (int k = 0; k < steps; ++k) {
        depth += grid.at(texture + direction * (start + length * (k + 0.5) / steps));
    }
    return std::exp(-depth * length / steps);
}

std::vector<glm::vec2> light_volume(const ExtinctionGrid& grid, const LightVolumeParams& params,
                                    const glm::dvec4& light) {
    const std::vector<glm::dvec3> around = all_around();
    std::vector<glm::vec2> result;
    each_cell(grid.dims, [&](const glm::ivec3& cell) {
        const glm::dvec3 texture = (glm::dvec3(cell) + 0.5) / glm::dvec3(grid.dims);
        glm::dvec2 arrives(1.0);
        if (params.shadow > 0.0) {
            glm::dvec3 way(light);
            double reach = std::numeric_limits<double>::infinity();
            if (light.w > 0.0) {
                way -= glm::dvec3(grid.texture_to_world * glm::dvec4(texture, 1.0));
                reach = glm::length(way);
            }
            const double length = std::max(glm::length(way), 1e-300);
            arrives.x -= params.shadow * (1.0 - transmittance(grid, texture, way / length, reach));
        }
        if (params.ambient_occlusion > 0.0) {
            double open = 0.0;
            for (const glm::dvec3& direction : around) {
                open += transmittance(grid, texture, direction, params.radius_mm);
            }
            arrives.y -= params.ambient_occlusion * (1.0 - open / static_cast<double>(around.size()));
        }
        result.emplace_back(arrives);
    });
    return result;
}

}  // namespace viscera::volume
