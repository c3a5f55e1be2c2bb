#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/progress.h"
#include "engine/core/volume_shape.h"

namespace viscera {

class Log;

/// How a voxel lies in memory; little-endian.
enum class ScalarType { u8, i8, u16, i16, f32 };
[[nodiscard]] std::string_view to_string(ScalarType type);
[[nodiscard]] std::size_t bytes_of(ScalarType type);

/// Where voxels lie in the world: LPS patient axes, millimetres. A box, or the sector of a cylinder or sphere
/// that `shape` describes, whose frame `origin_mm` and `direction` put into the world.
struct VolumeGrid {
    glm::ivec3 dims{1};          ///< voxels per axis, >= 1
    glm::dvec3 spacing_mm{1.0};  ///< between voxel centres, > 0; curvilinear: not used
    glm::dvec3 origin_mm{0.0};   ///< centre of voxel (0, 0, 0); curvilinear: origin of the frame
    /// Columns: unit vectors along i, j and k. Need not be orthogonal (a tilted gantry shears), must not be
    /// singular.
    glm::dmat3 direction{1.0};
    VolumeShape shape{};

    [[nodiscard]] bool curvilinear() const { return shape.curvilinear(); }
    [[nodiscard]] std::size_t voxel_count() const;
    /// Index (i, j, k) -> world, Cartesian only. A voxel's centre has whole indices.
    [[nodiscard]] glm::dmat4 index_to_world() const;
    /// Texture coordinates -> world, Cartesian only. Voxel i's centre lies at (i + 0.5) / n, so the box [0,
    /// 1]^3 is dims * spacing large: each voxel owns a whole cell.
    [[nodiscard]] glm::dmat4 texture_to_world() const;
    /// Frame [mm] -> world, curvilinear only.
    [[nodiscard]] glm::dmat4 frame_to_world() const;
    /// The unit box -> world, of which the volume takes all (Cartesian: texture_to_world) or which lies
    /// closely around it in its frame.
    [[nodiscard]] glm::dmat4 box_to_world() const;
    /// Of that box.
    [[nodiscard]] double diagonal_mm() const;
    /// Any index -> world, and back; whole indices are voxel centres. Along a wrapping axis indices of the
    /// world lie within half the ring's gap of [0, n).
    [[nodiscard]] glm::dvec3 world_of_index(const glm::dvec3& index) const;
    [[nodiscard]] glm::dvec3 index_of_world(const glm::dvec3& world) const;
    /// Throws Error(file) at `where` that names the field: dims < 1, spacing or origin not finite, spacing <=
    /// 0, direction singular, shape as VolumeShape::validate.
    void validate(std::string_view where) const;

    bool operator==(const VolumeGrid&) const = default;
};

/// Part of a volume [voxels].
struct VoxelBox {
    glm::ivec3 first{0};
    glm::ivec3 size{0};
    bool operator==(const VoxelBox&) const = default;
};

/// A volume as it lies on disk: x fastest, index = x + y nx + z nx ny, channels of a voxel beside each other.
struct Volume {
    VolumeGrid grid;
    ScalarType type = ScalarType::u8;
    int channels = 1;               ///< 1 to 4
    std::vector<std::byte> voxels;  ///< voxel_count * channels * bytes_of(type)
    double slope = 1.0;             ///< value = slope * stored + intercept
    double intercept = 0.0;
    std::string unit;              ///< "HU" for CT, else empty
    double narrowing_error = 0.0;  ///< largest |f64 - f32| of a narrowed file, 0 otherwise
    std::string source;            ///< file or host name, for messages

    [[nodiscard]] double value_of(double stored) const { return slope * stored + intercept; }
    /// Stored number of a voxel as it is, without rescale.
    [[nodiscard]] double stored(const glm::ivec3& index, int channel = 0) const;
    /// Throws Error(file) unless the grid is valid, channels are 1 to 4, slope is finite and not 0, intercept
    /// is finite, and the voxels have exactly the size that the grid asks for.
    void validate() const;
};

/// Whether a stored number is one that is shown: finite, and so far from the ends of single precision that
/// filters can form sums and differences. Beyond lie what programs write where they have no value, such as
/// the greatest float. What is no number is counted, reported, and stays empty.
template <class T>
[[nodiscard]] constexpr bool is_number(T stored) {
    constexpr T greatest = static_cast<T>(1e36);
    return stored >= -greatest && stored <= greatest;
}

/// Says how many voxels are no numbers, as the fault "volume.non_finite"; nothing where all are.
void report_no_numbers(const Volume& volume, std::uint64_t count, Log& log);

/// What a volume's values are, rescaled; voxels that are no numbers are counted and left out.
struct VolumeStatistics {
    double min = 0.0;  ///< of the voxels that are numbers; 0 when there are none
    double max = 0.0;
    double mean = 0.0;
    std::size_t non_finite = 0;          ///< voxels that are no numbers
    std::vector<std::size_t> histogram;  ///< equal bins over [min, max]
};
/// One channel. bins >= 1.
[[nodiscard]] VolumeStatistics statistics(const Volume& volume, int channel = 0, int bins = 256);

/// The volume with every `factor` voxels of each axis averaged into one (the last may average fewer); labels
/// take the first voxel instead of a mean. Keeps the box in the world, but for the cut-off rest; curvilinear
/// shapes wholly (engine/core/volume_reduce_curvilinear.h). factor >= 1.
[[nodiscard]] Volume reduced(const Volume& volume, int factor, bool labels = false);

/// A volume that changes while it is shown. The host keeps it, passes it with each frame, and tells what it
/// changes; renderers upload and summarise only that.
class LiveVolume {
  public:
    /// Throws Error(file) as Volume::validate.
    explicit LiveVolume(Volume volume);

    [[nodiscard]] const Volume& volume() const { return volume_; }
    /// Replaces the voxels of a box. `data`: x fastest within the box, same type and channels. Throws
    /// Error(usage) when the box leaves the volume or the size is wrong; nothing is changed then.
    void update(const VoxelBox& region, std::span<const std::byte> data);
    /// Another volume altogether.
    void replace(Volume volume);
    /// Grows with each change; never 0, never the same for two LiveVolumes.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// Boxes changed after `version`; none when that is unknown or too long ago: then take everything.
    [[nodiscard]] std::vector<VoxelBox> changes_since(std::uint64_t version, bool& everything) const;

  private:
    struct Change {
        std::uint64_t version;
        VoxelBox box;
    };
    static constexpr std::size_t kept_changes = 64;
    Volume volume_;
    std::uint64_t version_ = 0;
    std::uint64_t whole_version_ = 0;  ///< of the last replacement
    std::vector<Change> changes_;
};

}  // namespace viscera
