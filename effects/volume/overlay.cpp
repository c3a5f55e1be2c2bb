#include "effects/volume/overlay.h"

#include <algorithm>

#include "effects/volume/transfer_params.h"
#include "engine/core/error.h"

namespace viscera::volume {

void OverlayParams::visit(ParamVisitor& v) {
    v.field({.name = "file", .doc = "Volume that gives the hue; its place in the world is its own."}, file);
    v.field({.name = "host", .doc = "Name of a volume that the host gives, instead of a file."}, host);
    v.field({.name = "geometry", .doc = "What the file's axes run along, as in volume."}, geometry);
    v.field({.name = "points",
             .doc = "Colours over its value; opacity is the share of the strength. Default: blue over green "
                    "to red, over the window or all values."},
            points);
    v.field({.name = "window", .doc = "Values that the colours are stretched to."}, window);
    v.field({.name = "strength", .doc = "1: the hue is the overlay's alone.", .min = 0.0, .max = 1.0},
            strength);
}

void OverlayParams::validate() const {
    if (!file.empty() && !host.empty()) {
        throw Error(ErrorCode::scene, "/overlay", "has either a file or a host's volume");
    }
}

TransferFunction overlay_map(const OverlayParams& params, double low, double high) {
    TransferFunction map{.points = params.points};
    if (map.points.empty()) {
        map.points = {{low, {0.0, 0.0, 1.0}, 1.0},
                      {0.5 * (low + high), {0.0, 1.0, 0.0}, 1.0},
                      {high, {1.0, 0.0, 0.0}, 1.0}};
    }
    if (params.window) {
        const double half = 0.5 * params.window->width;
        map = stretched(std::move(map), {params.window->level - half, params.window->level + half});
    }
    std::size_t faults = 0;
    return normalised(std::move(map), faults);
}

glm::dvec3 fused(const glm::dvec3& brightness_of, const glm::dvec3& hue_of) {
    const auto most = [](const glm::dvec3& c) { return std::max({c.r, c.g, c.b}); };
    return hue_of * (most(brightness_of) / std::max(most(hue_of), 1e-6));
}

OverlayTable overlay_table(const TransferFunction& map, int entries) {
    const double low = map.points.front().value;
    const double width = map.points.back().value - low;
    OverlayTable table;
    for (int i = 0; i < entries; ++i) {
        table.entries.emplace_back(evaluate(map, low + width * i / (entries - 1)));
    }
    if (width > 0.0) {
        table.place = {1.0 / width, -low / width};
    }
    return table;
}

}  // namespace viscera::volume
