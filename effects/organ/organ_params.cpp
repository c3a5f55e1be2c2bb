#include "effects/organ/organ_params.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/error.h"

namespace viscera::organ {
namespace {

constexpr std::array<std::string_view, 3> light_place_names{"camera", "world", "infinity"};
constexpr std::array<std::string_view, 3> faces_names{"front", "back", "both"};
constexpr std::array<std::string_view, 2> blending_names{"opaque", "blended"};
constexpr std::array<std::string_view, 2> burn_curve_names{"corrected", "thesis"};
constexpr std::array<std::string_view, 2> metric_names{"world", "uv"};
constexpr std::array<std::string_view, 2> encoding_names{"unsigned", "signed"};

}  // namespace

std::span<const std::string_view> choice_names(LightPlace) {
    return light_place_names;
}
std::span<const std::string_view> choice_names(Faces) {
    return faces_names;
}
std::span<const std::string_view> choice_names(Blending) {
    return blending_names;
}
std::span<const std::string_view> choice_names(BurnCurve) {
    return burn_curve_names;
}
std::span<const std::string_view> choice_names(SpotMetric) {
    return metric_names;
}
std::span<const std::string_view> choice_names(NormalEncoding) {
    return encoding_names;
}

void LightParams::visit(ParamVisitor& v) {
    v.field({.name = "place",
             .doc = "What position is counted in: the camera's frame (x right, y up, z back; of two eyes the "
                    "one between them), the world, or "
                    "the direction towards a light at infinity in the world."},
            place);
    v.field({.name = "position", .doc = "Place of the light or direction towards it.", .unit = "mm"},
            position);
    v.field({.name = "colour", .doc = "Red, green and blue, linear.", .min = 0.0, .max = 1000.0}, colour);
    v.field({.name = "falloff_mm",
             .doc = "Distance at which the light ends; 0: it does not. Not for lights at infinity.",
             .unit = "mm",
             .min = 0.0},
            falloff_mm);
    v.field({.name = "angular",
             .doc = "Exponent of the fall with the angle between the way to the light and the view axis; 0: "
                    "none.",
             .min = 0.0,
             .max = 1000.0},
            angular);
    v.field({.name = "glow_mm",
             .doc = "Tissue nearer to the light than this is overexposed; 0: none is.",
             .unit = "mm",
             .min = 0.0},
            glow_mm);
    v.field({.name = "glow_per_mm2",
             .doc = "How fast the glow rises with the squared distance below glow_mm.",
             .unit = "1/mm^2",
             .min = 0.0},
            glow_per_mm2);
}

void ShadingParams::visit(ParamVisitor& v) {
    v.field({.name = "ambient",
             .doc = "Share of the colour that a light adds whichever way the surface faces.",
             .min = 0.0,
             .max = 1.0},
            ambient);
    v.field({.name = "diffuse",
             .doc = "Share of the colour that a light adds where the surface faces it.",
             .min = 0.0,
             .max = 1.0},
            diffuse);
    v.field({.name = "specular", .doc = "Brightness of highlights.", .min = 0.0, .max = 10.0}, specular);
    v.field({.name = "specular_colour", .doc = "Of highlights: red, green and blue.", .min = 0.0, .max = 1.0},
            specular_colour);
    v.field({.name = "shininess", .doc = "Exponent of highlights.", .min = 0.0, .max = 2000.0}, shininess);
}

void BumpParams::visit(ParamVisitor& v) {
    v.field({.name = "map",
             .doc = "Tangent-space normals, PNG, JPEG or EXR, on the mesh's own texture coordinates."},
            map);
    v.field({.name = "strength", .doc = "Factor on the slopes; 0: flat.", .min = -100.0, .max = 100.0},
            strength);
    v.field({.name = "repeat",
             .doc = "How often the map is repeated along the texture coordinates.",
             .min = 0.0,
             .min_excluded = true},
            repeat);
    v.field(
        {.name = "encoding",
         .doc =
             "unsigned: 2 c - 1, and 128 of 8 bits, or 32768 of 16, is 0; signed: components as they stand."},
        encoding);
    v.field({.name = "green_down", .doc = "Green points along -v, as DirectX has it."}, green_down);
}

void CoagulationParams::visit(ParamVisitor& v) {
    v.field({.name = "colour", .doc = "Of coagulated tissue.", .min = 0.0, .max = 1.0}, colour);
    v.field({.name = "saturation", .doc = "Share of that colour.", .min = 0.0, .max = 1.0}, saturation);
    v.field({.name = "brightness", .doc = "Factor on coagulated tissue.", .min = 0.0, .max = 10.0},
            brightness);
    v.field(
        {.name = "burn_curve",
         .doc = "corrected: untouched tissue is not burnt; thesis: as published, which burns it by 1.8 %."},
        burn_curve);
    v.field({.name = "bump_gain",
             .doc = "How much rougher than untouched tissue fully burnt tissue is.",
             .min = 0.0,
             .max = 100.0},
            bump_gain);
}

void BloodParams::visit(ParamVisitor& v) {
    v.field({.name = "bump", .doc = "Factor on the slopes of the blood's surface.", .min = 0.0, .max = 100.0},
            bump);
}

void CutParams::visit(ParamVisitor& v) {
    v.field({.name = "map", .doc = "What cut faces look like, on the mesh's own texture coordinates."}, map);
    v.field(
        {.name = "vertex_scalar",
         .doc =
             "The tissue is cut where this scalar of the mesh (glTF attribute _NAME, or COLOR_0.a: alpha of "
             "its vertex colours), or the host's array of this name, is above 0; empty: where the "
             "map's alpha is."},
        vertex_scalar);
}

void HintParams::visit(ParamVisitor& v) {
    v.field({.name = "map", .doc = "What the trainee is shown, on the mesh's own texture coordinates."}, map);
    v.field({.name = "strength", .doc = "Share of the hint when it shows most.", .min = 0.0, .max = 1.0},
            strength);
    v.field({.name = "period_s",
             .doc = "The hint comes and goes once in this time; 0: it stays.",
             .unit = "s",
             .min = 0.0},
            period_s);
}

void SpotParams::visit(ParamVisitor& v) {
    v.field({.name = "centre", .doc = "World place [mm], or u, v and 0."}, centre);
    v.field({.name = "radius", .doc = "In mm, or in texture coordinates.", .min = 0.0, .min_excluded = true},
            radius);
}

void HematomaParams::visit(ParamVisitor& v) {
    v.field({.name = "spots", .doc = "Spots, at most 60000 with the host's."}, spots);
    v.field({.name = "host_spots",
             .doc = "Name of the host's array of further spots, 4 floats each: centre, radius; empty: none."},
            host_spots);
    v.field({.name = "metric", .doc = "What distances are measured in."}, metric);
    v.field({.name = "colour", .doc = "Of the middle of a spot.", .min = 0.0, .max = 1.0}, colour);
    v.field({.name = "strength", .doc = "Share of that colour there.", .min = 0.0, .max = 1.0}, strength);
}

void FocusParams::visit(ParamVisitor& v) {
    v.field({.name = "near_mm", .doc = "Depth of the strongest blur before the focal plane.", .unit = "mm"},
            near_mm);
    v.field({.name = "focus_mm", .doc = "Depth of the focal plane.", .unit = "mm"}, focus_mm);
    v.field({.name = "far_mm", .doc = "Depth of the strongest blur behind it.", .unit = "mm"}, far_mm);
    v.field({.name = "clamp_near", .doc = "Largest blurriness before it.", .min = 0.0, .max = 1.0},
            clamp_near);
    v.field({.name = "clamp_far", .doc = "Largest blurriness behind it.", .min = 0.0, .max = 1.0}, clamp_far);
}

void OrganParams::visit(ParamVisitor& v) {
    v.field({.name = "mesh", .doc = "The organ's surface."}, mesh);
    v.field({.name = "colour",
             .doc = "Factor on the diffuse map, or the colour without one; by default 1, or that of a liver.",
             .min = 0.0,
             .max = 1.0},
            colour);
    v.field({.name = "diffuse_map",
             .doc = "Colour, PNG, JPEG or EXR, on the mesh's own texture coordinates; empty: the port's."},
            diffuse_map);
    v.field({.name = "diffuse_repeat",
             .doc = "How often the map is repeated along the texture coordinates.",
             .min = 0.0,
             .min_excluded = true},
            diffuse_repeat);
    v.field({.name = "normal_map", .doc = "Relief of the surface."}, normal_map);
    v.field({.name = "coagulation", .doc = "How energy shows."}, coagulation);
    v.field({.name = "blood", .doc = "How blood shows."}, blood);
    v.field({.name = "cut", .doc = "How cuts show."}, cut);
    v.field({.name = "hint", .doc = "How hints show."}, hint);
    v.field({.name = "hematoma", .doc = "Bruises."}, hematoma);
    v.field({.name = "shading", .doc = "How light is thrown back."}, shading);
    v.field({.name = "lights", .doc = "At most 8; by default one beside the camera."}, lights);
    v.field({.name = "focus", .doc = "Depth of field: what alpha tells organ.depth_of_field."}, focus);
    v.field(
        {.name = "faces", .doc = "Which sides of the triangles are drawn; each is lit from its own side."},
        faces);
    v.field({.name = "blending",
             .doc = "blended: a membrane, drawn from back to front, that hides nothing behind it."},
            blending);
    v.field({.name = "opacity",
             .doc = "blended: share of what lies behind that is lost where the membrane is looked at at a "
                    "right angle; the diffuse map's alpha is a factor on it.",
             .min = 0.0,
             .max = 1.0},
            opacity);
    v.field({.name = "into_picture",
             .doc = "Drawn into what passes above have drawn, hidden by it where it is nearer; otherwise a "
                    "new picture."},
            into_picture);
}

void OrganParams::validate() const {
    if (lights.size() > most_lights) {
        throw Error(ErrorCode::scene, "/lights", "has more than " + std::to_string(most_lights) + " lights");
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (lights[i].place == LightPlace::infinity && lights[i].position == glm::dvec3(0.0)) {
            throw Error(ErrorCode::scene, "/lights/" + std::to_string(i) + "/position",
                        "has no length, so it is no direction");
        }
    }
    if (focus && !(focus->near_mm < focus->focus_mm && focus->focus_mm < focus->far_mm)) {
        throw Error(ErrorCode::scene, "/focus", "near_mm, focus_mm and far_mm must rise");
    }
}

double blurriness(const FocusParams& focus, double depth_mm) {
    const auto logistic = [](double x) { return 1.0 / (1.0 + std::exp(-10.0 * x)); };
    if (depth_mm < focus.focus_mm) {
        const double f = (depth_mm - focus.focus_mm) / (focus.focus_mm - focus.near_mm);
        return std::max(-1.0 + logistic(f + 0.4), -focus.clamp_near);
    }
    const double f = (depth_mm - focus.focus_mm) / (focus.far_mm - focus.focus_mm);
    return std::min(logistic(f - 0.4), focus.clamp_far);
}

}  // namespace viscera::organ
