#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/geometry.h"
#include "engine/core/params.h"
#include "engine/core/transfer_function.h"

namespace viscera::volume {

/// A second volume, mostly coarser, whose value gives the hue; the first one keeps the brightness.
struct OverlayParams {
    AssetPath file;
    std::string host;
    std::optional<GeometryParams> geometry;  ///< of the file, as in SourceParams
    std::vector<TransferPoint> points;       ///< none: blue over green to red
    std::optional<WindowLevel> window;       ///< the values that the points are stretched to
    double strength = 1.0;

    void visit(ParamVisitor& v);
    [[nodiscard]] bool used() const { return !file.empty() || !host.empty(); }
    /// Throws Error(scene): file and host.
    void validate() const;
};

/// Colour over the overlay's value; opacity is the share of the strength. `low`, `high`: values of the
/// overlay, which the default map spans unless there is a window.
[[nodiscard]] TransferFunction overlay_map(const OverlayParams& params, double low, double high);

/// HSV fusion: hue and saturation of one colour, brightness (largest component) of another.
[[nodiscard]] glm::dvec3 fused(const glm::dvec3& brightness_of, const glm::dvec3& hue_of);

/// Entries of the map between its outermost knots, and where a value lies on it, in [0, 1]: x * value + y.
struct OverlayTable {
    std::vector<glm::vec4> entries;
    glm::dvec2 place{0.0};
};
[[nodiscard]] OverlayTable overlay_table(const TransferFunction& map, int entries);

}  // namespace viscera::volume
