#include "effects/volume/derived_source.h"

#include <utility>

namespace viscera::volume {

std::vector<VoxelBox> DerivedSource::changes(const Source& voxels, bool& everything) const {
    return voxels.changes_since(version_, everything);
}

void DerivedSource::replace(Volume volume) {
    if (live_ == nullptr) {
        live_ = std::make_unique<LiveVolume>(std::move(volume));
    } else {
        live_->replace(std::move(volume));
    }
}

void DerivedSource::settle(const Source& voxels, const VolumeStatistics& statistics) {
    version_ = voxels.version();
    source_.live = live_.get();
    source_.statistics = statistics;
}

}  // namespace viscera::volume
