#pragma once

#include <memory>
#include <optional>
#include <string>

#include "effects/volume/atlas.h"
#include "effects/volume/geometry.h"
#include "engine/core/params.h"
#include "engine/core/placement.h"
#include "engine/core/volume.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/frame.h"

namespace viscera::volume {

/// Which volume is shown, and where.
struct SourceParams {
    AssetPath file;
    std::string host;  ///< name in Frame::volumes instead of a file
    int reduce = 1;
    int channel = 0;
    Storage storage = Storage::automatic;
    std::optional<GeometryParams> geometry;
    PlacementParams placement;

    void visit(ParamVisitor& v);
    /// Throws Error(scene): neither or both of file and host, a geometry that cannot be.
    void validate() const;
};

/// A volume with what is known of it, shared by all passes that show it.
struct Source {
    std::shared_ptr<const Volume> owned;  ///< from a file
    const LiveVolume* live = nullptr;     ///< or the host's
    VolumeStatistics statistics;
    std::uint64_t statistics_version = 0;  ///< of a host's volume when they were made
    std::uint64_t filler_version = 0;      ///< of a host's volume when its filler last changed
    std::uint64_t key = 0;                 ///< of the file and how it was read, or of the host's object

    [[nodiscard]] const Volume& volume() const { return owned ? *owned : live->volume(); }
    [[nodiscard]] std::uint64_t version() const { return live == nullptr ? 1 : live->version(); }
    /// Of the voxels as they are now.
    [[nodiscard]] std::uint64_t state_key() const;
    /// The stored number that stands for voxels that are no numbers: the least value's.
    [[nodiscard]] double filler() const;
    /// Boxes of a host's volume that have changed since it had another version (0: none yet). `everything`:
    /// all may have, also because what fills voxels that are no numbers is another value.
    [[nodiscard]] std::vector<VoxelBox> changes_since(std::uint64_t version, bool& everything) const;
};

/// Reads the file on first use. Null when the host gives no volume of the name. Throws Error(file),
/// Error(limit).
[[nodiscard]] std::shared_ptr<const Source> load_source(Assets& assets, const SourceParams& params,
                                                        const Frame& frame);

/// The unit box -> world (VolumeGrid::box_to_world) with the placement. The determinant may be negative.
[[nodiscard]] glm::dmat4 placed(const VolumeGrid& grid, const PlacementParams& placement);

}  // namespace viscera::volume
