#pragma once

#include <optional>
#include <string>
#include <vector>

#include "effects/volume/classic.h"
#include "effects/volume/isosurface.h"
#include "effects/volume/look.h"
#include "effects/volume/mixed.h"
#include "effects/volume/sampling.h"
#include "effects/volume/source.h"
#include "effects/volume/transfer_params.h"

namespace viscera::volume {

enum class RayFunction { composite, mip, minip, average, xray, isosurface, accumulate, density };
[[nodiscard]] std::span<const std::string_view> choice_names(RayFunction function);
/// accumulate and density are marched as composite, with transfer functions of their own.
[[nodiscard]] RayFunction marched_as(RayFunction function);

/// Part of the volume that is shown [voxels], a box; size 0 of an axis: all of it.
struct CropParams {
    glm::dvec3 first{0.0};
    glm::dvec3 size{0.0};

    void visit(ParamVisitor& v);
};

/// How a film or a digital detector shows what it has received: by its logarithm, over a range.
struct FilmParams {
    double from = 0.0;  ///< optical depth that is shown as none
    double to = 4.5;    ///< and as all absorbed, > from

    void visit(ParamVisitor& v);
};

struct XrayParams {
    double water_attenuation_per_mm = 0.02;
    double incident = 1.0;
    bool negative = true;
    std::optional<FilmParams> film;  ///< none: the intensity itself

    void visit(ParamVisitor& v);
    /// Throws Error(scene).
    void validate() const;
};

/// Only the first part of each ray: from where it starts, at a drawn surface (sampling.limits), a clip plane
/// or the box.
struct SubVolumeParams {
    double depth_mm = 10.0;

    void visit(ParamVisitor& v);
};

struct RayCastParams {
    SourceParams volume;
    std::optional<RayFunction> function;
    TransferParams transfer_function;
    SamplingParams sampling;
    std::optional<MixedParams> mixed;
    CropParams crop;
    std::optional<SubVolumeParams> sub_volume;
    XrayParams xray;
    std::optional<double> threshold;
    IsosurfaceParams isosurface;
    AccumulateParams accumulate;
    DensityParams density;
    LookParams look;

    void visit(ParamVisitor& v);
};

}  // namespace viscera::volume
