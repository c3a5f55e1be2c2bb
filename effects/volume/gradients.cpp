#include "effects/volume/gradients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "effects/volume/derived_source.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/pixel_index.h"

namespace viscera::volume {
namespace {

constexpr double greatest_stored = 32767.0;

/// Voxels of one channel, slice by slice, each decoded once.
class Slices {
  public:
    Slices(const Volume& volume, int channel, float empty)
        : volume_(volume), channel_(channel), empty_(empty) {}

    /// A slice of all of the volume; valid for the last three that were asked for.
    const std::vector<float>& at(int z) {
        const auto slot = static_cast<std::size_t>(z % 3);
        if (numbers_.at(slot) != z) {
            decode(z, slices_.at(slot));
            numbers_.at(slot) = z;
        }
        return slices_.at(slot);
    }

  private:
    void decode(int z, std::vector<float>& slice) const {
        const glm::ivec3 n = volume_.grid.dims;
        slice.resize(static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y));
        std::size_t i = 0;
        for (int y = 0; y < n.y; ++y) {
            for (int x = 0; x < n.x; ++x, ++i) {
                const auto stored = static_cast<float>(volume_.stored({x, y, z}, channel_));
                slice[i] = is_number(stored) ? stored : empty_;
            }
        }
    }

    const Volume& volume_;
    int channel_;
    float empty_;
    std::array<std::vector<float>, 3> slices_;
    std::array<int, 3> numbers_{-1, -1, -1};
};

/// Calls visit(gradient) for each voxel of a box, x fastest.
template <class Visit>
void each_gradient(const Volume& volume, int channel, float empty, const VoxelBox& box,
                   const Progress& progress, const Visit& visit) {
    const glm::ivec3 n = volume.grid.dims;
    const int ring = volume.grid.shape.wrap_axis();
    const auto beside = [&](int i, int axis) {
        return axis == ring ? (i + n[axis]) % n[axis] : std::clamp(i, 0, n[axis] - 1);
    };
    Slices slices(volume, channel, empty);
    for (int z = box.first.z; z < box.first.z + box.size.z; ++z) {
        const std::vector<float>& below = slices.at(beside(z - 1, 2));
        const std::vector<float>& here = slices.at(z);
        const std::vector<float>& above = slices.at(beside(z + 1, 2));
        for (int y = box.first.y; y < box.first.y + box.size.y; ++y) {
            const auto row = [&](int line) {
                return static_cast<std::size_t>(line) * static_cast<std::size_t>(n.x);
            };
            const float* along = &here[row(y)];
            const float* front = &here[row(beside(y - 1, 1))];
            const float* back = &here[row(beside(y + 1, 1))];
            for (int x = box.first.x; x < box.first.x + box.size.x; ++x) {
                const std::size_t at = row(y) + static_cast<std::size_t>(x);
                visit(0.5F * glm::vec3(along[beside(x + 1, 0)] - along[beside(x - 1, 0)], back[x] - front[x],
                                       above[at] - below[at]));
            }
        }
        if (progress && !progress((z + 1 - box.first.z) / static_cast<double>(box.size.z))) {
            throw Error(ErrorCode::usage, volume.source, "cancelled");
        }
    }
}

/// Gradients that follow the volume they are made from.
struct Gradients : DerivedSource {
    using DerivedSource::DerivedSource;
    float greatest = 0.0F;  ///< component when all were last made; 32767 texel units
    int top = 0;            ///< greatest component that there is still [texel units]
};

/// The greatest component in a box of what was made [texel units].
int greatest_texel(const Volume& made, const VoxelBox& box) {
    int greatest = 0;
    for (int z = box.first.z; z < box.first.z + box.size.z; ++z) {
        for (int y = box.first.y; y < box.first.y + box.size.y; ++y) {
            const std::byte* at =
                made.voxels.data() + voxel_index({box.first.x, y, z}, made.grid.dims) * sizeof(glm::i16vec4);
            for (int x = 0; x < box.size.x; ++x, at += sizeof(glm::i16vec4)) {
                glm::i16vec4 texel;
                std::memcpy(&texel, at, sizeof texel);
                greatest = std::max(
                    {greatest, std::abs(int{texel.x}), std::abs(int{texel.y}), std::abs(int{texel.z})});
            }
        }
    }
    return greatest;
}

float greatest_in(const Volume& volume, int channel, float empty, const VoxelBox& box,
                  const Progress& progress) {
    float greatest = 0.0F;
    each_gradient(volume, channel, empty, box, progress, [&](const glm::vec3& g) {
        greatest = std::max({greatest, std::abs(g.x), std::abs(g.y), std::abs(g.z)});
    });
    return std::min(greatest, std::numeric_limits<float>::max());
}

std::vector<std::byte> encoded(const Volume& volume, int channel, float empty, const VoxelBox& box,
                               float greatest, const Progress& progress) {
    const auto size = glm::tvec3<std::size_t>(box.size);
    std::vector<std::byte> result(size.x * size.y * size.z * sizeof(glm::i16vec4));
    std::byte* to = result.data();
    constexpr float least = 1e-30F;  // of which 32767 parts a float still tells apart
    const float scale = greatest > least ? static_cast<float>(greatest_stored) / greatest : 0.0F;
    each_gradient(volume, channel, empty, box, progress, [&](const glm::vec3& g) {
        const glm::vec3 scaled =
            glm::clamp(g * scale, -static_cast<float>(greatest_stored), static_cast<float>(greatest_stored));
        const glm::i16vec4 texel(glm::i16vec3(glm::round(scaled)), 0);
        std::memcpy(to, &texel, sizeof(texel));
        to += sizeof(texel);
    });
    return result;
}

/// A box with a voxel around it, all around a ring.
VoxelBox grown(const VoxelBox& box, const VolumeGrid& grid) {
    glm::ivec3 first = glm::max(box.first - 1, glm::ivec3(0));
    glm::ivec3 end = glm::min(box.first + box.size + 1, grid.dims);
    if (const int ring = grid.shape.wrap_axis(); ring >= 0) {
        first[ring] = 0;
        end[ring] = grid.dims[ring];
    }
    return {first, end - first};
}

void follow(Assets& assets, Gradients& made, const Source& voxels, int channel) {
    const Volume& volume = voxels.volume();
    const auto empty = static_cast<float>(voxels.filler());
    bool everything = true;
    std::vector<VoxelBox> changed = made.changes(voxels, everything);
    for (VoxelBox& box : changed) {
        box = grown(box, volume.grid);
        everything = everything || greatest_in(volume, channel, empty, box, {}) > made.greatest;
    }
    const VoxelBox all{glm::ivec3(0), volume.grid.dims};
    if (!everything) {
        int lost = 0;
        int gained = 0;
        for (const VoxelBox& box : changed) {
            lost = std::max(lost, greatest_texel(made.source().volume(), box));
            made.update(box, encoded(volume, channel, empty, box, made.greatest, {}));
            gained = std::max(gained, greatest_texel(made.source().volume(), box));
        }
        // A steep place that is gone would leave few steps to all others: two bits less are too few.
        made.top = gained < made.top && lost >= made.top ? greatest_texel(made.source().volume(), all)
                                                         : std::max(made.top, gained);
        everything = made.greatest > 0.0F && made.top < static_cast<int>(greatest_stored) / 4;
    }
    if (everything) {
        const Progress progress =
            assets.progress("differentiating " + std::filesystem::path(volume.source).filename().string());
        const auto half = [&](double from) {
            return progress ? Progress([=](double done) { return progress(from + 0.5 * done); }) : Progress();
        };
        made.greatest = greatest_in(volume, channel, empty, all, half(0.0));
        made.replace(
            {.grid = volume.grid,
             .type = ScalarType::i16,
             .channels = 4,
             .voxels = encoded(volume, channel, empty, all, made.greatest, half(0.5)),
             .slope = made.greatest > 0.0F ? static_cast<double>(made.greatest) / greatest_stored : 1.0,
             .source = volume.source});
        made.top = static_cast<int>(greatest_stored);
    }
    made.settle(voxels, {});
}

}  // namespace

std::shared_ptr<const Source> load_gradients(Assets& assets, const Source& source, int channel) {
    const std::uint64_t key = Hash().add("gradients").add(source.key).add(channel).value();
    return load_derived<Gradients>(assets, key, source,
                                   [&](Gradients& made) { follow(assets, made, source, channel); });
}

}  // namespace viscera::volume
