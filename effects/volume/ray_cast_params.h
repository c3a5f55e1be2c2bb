#pragma once

#include <optional>
#include <string>
#include <vector>

#include "effects/volume/source.h"
#include "effects/volume/transfer_params.h"

namespace viscera::volume {

enum class RayFunction { composite, mip, minip, average, xray };
[[nodiscard]] std::span<const std::string_view> choice_names(RayFunction function);

/// How a slab of the ray is integrated.
enum class Scheme { midpoint, gauss };
[[nodiscard]] std::span<const std::string_view> choice_names(Scheme scheme);

struct SamplingParams {
    double step = 0.5;
    Scheme scheme = Scheme::gauss;
    double termination = 1.0 / 512.0;
    bool skip = true;

    void visit(ParamVisitor& v);
};

/// Part of the volume that is shown [voxels], a box; size 0 of an axis: all of it.
struct CropParams {
    glm::dvec3 first{0.0};
    glm::dvec3 size{0.0};

    void visit(ParamVisitor& v);
};

struct XrayParams {
    double water_attenuation_per_mm = 0.02;
    double incident = 1.0;
    bool negative = true;

    void visit(ParamVisitor& v);
};

struct RayCastParams {
    SourceParams volume;
    std::optional<RayFunction> function;
    TransferParams transfer_function;
    SamplingParams sampling;
    CropParams crop;
    XrayParams xray;
    std::optional<double> threshold;

    void visit(ParamVisitor& v);
};

}  // namespace viscera::volume
