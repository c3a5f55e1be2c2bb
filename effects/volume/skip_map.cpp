#include "effects/volume/skip_map.h"

#include <algorithm>
#include <cstdlib>

#include "engine/core/hash.h"

namespace viscera::volume {

std::shared_ptr<Bricks> load_bricks(Assets& assets, const Source& source, int channel, int size, int border) {
    const std::uint64_t key = Hash().add(source.key).add(channel).add(size).add(border).value();
    const Volume& volume = source.volume();
    const auto empty =
        static_cast<float>((source.statistics.min - volume.intercept) / volume.slope);  // as in the texture
    const std::shared_ptr<Bricks> bricks =
        assets.shared<Bricks>(key, [] { return std::make_shared<Bricks>(); });
    if (bricks->version == source.version()) {
        return bricks;
    }
    bool everything = true;
    std::vector<VoxelBox> changed;
    if (source.live != nullptr && bricks->version != 0) {
        changed = source.live->changes_since(bricks->version, everything);
    }
    if (everything) {
        bricks->grid = summarise(volume, channel, size, border, empty);
    }
    for (const VoxelBox& box : changed) {
        resummarise(bricks->grid, volume, channel, empty, box);
    }
    bricks->version = source.version();
    return bricks;
}

void SkipMap::update(const BrickGrid& bricks, std::span<const StoredRange> visible, const VoxelBox& crop,
                     std::uint64_t key) {
    if (key == key_) {
        return;
    }
    key_ = key;
    dims_ = bricks.dims;
    find_occupied(bricks, visible, crop, occupied_);
    occupancy_ = volume::occupancy(occupied_);
    signed_distance(dims_, occupied_, distance_, scratch_);
    std::ranges::transform(distance_, occupied_.begin(), [](std::int8_t d) {
        return static_cast<std::uint8_t>(std::abs(static_cast<int>(d)) + (d < 0 ? 128 : 0));
    });
}

const gl::Texture& SkipMap::texture(const gl::Functions& gl) {
    const gl::Extent extent{dims_.x, dims_.y, dims_.z};
    if (!texture_ || texture_->extent() != extent) {
        texture_.emplace(gl::Texture::make_3d(gl, extent, gl::r8ui_format, "distances of bricks"));
        uploaded_ = 0;
    }
    if (uploaded_ != key_) {
        texture_->upload(std::as_bytes(std::span(occupied_)));
        uploaded_ = key_;
    }
    return *texture_;
}

}  // namespace viscera::volume
