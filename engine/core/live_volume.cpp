#include <algorithm>
#include <atomic>
#include <cstring>

#include "engine/core/error.h"
#include "engine/core/volume.h"

namespace viscera {

namespace {

/// Versions are unlike over all volumes, so that a renderer which is given another one notices.
std::uint64_t next_version() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

bool is_inside(const VoxelBox& box, const glm::ivec3& dims) {
    for (int axis = 0; axis < 3; ++axis) {
        if (box.first[axis] < 0 || box.size[axis] < 0 || box.first[axis] > dims[axis] - box.size[axis]) {
            return false;
        }
    }
    return true;
}

}  // namespace

LiveVolume::LiveVolume(Volume volume) {
    replace(std::move(volume));
}

void LiveVolume::replace(Volume volume) {
    volume.validate();
    volume_ = std::move(volume);
    version_ = next_version();
    whole_version_ = version_;
    changes_.clear();
}

void LiveVolume::update(const VoxelBox& region, std::span<const std::byte> data) {
    const glm::ivec3 dims = volume_.grid.dims;
    if (!is_inside(region, dims)) {
        throw Error(ErrorCode::usage, volume_.source, "update: the box leaves the volume");
    }
    const glm::u64vec3 size(region.size);
    const std::size_t voxel_bytes = static_cast<std::size_t>(volume_.channels) * bytes_of(volume_.type);
    const std::size_t row_bytes = size.x * voxel_bytes;
    if (data.size() != row_bytes * size.y * size.z) {
        throw Error(ErrorCode::usage, volume_.source,
                    "update: " + std::to_string(data.size()) + " bytes where " +
                        std::to_string(row_bytes * size.y * size.z) + " are due");
    }
    if (data.empty()) {
        return;
    }
    const glm::u64vec3 first(region.first);
    const glm::u64vec3 whole(dims);
    const std::byte* row = data.data();
    for (std::size_t z = first.z; z < first.z + size.z; ++z) {
        for (std::size_t y = first.y; y < first.y + size.y; ++y, row += row_bytes) {
            const std::size_t voxel = (z * whole.y + y) * whole.x + first.x;
            std::memcpy(volume_.voxels.data() + voxel * voxel_bytes, row, row_bytes);
        }
    }
    if (changes_.size() == kept_changes) {
        whole_version_ = changes_.front().version;
        changes_.erase(changes_.begin());
    }
    version_ = next_version();
    changes_.push_back({version_, region});
}

std::vector<VoxelBox> LiveVolume::changes_since(std::uint64_t version, bool& everything) const {
    auto after = changes_.begin();
    if (version != whole_version_) {
        after = std::ranges::find(changes_, version, &Change::version);
        everything = after == changes_.end();
        if (everything) {
            return {};
        }
        ++after;
    }
    everything = false;
    std::vector<VoxelBox> boxes;
    std::ranges::transform(after, changes_.end(), std::back_inserter(boxes), &Change::box);
    return boxes;
}

}  // namespace viscera
