#include "effects/volume/isosurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace viscera::volume {

void IsoValue::visit(ParamVisitor& v) {
    v.field({.name = "value", .doc = "Value on the surface, in the volume's unit.", .required = true}, value);
    v.field({.name = "colour", .doc = "Colour of the surface.", .min = 0.0, .max = 1.0}, colour);
    v.field({.name = "opacity",
             .doc = "Opacity of the surface; below 1, those behind it are seen, too.",
             .min = 0.0,
             .max = 1.0},
            opacity);
}

void IsosurfaceParams::visit(ParamVisitor& v) {
    v.field({.name = "values", .doc = "The surfaces, at most 8, in any order."}, values);
    v.field({.name = "lighting", .doc = "Blinn-Phong, with the light at the eye."}, lighting);
}

std::vector<StoredRange> stored_ranges(const IsosurfaceParams& params, const TexelMap& stored_to_value) {
    std::vector<double> stored;
    for (const IsoValue& iso : params.values) {
        stored.push_back(stored_to_value.texel_of(iso.value));
    }
    std::ranges::sort(stored);
    std::vector<StoredRange> ranges;
    for (const double s : stored) {
        // Interpolation rounds: a surface through voxels that have just its value must not be lost.
        const double slack = 1e-6 * (1.0 + std::abs(s));
        ranges.push_back({static_cast<float>(s - slack), static_cast<float>(s + slack)});
    }
    return ranges;
}

void add_defines(const IsosurfaceParams& params, bool refine, std::vector<std::string>& defines) {
    defines.emplace_back("ISOSURFACE");
    defines.push_back("ISO_VALUES " +
                      std::to_string(std::clamp<std::size_t>(params.values.size(), 1, most_iso_values)));
    if (refine) {
        defines.emplace_back("REFINE");
    }
}

void bind(const IsosurfaceParams& params, const TexelMap& texel_to_value, double termination,
          const gl::Program& program) {
    std::array<float, most_iso_values> texels{};
    std::array<glm::vec4, most_iso_values> colours{};
    const std::size_t count = std::min(params.values.size(), most_iso_values);
    for (std::size_t i = 0; i < count; ++i) {
        texels[i] = static_cast<float>(texel_to_value.texel_of(params.values[i].value));
        colours[i] = glm::vec4(params.values[i].colour, params.values[i].opacity);
    }
    program.set("u_iso", std::span<const float>(texels).first(count));
    program.set("u_iso_colour", std::span<const glm::vec4>(colours).first(count));
    program.set("u_lighting", glm::vec4(params.lighting.ambient, params.lighting.diffuse,
                                        params.lighting.specular, params.lighting.shininess));
    program.set("u_transmittance_limit", static_cast<float>(termination));
}

}  // namespace viscera::volume
