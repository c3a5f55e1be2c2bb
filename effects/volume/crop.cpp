#include "effects/volume/crop.h"

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"

namespace viscera::volume {

CropBox crop_box(const CropParams& crop, const glm::ivec3& dims) {
    CropBox box;
    const glm::dvec3 n(dims);
    for (int a = 0; a < 3; ++a) {
        const double first = std::min(crop.first[a], n[a]);
        const double last = crop.size[a] > 0.0 ? std::min(first + crop.size[a], n[a]) : n[a];
        box.low[a] = first / n[a];
        box.high[a] = last / n[a];
        box.voxels.first[a] = static_cast<int>(std::floor(first));
        box.voxels.size[a] = static_cast<int>(std::ceil(last)) - box.voxels.first[a];
    }
    return box;
}

std::uint64_t limits_subject(const glm::dmat4& local_to_world, const CropParams* crop,
                             const glm::ivec3& dims) {
    Hash hash;
    hash.add(local_to_world);
    if (crop != nullptr) {
        const CropBox box = crop_box(*crop, dims);
        hash.add(box.low).add(box.high);
    }
    return hash.value();
}

}  // namespace viscera::volume
