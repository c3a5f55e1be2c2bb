#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "engine/core/camera.h"
#include "engine/core/params.h"
#include "engine/runtime/frame.h"

namespace viscera::contrast {

/// A place where contrast leaves the vessel as smoke.
struct EmitterParams {
    glm::dvec3 base_mm{0.0};
    glm::dvec3 tip_mm{0.0, 0.0, 10.0};
    glm::dvec3 edge_mm{3.0, 0.0, 10.0};
    double size = 1.0;
    double strength = 1.0;
    double start_s = 0.0;
    double stop_s = 1.0e9;

    void visit(ParamVisitor& v);
};

/// Why an emitter gives no smoke, for the log and the report.
enum class EmitterFault { none, not_finite, no_length, behind_camera, off_screen, not_active };

/// An emitter on the target of one frame, origin bottom-left. Lengths are pixels, so that smoke keeps its
/// shape on a target that is not square.
struct SpriteQuad {
    glm::dvec2 base{0.0};       ///< [pixels]
    glm::dvec2 tip{0.0};        ///< [pixels]
    glm::dvec2 axis{0.0, 1.0};  ///< unit vector from base to tip
    double length = 0.0;        ///< from base to tip [pixels]
    double width = 0.0;         ///< of the side view [pixels]; 0: none
    double front_width = 0.0;   ///< of the front view [pixels]; 0: none
    double front_weight = 0.0;  ///< 1.1 f, f in [0, 1]
    double strength = 1.0;
    double angle_deg = 90.0;  ///< between the line of sight and the axis, 0 to 90
    PixelRect cover;          ///< pixels that the smoke can touch, within the target
};

/// Where an emitter's smoke appears. Source of the formulas: the contrast thesis, appendix 2.e. `front`:
/// whether there is a front view. The angle comes from the sine and cosine, since acos loses half its digits
/// near 0.
[[nodiscard]] EmitterFault place(const EmitterParams& emitter, const View& view, glm::ivec2 size, bool front,
                                 SpriteQuad& quad);

}  // namespace viscera::contrast
