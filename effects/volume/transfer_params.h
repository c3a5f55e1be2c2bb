#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/transfer_function.h"
#include "engine/runtime/assets.h"

namespace viscera::volume {

/// Colour and opacity over value, from one of: knots, a preset file, a named window of CT, a window.
struct TransferParams {
    std::vector<TransferPoint> points;
    std::vector<GradientPoint> gradient;
    double reference_length_mm = 1.0;
    AssetPath file;
    std::string preset;
    std::optional<WindowLevel> window;
    std::optional<glm::dvec2> range;
    int entries = 4096;
    bool interpolate = false;

    void visit(ParamVisitor& v);
    /// Throws Error(scene) when there is more than one source of knots.
    void validate() const;
    [[nodiscard]] bool empty() const;
};

/// The function that the parameters describe, not yet normalised. `presets`: content of the file, if there
/// is one. Knots given beside a file's (gradient) take the place of the file's. Throws Error(scene) for a
/// preset that does not exist, with the names of those that do.
[[nodiscard]] TransferFunction chosen_function(const TransferParams& params,
                                               std::span<const TransferFunction> presets);

/// As chosen_function, normalised, with the file read on first use; what was cut is told to the log.
[[nodiscard]] TransferFunction load_function(const TransferParams& params, Assets& assets);

/// Moves the knots from the range that they span to [range.x, range.y]; range.x > range.y turns them round.
[[nodiscard]] TransferFunction stretched(TransferFunction function, const glm::dvec2& range);

}  // namespace viscera::volume
