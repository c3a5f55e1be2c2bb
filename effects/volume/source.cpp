#include "effects/volume/source.h"

#include <algorithm>

#include "engine/core/hash.h"
#include "engine/io/volume.h"

namespace viscera::volume {

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
    v.field({.name = "placement", .doc = "Where the volume is put."}, placement);
}

std::shared_ptr<const Source> load_source(Assets& assets, const SourceParams& params, const Frame& frame) {
    if (!params.host.empty()) {
        const auto found = std::ranges::find(frame.volumes, params.host, &HostVolume::name);
        if (found == frame.volumes.end() || found->volume == nullptr) {
            return nullptr;
        }
        const std::uint64_t key = Hash().add(found->volume).add(found->volume->version()).value();
        return assets.shared<Source>(key, [&] {
            auto source = std::make_shared<Source>();
            source->live = found->volume;
            source->statistics = statistics(found->volume->volume(), params.channel);
            source->key = Hash().add(found->volume).value();
            return source;
        });
    }
    const std::uint64_t key =
        Hash().add(params.file.path.string()).add(params.reduce).add(params.channel).value();
    return assets.shared<Source>(key, [&] {
        auto source = std::make_shared<Source>();
        source->owned = std::make_shared<const Volume>(
            io::load_volume(params.file.path,
                            {.progress = assets.progress("loading " + params.file.path.filename().string()),
                             .reduce = params.reduce},
                            assets.log()));
        source->statistics =
            statistics(*source->owned, std::min(params.channel, source->owned->channels - 1));
        source->key = key;
        return source;
    });
}

glm::dmat4 placed(const VolumeGrid& grid, const PlacementParams& placement) {
    const glm::dmat4 to_world = grid.texture_to_world();
    const glm::dvec3 centre = to_world * glm::dvec4(0.5, 0.5, 0.5, 1.0);
    return placement_matrix(placement, centre) * to_world;
}

}  // namespace viscera::volume
