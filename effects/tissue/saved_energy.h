#pragma once

#include <memory>
#include <optional>

#include "engine/core/image.h"
#include "engine/core/params.h"

namespace viscera {
class Assets;
}

namespace viscera::tissue {

/// A state to begin with: a target that an earlier run wrote.
struct SavedEnergyParams {
    AssetPath file;
    std::optional<double> time_s;

    void visit(ParamVisitor& v);
};

struct SavedEnergy {
    Image image;                   ///< r32f, the values as they were written
    std::optional<double> time_s;  ///< of the frame that wrote it
};

/// The picture of an EXR file that `viscera render --dump` wrote; of a file with several, the one that is
/// named `tissue.energy`. What is not finite becomes 0, with a fault. Throws Error(file), Error(scene) for
/// another size than `size` texels, for more than one channel, and for several pictures without that name.
[[nodiscard]] std::shared_ptr<const SavedEnergy> load_energy(Assets& assets, const SavedEnergyParams& params,
                                                             int size);

}  // namespace viscera::tissue
