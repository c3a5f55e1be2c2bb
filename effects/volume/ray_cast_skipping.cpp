#include <algorithm>
#include <cmath>
#include <limits>

#include "effects/volume/colours.h"
#include "effects/volume/ray_cast_effect.h"
#include "engine/core/hash.h"

// What of the volume need not be looked at: which values can be seen, and thus which bricks.
namespace viscera::volume {

/// Stored numbers that can change the picture; empty where every number can.
std::vector<StoredRange> RayCastEffect::visible() const {
    const Volume& volume = source_->volume();
    const TexelMap map{volume.slope, volume.intercept};
    const double a = map.texel_of(source_->statistics.min);
    const double b = map.texel_of(source_->statistics.max);
    const TexelRange all{std::min(a, b), std::max(a, b)};
    const int entries = params_.transfer_function.entries;
    // Where the table's nearest entry decides, it decides here, too.
    const bool nearest = !params_.transfer_function.interpolate && volume.slope * (b - a) != 0.0 &&
                         (projects() || params_.sampling.scheme != Scheme::preintegrated);
    const TexelMap texels = texel_map(sampled_->volume().type);
    std::vector<StoredRange> shown = nearest
                                         ? stored_ranges(table_of_texel(texels), texel_range(texels), texels)
                                         : stored_ranges(function_, map, all, entries);
    if (!projects()) {
        look_.widen(params_.look, function_, map, all, entries, shown);
    }
    const auto at_least = [&](double value) {
        const double stored = map.texel_of(value);
        const double slack = 1e-6 * (1.0 + std::abs(stored));
        constexpr float far = std::numeric_limits<float>::infinity();
        return volume.slope > 0.0 ? StoredRange{static_cast<float>(stored - slack), far}
                                  : StoredRange{-far, static_cast<float>(stored + slack)};
    };
    switch (variant_.function) {
        case RayFunction::composite:
        case RayFunction::accumulate:
        case RayFunction::density:
            return shown;
        case RayFunction::isosurface:
            return stored_ranges(params_.isosurface, map);
        case RayFunction::xray:
            return {at_least(-1000.0)};
        case RayFunction::average:
            return params_.threshold ? std::vector{at_least(*params_.threshold)} : std::vector<StoredRange>{};
        case RayFunction::mip:
        case RayFunction::minip:
            break;
    }
    // What is not seen may be left out of an extreme only when nothing that is seen is overruled by it.
    const bool upwards = (variant_.function == RayFunction::mip) == (volume.slope > 0.0);
    if (shown.empty()) {
        return {{0.0F, -1.0F}};
    }
    if (shown.size() == 1 && (upwards ? std::isinf(shown[0].high) : std::isinf(shown[0].low))) {
        return shown;
    }
    return {};
}

/// The stored numbers of each channel of colours (effects/volume/colours.h) that are not dropped.
std::vector<StoredRange> RayCastEffect::visible_colours() const {
    const Volume& colours = sampled_->volume();
    const TexelMap stored{colours.slope, colours.intercept};
    const ColourLimits limits = colour_limits(params_.accumulate);
    constexpr double slack = 1.0 / 65535.0;
    std::vector<StoredRange> ranges;
    for (int c = 0; c < 4; ++c) {
        ranges.push_back({static_cast<float>(stored.texel_of(limits.low[c] - slack)),
                          static_cast<float>(stored.texel_of(limits.high[c] + slack))});
    }
    // No opacity, nothing to be seen.
    ranges[3].low = std::max(ranges[3].low, std::numeric_limits<float>::min());
    return ranges;
}

/// How much colour and opacity change from the least stored number up to each, for long slabs.
SmoothRule RayCastEffect::smooth_rule() const {
    const Volume& volume = source_->volume();
    const TexelMap map{volume.slope, volume.intercept};
    const double a = map.texel_of(source_->statistics.min);
    const double b = map.texel_of(source_->statistics.max);
    double diagonal_mm = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        diagonal_mm += glm::length(glm::dvec3(space_.box_to_world()[axis]));
    }
    return make_smooth_rule(extinction_knots(function_, map, {std::min(a, b), std::max(a, b)}),
                            std::min(a, b), std::max(a, b), diagonal_mm, params_.sampling.tolerance,
                            lattice_.slab_mm / (brick_size_ * voxel_spacing_mm(space_)));
}

