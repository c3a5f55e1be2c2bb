#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/light_volume.h"
#include "engine/core/camera.h"
#include "engine/core/transfer_function.h"
#include "engine/gl/program.h"

namespace viscera::volume {

/// A light: in a direction or at a place; neither: in the eye.
struct LightParams {
    std::optional<glm::dvec3> direction;
    std::optional<glm::dvec3> position_mm;
    glm::dvec3 colour{1.0};

    void visit(ParamVisitor& v);
    [[nodiscard]] bool at_eye() const { return !direction && !position_mm; }
    /// Towards the light, of length 1 (w 0), or its place [mm] (w 1).
    [[nodiscard]] glm::dvec4 place(const View& view) const;
};

/// Blinn-Phong shading by the gradient.
struct ShadingParams {
    std::optional<bool> enabled;       ///< unless given, as the transfer function's file asks
    std::optional<Lighting> lighting;  ///< unless given, the file's
    std::vector<LightParams> lights;   ///< none: one in the eye
    bool two_sided = true;
    LightVolumeParams light_volume;

    void visit(ParamVisitor& v);
    /// Throws Error(scene).
    void validate() const;
    [[nodiscard]] bool wanted(const TransferFunction& function) const {
        return enabled.value_or(function.shaded);
    }
    /// For glsl/volume/shading.glsl.
    [[nodiscard]] std::vector<std::string> defines() const;
    /// `value_rises`: whether values rise with stored numbers.
    void set(const gl::Program& program, const TransferFunction& function, const View& view,
             const glm::dmat4& local_to_world, bool value_rises) const;
};

inline constexpr std::size_t most_lights = 4;

}  // namespace viscera::volume
