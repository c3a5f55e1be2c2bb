#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "effects/contrast/bolus.h"
#include "effects/contrast/vessel.h"
#include "engine/core/params.h"

namespace viscera::contrast {

/// What becomes of the fragments that cover a pixel: the densest is kept, or they add up.
enum class OverlapMethod {
    max,        ///< maximum blending: in any order, with early tests
    depth,      ///< the fragment writes its density as depth, GL_GREATER keeps the densest
    painter,    ///< triangles sorted from dim to bright; exact where density is constant over each triangle
    thickness,  ///< walls add up, each by the way of the ray to the vessel's axis
};
[[nodiscard]] std::span<const std::string_view> choice_names(OverlapMethod method);

/// The denser the contrast at the injection, the nearer to it: a cloud around the point.
struct CloudParams {
    std::optional<glm::dvec3> centre_mm;
    double radius_mm = 8.0;
    double brightness = 1.0;
    double threshold = 0.02;

    void visit(ParamVisitor& v);
};

struct GeometryParams {
    VesselParams vessel;
    BolusParams bolus;
    CloudParams cloud;
    double tone = 1.0;
    double delay_s = 0.0;
    OverlapMethod method = OverlapMethod::max;

    void visit(ParamVisitor& v);
};

}  // namespace viscera::contrast
