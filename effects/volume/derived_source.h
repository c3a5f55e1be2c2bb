#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "effects/volume/source.h"

namespace viscera::volume {

/// A volume that is made from another one and follows its changes: what prefilter, gradients and colours
/// have in common.
class DerivedSource {
  public:
    explicit DerivedSource(std::uint64_t key) { source_.key = key; }

    [[nodiscard]] const Source& source() const { return source_; }
    /// Whether it has been made from these voxels as they are now.
    [[nodiscard]] bool is_of(const Source& voxels) const { return version_ == voxels.version(); }
    /// Boxes of the voxels that have changed since; `everything`: all of them have, or nothing has been made
    /// yet.
    [[nodiscard]] std::vector<VoxelBox> changes(const Source& voxels, bool& everything) const;
    /// All of it anew.
    void replace(Volume volume);
    /// Part of it; `data` as LiveVolume::update() takes it.
    void update(const VoxelBox& box, std::span<const std::byte> data) { live_->update(box, data); }
    /// It is now made from these voxels.
    void settle(const Source& voxels, const VolumeStatistics& statistics);

  private:
    Source source_;
    std::unique_ptr<LiveVolume> live_;
    std::uint64_t version_ = 0;  ///< of the voxels
};

/// The derived volume that `assets` keeps under `key`, of the class `Derived`, up to date: `follow(derived)`
/// is called where the voxels have changed, and settles it.
template <class Derived, class Follow>
[[nodiscard]] std::shared_ptr<const Source> load_derived(Assets& assets, std::uint64_t key,
                                                         const Source& voxels, const Follow& follow) {
    const std::shared_ptr<Derived> derived =
        assets.shared<Derived>(key, [&] { return std::make_shared<Derived>(key); });
    if (!derived->is_of(voxels)) {
        follow(*derived);
    }
    return {derived, &derived->source()};
}

}  // namespace viscera::volume
