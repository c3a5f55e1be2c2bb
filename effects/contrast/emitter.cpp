#include "effects/contrast/emitter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/finite.h"

namespace viscera::contrast {
namespace {

// Of the side view: where the base lies in it (thesis, appendix 2.e).
constexpr glm::dvec2 base_in_sprite(0.55, 0.15);

PixelRect cover_of(const SpriteQuad& quad, glm::ivec2 size) {
    const glm::dvec2 right(quad.axis.y, -quad.axis.x);
    glm::dvec2 low(1e30);
    glm::dvec2 high(-1e30);
    const auto extend = [&](const glm::dvec2& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    };
    for (int corner = 0; corner < 4 && quad.width > 0.0; ++corner) {
        const glm::dvec2 uv = (glm::dvec2(corner & 1, corner >> 1) - base_in_sprite) * quad.width;
        extend(quad.base + uv.x * right + uv.y * quad.axis);
    }
    if (quad.front_width > 0.0) {
        extend(quad.tip - 0.5 * quad.front_width);
        extend(quad.tip + 0.5 * quad.front_width);
    }
    const glm::dvec2 limit(size);
    const glm::ivec2 first(glm::floor(glm::clamp(low, glm::dvec2(0.0), limit)));
    const glm::ivec2 last(glm::ceil(glm::clamp(high, glm::dvec2(0.0), limit)));
    return {first.x, first.y, last.x - first.x, last.y - first.y};
}

}  // namespace

void EmitterParams::visit(ParamVisitor& v) {
    v.field({.name = "base_mm", .doc = "Where the smoke leaves the vessel.", .unit = "mm", .required = true},
            base_mm);
    v.field({.name = "tip_mm", .doc = "Where it ends.", .unit = "mm", .required = true}, tip_mm);
    v.field({.name = "edge_mm",
             .doc = "A point on the rim at the tip: its distance from the tip sizes the front view.",
             .unit = "mm",
             .required = true},
            edge_mm);
    v.field({.name = "size",
             .doc = "Width of the side view in lengths from base to tip.",
             .min = 0.0,
             .min_excluded = true},
            size);
    v.field({.name = "strength", .doc = "Scale of the smoke's density.", .min = 0.0, .max = 1.0}, strength);
    v.field({.name = "start_s", .doc = "Smokes from this time on.", .unit = "s"}, start_s);
    v.field({.name = "stop_s", .doc = "Until this time.", .unit = "s"}, stop_s);
}

EmitterFault place(const EmitterParams& emitter, const View& view, glm::ivec2 size, bool front,
                   SpriteQuad& quad) {
    if (!finite(emitter.base_mm) || !finite(emitter.tip_mm) || !finite(emitter.edge_mm) ||
        !finite(emitter.size)) {
        return EmitterFault::not_finite;
    }
    const auto base = project_to_uv(view, emitter.base_mm);
    const auto tip = project_to_uv(view, emitter.tip_mm);
    const auto edge = project_to_uv(view, emitter.edge_mm);
    if (!base || !tip || !edge) {
        return EmitterFault::behind_camera;
    }
    const glm::dvec2 pixels(size);
    quad.base = *base * pixels;
    quad.tip = *tip * pixels;
    quad.length = glm::length(quad.tip - quad.base);
    const glm::dvec3 axis = glm::normalize(emitter.tip_mm - emitter.base_mm);
    if (!finite(axis) || !finite(quad.length)) {
        return EmitterFault::no_length;
    }
    // Less than a thousandth of a pixel: seen exactly from the front, where no side is left.
    const bool has_side = quad.length > 1e-3;
    quad.axis = has_side ? (quad.tip - quad.base) / quad.length : glm::dvec2(0.0, 1.0);
    quad.width = has_side ? emitter.size * quad.length : 0.0;
    quad.strength = emitter.strength;
    const glm::dvec3 sight = view.direction_to(emitter.base_mm);
    const double cosine = std::abs(glm::dot(axis, sight));
    quad.angle_deg = std::atan2(glm::length(glm::cross(axis, sight)), cosine) * 180.0 / std::numbers::pi;
    const double weight = std::clamp(4.0 * cosine - 3.0, 0.0, 1.0);
    const double front_width = 5.5 * glm::length(*edge * pixels - quad.tip);
    const bool has_front = front && weight > 0.0 && front_width > 0.0;
    quad.front_width = has_front ? front_width : 0.0;
    quad.front_weight = has_front ? 1.1 * weight : 0.0;
    quad.cover = cover_of(quad, size);
    return quad.cover.empty() ? EmitterFault::off_screen : EmitterFault::none;
}

}  // namespace viscera::contrast
