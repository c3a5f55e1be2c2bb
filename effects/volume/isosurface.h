#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/classification.h"
#include "engine/core/params.h"
#include "engine/core/transfer_function.h"
#include "engine/gl/program.h"

namespace viscera::volume {

/// A surface of constant value.
struct IsoValue {
    double value = 0.0;
    glm::dvec3 colour{0.9, 0.85, 0.75};
    double opacity = 1.0;

    void visit(ParamVisitor& v);
};

struct IsosurfaceParams {
    std::vector<IsoValue> values;
    Lighting lighting;

    void visit(ParamVisitor& v);
};

inline constexpr std::size_t most_iso_values = 8;

/// Ranges of stored numbers that meet a surface: the iso values themselves, a rounding wide.
[[nodiscard]] std::vector<StoredRange> stored_ranges(const IsosurfaceParams& params,
                                                     const TexelMap& stored_to_value);
void add_defines(const IsosurfaceParams& params, bool refine, std::vector<std::string>& defines);
/// `texel_to_value`: of the texture.
void bind(const IsosurfaceParams& params, const TexelMap& texel_to_value, double termination,
          const gl::Program& program);

}  // namespace viscera::volume
