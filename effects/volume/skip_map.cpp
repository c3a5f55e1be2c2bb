#include "effects/volume/skip_map.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numbers>

#include "engine/core/hash.h"
#include "engine/core/pixel_index.h"

namespace viscera::volume {

BrickRows brick_rows(const Space& space, int size, double reach, double support) {
    constexpr double rounding = 0.02;  // of places against brick faces [voxels], far more than there is
    const VolumeShape& shape = space.shape;
    const ShapeAxes axes = axes_of(shape, space.dims);
    const glm::ivec3 bricks = (space.dims + size - 1) / size;
    const bool spherical = shape.kind == VolumeKind::spherical;
    const int radial = shape.radius_axis();
    // Slabs reach across the seam of a full circle also where the samples there are no neighbours.
    const bool full = shape.angle_rad > 2.0 * std::numbers::pi - 1e-9;
    BrickRows rows{.angle_axis = shape.angle_axis(), .wrap = full};
    const auto voxels = [&](int axis, double way) {
        const bool ring = full && axis == rows.angle_axis;
        const double all = ring ? space.dims[axis] / 2 + 1 : space.dims[axis];
        return static_cast<int>(std::min(std::ceil(way / axes.step[axis] + support + rounding), all));
    };
    // The angle by which a way turns at most that passes a centre no nearer than its own length says.
    const auto turn = [&](double radius) { return radius > reach ? std::asin(reach / radius) : 4.0; };
    const auto low = [&](int axis, int brick) {
        return axes.first[axis] + axes.step[axis] * (brick * size - 1);
    };
    const auto add = [&](int y, int brick) {
        const double radius = std::max(low(radial, brick), shape.r_min_mm);
        glm::ivec3 border(0);
        border[radial] = voxels(radial, reach);
        double across = radius;
        if (spherical) {
            const double end = std::min(std::max(std::abs(low(1, y)), std::abs(low(1, y + 1) + axes.step[1])),
                                        0.5 * std::numbers::pi);
            across *= std::cos(end);
            border[1] = voxels(1, turn(radius));
        } else {
            border[2] = voxels(2, reach);
        }
        // Along a seam rounding decides on which side of it a place lies.
        border[rows.angle_axis] = voxels(rows.angle_axis, turn(across)) + (full && !shape.wrap ? 1 : 0);
        rows.borders.push_back(border);
    };
    for (int brick = 0; brick < bricks[radial]; ++brick) {
        for (int y = 0; y < (spherical ? bricks.y : 1); ++y) {
            add(y, brick);
        }
    }
    return rows;
}

std::shared_ptr<Bricks> load_bricks(Assets& assets, const Source& source, int channel, int size, int border,
                                    const BrickRows& rows) {
    Hash hash;
    hash.add(source.key).add(channel).add(size).add(border);
    for (const glm::ivec3& own : rows.borders) {
        hash.add(own);
    }
    const std::uint64_t key = hash.value();
    const Volume& volume = source.volume();
    const auto empty = static_cast<float>(source.filler());  // as in the texture
    const std::shared_ptr<Bricks> bricks =
        assets.shared<Bricks>(key, [] { return std::make_shared<Bricks>(); });
    if (bricks->version == source.version()) {
        return bricks;
    }
    bool everything = true;
    const std::vector<VoxelBox> changed = source.changes_since(bricks->version, everything);
    if (everything) {
        const Progress progress =
            assets.progress("summarising " + std::filesystem::path(volume.source).filename().string());
        bricks->grid = rows.angle_axis < 0 ? summarise(volume, channel, size, border, empty, progress)
                                           : summarise(volume, channel, size, rows, empty, progress);
    }
    for (const VoxelBox& box : changed) {
        resummarise(bricks->grid, volume, channel, empty, box);
    }
    bricks->version = source.version();
    return bricks;
}

SmoothRule make_smooth_rule(const ExtinctionKnots& knots, double low, double high, double way_mm,
                            double tolerance, double slab_bricks) {
    SmoothRule rule{.variation = std::vector<float>(table_entries)};
    double joined = 1.0;
    for (std::size_t i = 0; i < rule.most.size(); ++i) {
        joined *= 4.0;
        rule.most[i] = static_cast<float>(tolerance / std::max(joined * slab_bricks, 1.0));
        rule.reach[i] = static_cast<int>(std::min(std::ceil(0.5 * joined * slab_bricks), 1e3));
    }
    const double entries = table_entries - 1;
    rule.scale = high > low ? entries / (high - low) : 0.0;
    rule.offset = -low * rule.scale;
    double sum = 0.0;
    glm::dvec4 before = knots.classify(low);
    for (std::size_t i = 1; i < rule.variation.size(); ++i) {
        const glm::dvec4 here = knots.classify(low + (high - low) * static_cast<double>(i) / entries);
        const glm::dvec4 change = glm::abs(here - before);
        sum += change.a * way_mm + std::max({change.r, change.g, change.b});
        rule.variation[i] = static_cast<float>(sum);
        before = here;
    }
    return rule;
}

namespace {

/// The highest level that each occupied brick's own range allows, counted from 1; 0: none.
void find_levels(const BrickGrid& bricks, const SmoothRule& rule, float overshoot,
                 std::span<const std::uint8_t> occupied, std::vector<std::uint8_t>& smooth) {
    smooth.assign(occupied.size(), 0);
    const auto scale = static_cast<float>(rule.scale);
    const auto offset = static_cast<float>(rule.offset);
    const auto last = static_cast<float>(rule.variation.size() - 1);
    for (std::size_t i = 0; i < occupied.size(); ++i) {
        const float beyond = overshoot * (bricks.max[i] - bricks.min[i]);
        const auto from =
            static_cast<std::size_t>(std::clamp(scale * (bricks.min[i] - beyond) + offset, 0.0F, last));
        const auto to = static_cast<std::size_t>(
            std::clamp(scale * (bricks.max[i] + beyond) + offset + 1.0F, 0.0F, last));
        const float varies = rule.variation[to] - rule.variation[from];
        const auto level = std::ranges::count_if(rule.most, [&](float most) { return varies <= most; });
        smooth[i] = static_cast<std::uint8_t>(occupied[i] * level);
    }
}

/// Box around the bricks that are 1.
VoxelBox box_of_occupied(glm::ivec3 dims, std::span<const std::uint8_t> occupied) {
    glm::ivec3 low = dims;
    glm::ivec3 high(-1);
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            const std::uint8_t* row = &occupied[voxel_index({0, y, z}, dims)];
            // The first occupied brick of the row from x on, or -1: by far the fastest way to go through
            // bytes.
            const auto next = [&](int x) {
                const void* found = std::memchr(row + x, 1, static_cast<std::size_t>(dims.x - x));
                return found == nullptr ? -1
                                        : static_cast<int>(static_cast<const std::uint8_t*>(found) - row);
            };
            const int first = next(0);
            if (first < 0) {
                continue;
            }
            low = glm::min(low, glm::ivec3(first, y, z));
            high = glm::max(high, glm::ivec3(first, y, z));
            for (int x = next(high.x + 1); x >= 0; x = next(x + 1)) {
                high.x = x;
            }
        }
    }
    return high.x < 0 ? VoxelBox{} : VoxelBox{low, high - low + 1};
}

}  // namespace

