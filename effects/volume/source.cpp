#include "effects/volume/source.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/io/volume.h"

namespace viscera::volume {
namespace {

/// Of one channel. Throws Error(scene) where there is none of the number.
VolumeStatistics channel_statistics(const Volume& volume, int channel) {
    if (channel >= volume.channels) {
        throw Error(ErrorCode::scene, "/volume/channel",
                    volume.source + " has no channel " + std::to_string(channel) + ", only " +
                        std::to_string(volume.channels));
    }
    return statistics(volume, channel);
}

std::uint64_t key_of(const GeometryParams& g) {
    return Hash()
        .add(g.kind)
        .add(g.r_min_mm)
        .add(g.r_max_mm)
        .add(g.first_angle_deg)
        .add(g.angle_deg)
        .add(g.wrap)
        .add(g.height_mm)
        .add(g.latitude_deg)
        .value();
}

/// A file, with the geometry that the scene gives it.
Volume load_file(Assets& assets, const SourceParams& params) {
    io::VolumeOptions options{.progress = assets.progress("loading " + params.file.path.filename().string()),
                              .reduce = params.reduce};
    if (params.geometry) {
        options.regrid = [&](const VolumeGrid& grid) { return params.geometry->applied_to(grid); };
    }
    return io::load_volume(params.file.path, options, assets.log());
}

/// One object for all versions, or each would leave another behind.
std::shared_ptr<const Source> live_source(Assets& assets, const LiveVolume& live, int channel) {
    const std::uint64_t key = Hash().add(&live).value();
    const std::shared_ptr<Source> source = assets.shared<Source>(Hash().add(key).add(channel).value(),
                                                                 [] { return std::make_shared<Source>(); });
    if (source->statistics_version == live.version()) {
        return source;
    }
    const Volume& volume = live.volume();
    const double least = source->statistics.min;
    source->statistics = channel_statistics(volume, channel);
    if (source->statistics.min != least && source->statistics.non_finite > 0) {
        source->filler_version = live.version();
    }
    report_no_numbers(volume, source->statistics.non_finite, assets.log());
    source->live = &live;
    source->key = key;
    source->statistics_version = live.version();
    return source;
}

}  // namespace

std::uint64_t Source::state_key() const {
    return Hash().add(key).add(version()).value();
}

double Source::filler() const {
    const Volume& shown = volume();
    return (statistics.min - shown.intercept) / shown.slope;
}

std::vector<VoxelBox> Source::changes_since(std::uint64_t version, bool& everything) const {
    everything = true;
    if (live == nullptr || version == 0 || version < filler_version) {
        return {};
    }
    return live->changes_since(version, everything);
}

void SourceParams::visit(ParamVisitor& v) {
    v.field({.name = "file", .doc = "Volume file, or folder of slices."}, file);
    v.field(
        {.name = "host", .doc = "Name of a volume that the host gives with each frame, instead of a file."},
        host);
    v.field({.name = "reduce",
             .doc = "This many voxels of each axis become one, for what is too large.",
             .min = 1,
             .max = 64},
            reduce);
    v.field({.name = "channel", .doc = "Channel of a volume that has several.", .min = 0, .max = 3}, channel);
    v.field(
        {.name = "storage",
         .doc = "A 3-D texture, or slices side by side in 2-D textures (atlas), which hold longer volumes; "
                "automatic: a 3-D texture while it fits."},
        storage);
    v.field({.name = "geometry",
             .doc = "What the file's axes run along, where it does not say so itself, or instead of that."},
            geometry);
    v.field({.name = "placement", .doc = "Where the volume is put."}, placement);
}

void SourceParams::validate() const {
    if (file.empty() == host.empty()) {
        throw Error(ErrorCode::scene, "/volume", "needs either a file or a host's volume");
    }
    if (geometry && !host.empty()) {
        throw Error(ErrorCode::scene, "/volume/geometry", "a host's volume has its geometry in its grid");
    }
    if (geometry) {
        geometry->validate("/volume/geometry");
    }
}

std::shared_ptr<const Source> load_source(Assets& assets, const SourceParams& params, const Frame& frame) {
    if (!params.host.empty()) {
        const auto found = std::ranges::find(frame.volumes, params.host, &HostVolume::name);
        if (found == frame.volumes.end() || found->volume == nullptr) {
            return nullptr;
        }
        return live_source(assets, *found->volume, params.channel);
    }
    const std::uint64_t key = Hash()
                                  .add(assets.file_key(params.file.path))
                                  .add(params.reduce)
                                  .add(params.channel)
                                  .add(params.geometry ? key_of(*params.geometry) : 0)
                                  .value();
    return assets.shared<Source>(key, [&] {
        auto source = std::make_shared<Source>();
        source->owned = std::make_shared<const Volume>(load_file(assets, params));
        source->statistics = channel_statistics(*source->owned, params.channel);
        source->key = key;
        return source;
    });
}

glm::dmat4 placed(const VolumeGrid& grid, const PlacementParams& placement) {
    const glm::dmat4 to_world = grid.box_to_world();
    const glm::dvec3 centre = to_world * glm::dvec4(0.5, 0.5, 0.5, 1.0);
    return placement_matrix(placement, centre) * to_world;
}

}  // namespace viscera::volume
