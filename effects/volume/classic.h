#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/transfer_function.h"

namespace viscera::volume {

/// Opacity by value: value v, as a share of the range that the volume spans, has colour
/// (v + brightness) contrast and opacity v * opacity / samples in a step of 1 / samples of the box's
/// diagonal.
struct AccumulateParams {
    /// One channel of colour data.
    struct Channel {
        glm::dvec2 threshold{0.0, 1.0};

        void visit(ParamVisitor& v);
    };
    double opacity = 10.0;
    double samples = 256.0;
    double brightness = 0.0;
    double contrast = 1.0;
    glm::dvec2 threshold{0.0, 1.0};
    std::vector<Channel> channels;  ///< empty: the one channel that the source names

    [[nodiscard]] bool colours() const { return !channels.empty(); }
    void visit(ParamVisitor& v);
    /// Throws Error(scene): one channel only, or more than four.
    void validate() const;
};

/// One density for all that is seen: wherever the transfer function, taken at value * scale, is not
/// transparent and the value reaches `iso`.
struct DensityParams {
    double density = 0.05;
    double reference_length_mm = 1.0;
    double scale = 1.0;
    std::optional<double> iso;
    double brightness = 1.0;

    void visit(ParamVisitor& v);
};

/// `accumulate` and `density` of one channel are composition with another transfer function, which these
/// give, so that schemes, skipping and shading serve them too. Colours are cut to [0, 1].
[[nodiscard]] TransferFunction accumulate_function(const AccumulateParams& params, double low, double high,
                                                   double diagonal_mm);
/// `function`: normalised.
[[nodiscard]] TransferFunction density_function(const TransferFunction& function,
                                                const DensityParams& params);

}  // namespace viscera::volume
