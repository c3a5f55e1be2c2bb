#include "effects/volume/source.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "engine/core/hash.h"
#include "engine/io/volume.h"

namespace viscera::volume {

void PlacementParams::visit(ParamVisitor& v) {
    v.field({.name = "move_mm", .doc = "Moves the volume in the world.", .unit = "mm"}, move_mm);
    v.field({.name = "rotate_deg",
             .doc = "Turns the volume about its centre: about the world's x axis, then y, then z.",
             .unit = "degree"},
            rotate_deg);
    v.field({.name = "scale",
             .doc = "Scales the volume about its centre along the world's axes; negative: mirrored."},
            scale);
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
            io::load_volume(params.file.path, {.reduce = params.reduce}, assets.log()));
        source->statistics =
            statistics(*source->owned, std::min(params.channel, source->owned->channels - 1));
        source->key = key;
        return source;
    });
}

glm::dmat4 placed(const VolumeGrid& grid, const PlacementParams& placement) {
    const glm::dmat4 to_world = grid.texture_to_world();
    const glm::dvec3 centre = to_world * glm::dvec4(0.5, 0.5, 0.5, 1.0);
    glm::dmat4 m = glm::translate(glm::dmat4(1.0), placement.move_mm + centre);
    m = glm::rotate(m, glm::radians(placement.rotate_deg.z), glm::dvec3(0, 0, 1));
    m = glm::rotate(m, glm::radians(placement.rotate_deg.y), glm::dvec3(0, 1, 0));
    m = glm::rotate(m, glm::radians(placement.rotate_deg.x), glm::dvec3(1, 0, 0));
    m = glm::scale(m, placement.scale);
    return glm::translate(m, -centre) * to_world;
}

bool invertible(const glm::dmat4& matrix) {
    const glm::dmat3 m(matrix);
    const double product = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
    const double volume = std::abs(glm::determinant(m));
    return std::isfinite(product) && product > 0.0 && volume > 1e-9 * product &&
           std::isfinite(glm::dot(glm::dvec3(matrix[3]), glm::dvec3(1.0)));
}

}  // namespace viscera::volume
