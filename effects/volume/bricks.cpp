#include "effects/volume/bricks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/pixel_index.h"

namespace viscera::volume {
namespace {

/// Lower each element of `low` and raise each of `high` to the values beside them. Rows instead of single
/// bricks, so that the compiler makes vector code of it.
template <typename T>
void widen(std::size_t count, const T* smaller, const T* greater, T* low, T* high) {
    for (std::size_t i = 0; i < count; ++i) {
        low[i] = std::min(low[i], smaller[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
        high[i] = std::max(high[i], greater[i]);
    }
}

/// One channel of `row.size()` voxels that lie side by side from `first` on, all of them in the volume.
template <typename T>
void load_inside(const Volume& volume, const glm::ivec3& first, int channel, float empty,
                 std::vector<T>& row) {
    const auto channels = static_cast<std::size_t>(volume.channels);
    const std::byte* source =
        volume.voxels.data() +
        (voxel_index(first, volume.grid.dims) * channels + static_cast<std::size_t>(channel)) * sizeof(T);
    if (channels == 1) {
        std::memcpy(row.data(), source, row.size() * sizeof(T));
    } else {
        for (std::size_t i = 0; i < row.size(); ++i) {
            std::memcpy(&row[i], source + i * channels * sizeof(T), sizeof(T));
        }
    }
    if constexpr (std::is_floating_point_v<T>) {
        for (T& value : row) {
            value = is_number(value) ? value : empty;
        }
    }
}

int on_ring(int voxel, int count) {
    const int rest = voxel % count;
    return rest < 0 ? rest + count : rest;
}

/// The same, where the ring along `ring` (-1: none) goes on beyond the volume. `whole`: room for a line of x.
template <typename T>
void load_row(const Volume& volume, glm::ivec3 first, int ring, int channel, float empty,
              std::vector<T>& whole, std::vector<T>& row) {
    const int nx = volume.grid.dims.x;
    if (ring > 0) {
        first[ring] = on_ring(first[ring], volume.grid.dims[ring]);
    }
    if (ring != 0 || (first.x >= 0 && first.x + static_cast<int>(row.size()) <= nx)) {
        return load_inside(volume, first, channel, empty, row);
    }
    whole.resize(static_cast<std::size_t>(nx));
    load_inside(volume, {0, first.y, first.z}, channel, empty, whole);
    for (std::size_t i = 0; i < row.size(); ++i) {
        row[i] = whole[static_cast<std::size_t>(on_ring(first.x + static_cast<int>(i), nx))];
    }
}

/// Ranges of the bricks of a box, axis by axis: slices of a layer into a plane, lines of the plane into a
/// line, voxels of the line into bricks.
template <typename T>
void summarise_as(BrickGrid& bricks, const Volume& volume, int channel, float empty, const VoxelBox& box,
                  const glm::ivec3& border, const Progress& progress) {
    const int ring = bricks.rows.wrap ? bricks.rows.angle_axis : -1;
    const auto first_voxel = [&](const glm::ivec3& brick) {
        const glm::ivec3 first = brick * bricks.size - border;
        glm::ivec3 inside = glm::max(first, glm::ivec3(0));
        if (ring >= 0) {
            inside[ring] = first[ring];
        }
        return inside;
    };
    const auto end_voxel = [&](const glm::ivec3& brick) {
        const glm::ivec3 end = glm::min((brick + 1) * bricks.size, volume.grid.dims) + border;
        glm::ivec3 inside = glm::min(end, volume.grid.dims);
        if (ring >= 0) {
            inside[ring] = end[ring];
        }
        return inside;
    };
    const glm::ivec3 end_brick = box.first + box.size;
    const glm::ivec3 first = first_voxel(box.first);
    const glm::ivec3 end = end_voxel(end_brick - 1);
    const auto width = static_cast<std::size_t>(end.x - first.x);
    const std::size_t area = width * static_cast<std::size_t>(end.y - first.y);
    constexpr T greatest = std::numeric_limits<T>::max();
    constexpr T least = std::numeric_limits<T>::lowest();
    std::vector<T> row(width);
    std::vector<T> whole;
    std::vector<T> plane_low(area);
    std::vector<T> plane_high(area);
    std::vector<T> line_low(width);
    std::vector<T> line_high(width);

    glm::ivec3 brick = box.first;
    for (brick.z = box.first.z; brick.z < end_brick.z; ++brick.z) {
        std::fill(plane_low.begin(), plane_low.end(), greatest);
        std::fill(plane_high.begin(), plane_high.end(), least);
        for (int z = first_voxel(brick).z; z < end_voxel(brick).z; ++z) {
            for (int y = first.y; y < end.y; ++y) {
                load_row(volume, {first.x, y, z}, ring, channel, empty, whole, row);
                const std::size_t begin = width * static_cast<std::size_t>(y - first.y);
                widen(width, row.data(), row.data(), &plane_low[begin], &plane_high[begin]);
            }
        }
        for (brick.y = box.first.y; brick.y < end_brick.y; ++brick.y) {
            std::fill(line_low.begin(), line_low.end(), greatest);
            std::fill(line_high.begin(), line_high.end(), least);
            for (int y = first_voxel(brick).y; y < end_voxel(brick).y; ++y) {
                const std::size_t begin = width * static_cast<std::size_t>(y - first.y);
                widen(width, &plane_low[begin], &plane_high[begin], line_low.data(), line_high.data());
            }
            for (brick.x = box.first.x; brick.x < end_brick.x; ++brick.x) {
                const int begin = first_voxel(brick).x - first.x;
                const int stop = end_voxel(brick).x - first.x;
                const std::size_t i = voxel_index(brick, bricks.dims);
                bricks.min[i] =
                    static_cast<float>(*std::min_element(line_low.begin() + begin, line_low.begin() + stop));
                bricks.max[i] = static_cast<float>(
                    *std::max_element(line_high.begin() + begin, line_high.begin() + stop));
            }
        }
        if (progress && !progress((brick.z + 1 - box.first.z) / static_cast<double>(box.size.z))) {
            throw Error(ErrorCode::usage, volume.source, "cancelled");
        }
    }
}

void summarise_box(BrickGrid& bricks, const Volume& volume, int channel, float empty, const VoxelBox& box,
                   const glm::ivec3& border, const Progress& progress) {
    switch (volume.type) {
        case ScalarType::u8:
            return summarise_as<std::uint8_t>(bricks, volume, channel, empty, box, border, progress);
        case ScalarType::i8:
            return summarise_as<std::int8_t>(bricks, volume, channel, empty, box, border, progress);
        case ScalarType::u16:
            return summarise_as<std::uint16_t>(bricks, volume, channel, empty, box, border, progress);
        case ScalarType::i16:
            return summarise_as<std::int16_t>(bricks, volume, channel, empty, box, border, progress);
        case ScalarType::f32:
            return summarise_as<float>(bricks, volume, channel, empty, box, border, progress);
    }
}

/// Which of some bricks meet a range.
void mark_visible(std::span<const float> min, std::span<const float> max,
                  std::span<const StoredRange> visible, float overshoot, std::span<std::uint8_t> occupied) {
    for (const StoredRange& range : visible) {
        for (std::size_t i = 0; i < occupied.size(); ++i) {
            const float beyond = overshoot * (max[i] - min[i]);
            const auto below = static_cast<unsigned>(min[i] - beyond <= range.high);
            const auto above = static_cast<unsigned>(max[i] + beyond >= range.low);
            occupied[i] = static_cast<std::uint8_t>(occupied[i] | (below & above));
        }
    }
}

void check(const Volume& volume, int channel, int size, int border) {
    if (channel < 0 || channel >= volume.channels) {
        throw Error(ErrorCode::usage, volume.source, "there is no channel " + std::to_string(channel));
    }
    if (size < 1 || border < 0) {
        throw Error(ErrorCode::usage, volume.source,
                    "bricks need a size of 1 or more and no negative border");
    }
}

BrickGrid grid_of(const Volume& volume, int size, int border) {
    BrickGrid bricks{.dims = (volume.grid.dims + size - 1) / size, .size = size, .border = border};
    const std::size_t count = voxel_index(bricks.dims - 1, bricks.dims) + 1;
    bricks.min.resize(count);
    bricks.max.resize(count);
    return bricks;
}

/// Calls visit(bricks of the row, its border) for each row.
template <class Visit>
void each_row(const BrickGrid& bricks, const Visit& visit) {
    const glm::ivec3 n = bricks.dims;
    std::size_t row = 0;
    if (bricks.rows.angle_axis == 1) {
        for (int x = 0; x < n.x; ++x) {
            visit(VoxelBox{{x, 0, 0}, {1, n.y, n.z}}, bricks.rows.borders.at(row++));
        }
        return;
    }
    for (int z = 0; z < n.z; ++z) {
        for (int y = 0; y < n.y; ++y) {
            visit(VoxelBox{{0, y, z}, {n.x, 1, 1}}, bricks.rows.borders.at(row++));
        }
    }
}

/// Bricks of a row whose ranges include one of the voxels from `first` to `last`; size 0 where none does.
VoxelBox touched_of(const BrickGrid& bricks, const VoxelBox& row, const glm::ivec3& border,
                    const glm::ivec3& first, const glm::ivec3& last, const glm::ivec3& dims) {
    glm::ivec3 low = glm::max(first - border, glm::ivec3(0)) / bricks.size;
    glm::ivec3 high = glm::min((last + border) / bricks.size, bricks.dims - 1);
    const int ring = bricks.rows.wrap ? bricks.rows.angle_axis : -1;
    if (ring >= 0 && (first[ring] < border[ring] || last[ring] + border[ring] >= dims[ring])) {
        low[ring] = 0;  // across the seam
        high[ring] = bricks.dims[ring] - 1;
    }
    low = glm::max(low, row.first);
    high = glm::min(high, row.first + row.size - 1);
    return glm::any(glm::lessThan(high, low)) ? VoxelBox{} : VoxelBox{low, high - low + 1};
}

}  // namespace

int brick_size_for(const glm::ivec3& dims) {
    constexpr int least = 3;
    constexpr double most_bricks = 1 << 21;
    constexpr int most_along_axis = 1024;
    const auto fits = [&](int size) {
        const glm::ivec3 bricks = (dims - 1) / size + 1;
        return std::max({bricks.x, bricks.y, bricks.z}) <= most_along_axis &&
               static_cast<double>(bricks.x) * bricks.y * bricks.z <= most_bricks;
    };
    int size = least;
    while (!fits(size)) {
        ++size;
    }
    return size;
}

BrickGrid summarise(const Volume& volume, int channel, int size, int border, float empty,
                    const Progress& progress) {
    check(volume, channel, size, border);
    BrickGrid bricks = grid_of(volume, size, border);
    summarise_box(bricks, volume, channel, empty, {glm::ivec3(0), bricks.dims}, glm::ivec3(border), progress);
    return bricks;
}

BrickGrid summarise(const Volume& volume, int channel, int size, BrickRows rows, float empty,
                    const Progress& progress) {
    check(volume, channel, size, 0);
    BrickGrid bricks = grid_of(volume, size, 0);
    bricks.rows = std::move(rows);
    double done = 0.0;
    each_row(bricks, [&](const VoxelBox& row, const glm::ivec3& border) {
        summarise_box(bricks, volume, channel, empty, row, border, {});
        done += 1.0;
        if (progress && !progress(done / static_cast<double>(bricks.rows.borders.size()))) {
            throw Error(ErrorCode::usage, volume.source, "cancelled");
        }
    });
    return bricks;
}

VoxelBox resummarise(BrickGrid& bricks, const Volume& volume, int channel, float empty, const VoxelBox& box) {
    const glm::ivec3 first = glm::max(box.first, glm::ivec3(0));
    const glm::ivec3 last = glm::min(box.first + box.size, volume.grid.dims) - 1;
    if (glm::any(glm::lessThan(last, first))) {
        return {};
    }
    if (bricks.rows.angle_axis >= 0) {
        each_row(bricks, [&](const VoxelBox& row, const glm::ivec3& border) {
            const VoxelBox touched = touched_of(bricks, row, border, first, last, volume.grid.dims);
            if (touched.size != glm::ivec3(0)) {
                summarise_box(bricks, volume, channel, empty, touched, border, {});
            }
        });
        return {glm::ivec3(0), bricks.dims};
    }
    const glm::ivec3 first_brick = glm::max(first - bricks.border, glm::ivec3(0)) / bricks.size;
    const glm::ivec3 last_brick = glm::min((last + bricks.border) / bricks.size, bricks.dims - 1);
    const VoxelBox touched{first_brick, last_brick - first_brick + 1};
    summarise_box(bricks, volume, channel, empty, touched, glm::ivec3(bricks.border), {});
    return touched;
}

void find_occupied(const BrickGrid& bricks, std::span<const StoredRange> visible, const VoxelBox& crop,
                   std::vector<std::uint8_t>& occupied, float overshoot) {
    occupied.assign(bricks.count(), 0);
    glm::ivec3 first(0);
    glm::ivec3 end = bricks.dims;
    if (crop.size != glm::ivec3(0)) {
        first = glm::max(crop.first, glm::ivec3(0)) / bricks.size;
        end = glm::min((crop.first + crop.size + bricks.size - 1) / bricks.size, bricks.dims);
        if (glm::any(glm::lessThanEqual(crop.size, glm::ivec3(0)))) {
            return;
        }
    }
    if (glm::any(glm::lessThanEqual(end, first))) {
        return;
    }
    const auto width = static_cast<std::size_t>(end.x - first.x);
    for (int z = first.z; z < end.z; ++z) {
        for (int y = first.y; y < end.y; ++y) {
            const std::size_t begin = voxel_index({first.x, y, z}, bricks.dims);
            mark_visible({&bricks.min[begin], width}, {&bricks.max[begin], width}, visible, overshoot,
                         {&occupied[begin], width});
        }
    }
}

double occupancy(std::span<const std::uint8_t> occupied) {
    std::size_t count = 0;
    for (const std::uint8_t brick : occupied) {
        count += brick != 0 ? 1U : 0U;
    }
    return occupied.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(occupied.size());
}

}  // namespace viscera::volume