/// Finds which bricks show anything; false when none does.
bool RayCastEffect::find_bricks(Prepare& prepare) {
    variant_.skipping = Skipping::none;
    if (!params_.sampling.skip) {
        return true;
    }
    brick_size_ = space_.shape.curvilinear() ? curvilinear_brick_size : brick_size_for(space_.dims);
    // The rule knows of the transfer function alone.
    const bool adaptive = params_.sampling.tolerance > 0.0 && !projects() && !shows_colours() &&
                          !params_.look.used(variant_.look);
    const std::uint64_t visible_key =
        Hash().add(parameters_key_).add(source_->version()).add(lattice_.slab_mm).value();
    if (visible_key_ != visible_key) {
        visible_ = shows_colours() ? visible_colours() : visible();
        smooth_ = adaptive ? smooth_rule() : SmoothRule{};
        visible_key_ = visible_key;
    }
    if (visible_.empty() && projects()) {
        return true;
    }
    // A cell or slab belongs to the brick of its middle; reconstruction needs voxels beyond.
    const ReconstructionParams& filter = params_.sampling.reconstruction;
    BrickRows rows;
    const int border =
        static_cast<int>(std::ceil(reach(params_.sampling, lattice_) + filter.support_voxels()));
    if (space_.shape.curvilinear()) {
        // The four values that surfaces are looked for with span the slab. Places have rounding errors.
        const double share =
            variant_.function == RayFunction::isosurface ? 0.5 : reach_share(params_.sampling);
        rows = brick_rows(space_, brick_size_, std::max(share, 0.01) * lattice_.slab_local,
                          filter.support_voxels());
    }
    std::array<BrickLayer, 4> layers;
    const std::size_t count = shows_colours() ? layers.size() : 1;
    Hash hash;
    hash.add(visible_key);
    for (std::size_t i = 0; i < count; ++i) {
        const int channel = shows_colours() ? static_cast<int>(i) : sampled_channel_;
        bricks_[i] = load_bricks(prepare.assets(), *sampled_, channel, brick_size_, border, rows);
        hash.add(bricks_[i].get()).add(bricks_[i]->version);
        layers[i] = {&bricks_[i]->grid, visible_};
        if (shows_colours()) {
            layers[i].visible = layers[i].visible.subspan(i, 1);
        }
    }
    skip_map_.update(std::span(layers).first(count), crop_, smooth_, hash.value(),
                     filter.overshoot() + overshoot(params_.sampling));
    if (skip_map_.occupancy() == 0.0) {
        return false;
    }
    // Where nothing can be left out, looking for it only costs.
    if (adaptive && skip_map_.any_smooth()) {
        variant_.skipping = Skipping::adaptive;
    } else if (skip_map_.occupancy() < 0.98) {
        variant_.skipping = Skipping::empty;
    }
    return true;
}

/// The part of a box, in texture coordinates, outside which nothing is drawn.
Bounds RayCastEffect::seen_bounds(Bounds bounds) const {
    // An X-ray shows the whole box: what absorbs nothing is let through.
    if (variant_.skipping != Skipping::none && variant_.function != RayFunction::xray) {
        const glm::vec3 bricks = glm::vec3(source_->volume().grid.dims) / static_cast<float>(brick_size_);
        const VoxelBox& occupied = skip_map_.occupied_box();
        const FrameBox box = space_.box_of(glm::vec3(occupied.first) / bricks,
                                           glm::vec3(occupied.first + occupied.size) / bricks);
        bounds.min = glm::max(bounds.min, glm::vec3(box.min));
        bounds.max = glm::min(bounds.max, glm::vec3(box.max));
    }
    return bounds;
}

}  // namespace viscera::volume