void SkipMap::update(std::span<const BrickLayer> layers, const VoxelBox& crop, const SmoothRule& smooth,
                     std::uint64_t key, float overshoot) {
    if (key == key_) {
        return;
    }
    key_ = key;
    const BrickGrid& bricks = *layers.front().bricks;
    dims_ = bricks.dims;
    find_occupied(bricks, layers.front().visible, crop, occupied_, overshoot);
    for (const BrickLayer& layer : layers.subspan(1)) {
        find_occupied(*layer.bricks, layer.visible, crop, layer_, overshoot);
        std::ranges::transform(occupied_, layer_, occupied_.begin(), std::bit_and());
    }
    occupancy_ = volume::occupancy(occupied_);
    box_ = box_of_occupied(dims_, occupied_);
    kind_ = occupied_;
    const int kinds = find_smooth(bricks, smooth, overshoot);
    any_smooth_ = kinds > 2;
    curved_ = bricks.rows.angle_axis >= 0;
    if (!curved_) {
        return ahead_.take(dims_, kind_);
    }
    for (int kind = 0; kind < kinds; ++kind) {
        distance_to_others(dims_, kind_, kind, texels_, scratch_);
    }
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        texels_[i] = static_cast<std::uint8_t>(texels_[i] + kind_step * kind_[i]);
    }
}

/// Raises the kinds of bricks in which long slabs do; the number of kinds.
int SkipMap::find_smooth(const BrickGrid& bricks, const SmoothRule& rule, float overshoot) {
    if (rule.variation.empty()) {
        return 2;
    }
    find_levels(bricks, rule, overshoot, occupied_, smooth_);
    int kinds = 2;
    for (int level = 1; level <= slab_levels; ++level) {
        // Islands and holes of single bricks would end runs all the time: what is left is as thick as a slab.
        const int reach = rule.reach[static_cast<std::size_t>(level - 1)];
        if (reach >= distance_reach) {
            break;
        }
        opened_.resize(smooth_.size());
        for (std::size_t i = 0; i < smooth_.size(); ++i) {
            opened_[i] = static_cast<std::uint8_t>(smooth_[i] >= level);
        }
        distance_to_others(dims_, opened_, 1, distance_, scratch_);
        for (std::size_t i = 0; i < opened_.size(); ++i) {
            opened_[i] = static_cast<std::uint8_t>(opened_[i] != 0 && distance_[i] > reach);
        }
        distance_to_others(dims_, opened_, 0, distance_, scratch_);
        for (std::size_t i = 0; i < opened_.size(); ++i) {
            if (opened_[i] != 0 || distance_[i] <= reach) {
                kind_[i] = static_cast<std::uint8_t>(1 + level);
                kinds = 2 + level;
            }
        }
    }
    return kinds;
}

const gl::Texture& SkipMap::texture(const gl::Functions& gl, const Ways& ways) {
    const int blocks = curved_ ? 1 : 2;
    const gl::Extent extent{blocks * dims_.x, blocks * dims_.y, blocks * dims_.z};
    if (!texture_ || texture_->extent() != extent) {
        texture_.emplace(gl::Texture::make_3d(gl, extent, gl::r8ui_format, "distances of bricks"));
        uploaded_ = 0;
    }
    if (uploaded_ != key_) {
        held_.reset();
        if (curved_) {
            texture_->upload(std::as_bytes(std::span(texels_)));
        }
        uploaded_ = key_;
    }
    for (std::size_t way = 0; !curved_ && way < ways.size(); ++way) {
        if (ways[way] && !held_[way]) {
            const glm::ivec3 first = glm::ivec3(up_along(way)) * dims_;
            texture_->upload_region({first.x, first.y, first.z}, {dims_.x, dims_.y, dims_.z},
                                    std::as_bytes(cubes(way)));
            held_[way] = true;
        }
    }
    return *texture_;
}

}  // namespace viscera::volume
