#include "effects/volume/colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "effects/volume/derived_source.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace viscera::volume {
namespace {

constexpr double most = 65535.0;

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    [[nodiscard]] bool holds(const Range& other) const { return other.low >= low && other.high <= high; }
};

/// Calls visit(voxel of the box, value of each channel).
template <class Visit>
void each_voxel(const Volume& volume, const VoxelBox& box, const Visit& visit) {
    std::array<double, 4> values{};
    std::size_t count = 0;
    for (int z = 0; z < box.size.z; ++z) {
        for (int y = 0; y < box.size.y; ++y) {
            for (int x = 0; x < box.size.x; ++x) {
                for (int c = 0; c < volume.channels; ++c) {
                    const double stored = volume.stored(box.first + glm::ivec3(x, y, z), c);
                    values[static_cast<std::size_t>(c)] = is_number(stored)
                                                              ? volume.value_of(stored)
                                                              : std::numeric_limits<double>::quiet_NaN();
                }
                visit(count++, values);
            }
        }
    }
}

Range range_of(const Volume& volume, const VoxelBox& box) {
    Range range;
    each_voxel(volume, box, [&](std::size_t, const std::array<double, 4>& values) {
        for (int c = 0; c < volume.channels; ++c) {
            const double value = values[static_cast<std::size_t>(c)];
            if (std::isfinite(value)) {
                range = {std::min(range.low, value), std::max(range.high, value)};
            }
        }
    });
    return range;
}

std::vector<std::byte> colours(const Volume& volume, const VoxelBox& box, const Range& range) {
    const auto size = glm::tvec3<std::size_t>(box.size);
    std::vector<std::byte> result(size.x * size.y * size.z * 4 * sizeof(std::uint16_t));
    const double width = range.high - range.low;
    const auto share = [&](double value) {
        return width > 0.0 && std::isfinite(value) ? most * (value - range.low) / width : 0.0;
    };
    each_voxel(volume, box, [&](std::size_t voxel, const std::array<double, 4>& values) {
        glm::dvec4 rgba(share(values[0]), share(values[1]), share(values[2]), share(values[3]));
        if (volume.channels == 2) {
            rgba = glm::dvec4(glm::dvec3(rgba.r), rgba.g);
        } else if (volume.channels == 3) {
            rgba.a = (rgba.r + rgba.g + rgba.b) / 3.0;
        }
        const glm::u16vec4 texel(glm::round(rgba));
        std::memcpy(result.data() + voxel * sizeof(texel), &texel, sizeof(texel));
    });
    return result;
}

/// Colours that follow the volume they are made from.
struct Colours : DerivedSource {
    using DerivedSource::DerivedSource;
    Range range;
};

/// Which ends of the range a box has had, by the colours that were made of it; too many rather than too few.
struct Ends {
    bool low = false;
    bool high = false;
};
Ends ends_in(const Volume& made, const VoxelBox& box) {
    Ends ends;
    each_voxel(made, box, [&](std::size_t, const std::array<double, 4>& shares) {
        for (const double share : shares) {
            ends.low = ends.low || share <= 0.0;
            ends.high = ends.high || share >= 1.0;
        }
    });
    return ends;
}

/// Whether all voxels may still have the range that the colours were made with.
bool keeps_range(const Colours& made, const Volume& volume, std::span<const VoxelBox> changed) {
    Ends lost;
    Range now;
    for (const VoxelBox& box : changed) {
        const Ends had = ends_in(made.source().volume(), box);
        const Range has = range_of(volume, box);
        lost = {lost.low || had.low, lost.high || had.high};
        now = {std::min(now.low, has.low), std::max(now.high, has.high)};
    }
    if (!made.range.holds(now)) {
        return false;
    }
    if ((lost.low && now.low > made.range.low) || (lost.high && now.high < made.range.high)) {
        now = range_of(volume, {glm::ivec3(0), volume.grid.dims});  // is it elsewhere, too?
        return now.low == made.range.low && now.high == made.range.high;
    }
    return true;
}

void follow(Colours& made, const Source& voxels) {
    const Volume& volume = voxels.volume();
    bool everything = true;
    const std::vector<VoxelBox> changed = made.changes(voxels, everything);
    if (everything || !keeps_range(made, volume, changed)) {
        const VoxelBox all{glm::ivec3(0), volume.grid.dims};
        made.range = range_of(volume, all);
        made.replace({.grid = volume.grid,
                      .type = ScalarType::u16,
                      .channels = 4,
                      .voxels = colours(volume, all, made.range),
                      .slope = 1.0 / most,
                      .source = volume.source});
    } else {
        for (const VoxelBox& box : changed) {
            made.update(box, colours(volume, box, made.range));
        }
    }
    made.settle(voxels, {.min = 0.0, .max = 1.0});
}

}  // namespace

std::shared_ptr<const Source> load_colours(Assets& assets, const Source& source, int channels) {
    const Volume& volume = source.volume();
    if (volume.channels != channels) {
        throw Error(ErrorCode::scene, "/accumulate/channels",
                    volume.source + " has " + std::to_string(volume.channels) + " channels, not " +
                        std::to_string(channels));
    }
    const std::uint64_t key = Hash().add("colours").add(source.key).value();
    return load_derived<Colours>(assets, key, source, [&](Colours& made) { follow(made, source); });
}

ColourLimits colour_limits(const AccumulateParams& params) {
    ColourLimits limits;
    const std::size_t count = params.channels.size();
    for (std::size_t c = 0; c < count; ++c) {
        const auto texel = static_cast<int>(count == 2 && c == 1 ? 3 : c);
        const glm::dvec2 threshold = params.channels[c].threshold;
        if (threshold.x > 0.0) {
            limits.low[texel] = threshold.x;
        }
        if (threshold.y < 1.0) {
            limits.high[texel] = threshold.y;
        }
    }
    return limits;
}

VoxelExtinction colour_extinction(const Volume& colours, const AccumulateParams& params, double diagonal_mm) {
    const double opacity = params.opacity / params.samples;
    const double per_mm = params.samples / diagonal_mm;
    return [&colours, opacity, per_mm, limits = colour_limits(params)](const glm::ivec3& voxel) {
        glm::dvec4 share;
        for (int c = 0; c < 4; ++c) {
            share[c] = colours.value_of(colours.stored(voxel, c));
        }
        constexpr double most_opacity = 1.0 - 0x1p-24;
        const bool kept = glm::all(glm::greaterThanEqual(share, limits.low)) &&
                          glm::all(glm::lessThanEqual(share, limits.high));
        return kept ? -std::log1p(-std::clamp(share.a * opacity, 0.0, most_opacity)) * per_mm : 0.0;
    };
}

}  // namespace viscera::volume
