#pragma once

#include "engine/core/params.h"
#include "engine/core/volume.h"

namespace viscera::volume {

/// What a volume's axes run along, for files that do not say it themselves, or instead of what they say.
struct GeometryParams {
    VolumeKind kind = VolumeKind::cartesian;
    double r_min_mm = 0.0;
    double r_max_mm = 0.0;  ///< 0: by the file's spacing along the radius
    double first_angle_deg = 0.0;
    double angle_deg = 360.0;
    bool wrap = false;
    double height_mm = 0.0;  ///< 0: by the file's spacing along the axis
    double latitude_deg = 180.0;

    void visit(ParamVisitor& v);
    /// Throws Error(scene) at `where`.
    void validate(std::string_view where) const;
    /// A file's grid with this geometry; its origin and direction place the frame.
    [[nodiscard]] VolumeGrid applied_to(VolumeGrid grid) const;
};

}  // namespace viscera::volume
