#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/gl/program.h"
#include "engine/runtime/frame.h"

namespace viscera::volume {

/// Steps that are longer the farther from where one looks.
struct FoveaParams {
    glm::dvec2 centre{0.5};
    std::optional<glm::dvec2> centre_right;
    std::string host;
    double radius = 0.15;
    double outer_radius = 0.6;
    double step_factor = 4.0;

    void visit(ParamVisitor& v);
    /// Throws Error(scene).
    void validate() const;
    /// Where this frame's eye looks, in UV. From the host's array of 2 (both eyes) or 4 numbers (left, right)
    /// when there is one that is finite, else the scene's.
    [[nodiscard]] glm::dvec2 centre_of(const Frame& frame) const;
    void set(const gl::Program& program, const glm::dvec2& centre, glm::ivec2 size) const;
};

}  // namespace viscera::volume
