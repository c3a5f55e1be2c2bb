#include <ostream>

#include <gtest/gtest.h>

#include "engine/runtime/embedded_shaders.h"
#include "tests/image/golden_case.h"

// The gate proved: shaders are broken on purpose, a little, and the golden images must catch each and name
// the pass that is to blame.
namespace viscera::test {
namespace {

struct Mutant {
    const char* name;
    const char* golden;  ///< case that must catch it
    const char* file;
    const char* from;
    const char* to;
    const char* pass;  ///< to be named
};

void PrintTo(const Mutant& mutant, std::ostream* out) {
    *out << mutant.file << ": " << mutant.from << " -> " << mutant.to;
}

constexpr Mutant mutants[] = {
    {"PictureGain", "thesis_tone", "picture/image.frag", "u_gain * texel.r", "0.995 * u_gain * texel.r",
     "background"},
    {"PictureTurned", "thesis_tone", "common/fullscreen.vert", "v_uv = corner", "v_uv = corner.yx",
     "background"},
    {"MainTone", "thesis_tone", "contrast/geometry.frag", "u_tone * density", "0.995 * u_tone * density",
     "vessels"},
    {"BolusRise", "thesis_tone", "contrast/bolus.glsl", "3.0 - 2.0 * u", "3.0 - 1.98 * u", "vessels"},
    {"BolusDecay", "angiography", "contrast/bolus.glsl", "* u_bolus_inv_washout",
     "* 1.01 * u_bolus_inv_washout", "vessels"},
    {"OpacityKnot", "thesis_tone", "contrast/opacity.glsl", "8.529974", "8.7", "vessels"},
    {"ArrivalTime", "thesis_tone", "contrast/geometry.vert", "u_time_since_start - a_scalar",
     "u_time_since_start - 1.01 * a_scalar", "vessels"},
    {"DensityPerVertex", "per_vertex", "contrast/geometry.frag", "clamp(v_scalar, 0.0, 1.0)",
     "clamp(1.01 * v_scalar, 0.0, 1.0)", "vessels"},
    {"Calibre", "angiography", "contrast/geometry.frag", "density *= clamp(v_weight, 0.0, 1.0)",
     "density *= clamp(1.02 * v_weight, 0.0, 1.0)", "vessels"},
    {"DepthKept", "capillary", "contrast/geometry.frag", "gl_FragDepth = density",
     "gl_FragDepth = 1.0 - density", "vessels"},
    {"CloudExtent", "thesis_tone", "contrast/geometry.frag", "3.0 - 3.0 * length", "3.0 - 3.01 * length",
     "vessels"},
    {"CloudThreshold", "per_vertex", "contrast/geometry.frag", "c < u_threshold", "c < 4.0 * u_threshold",
     "vessels"},
    {"DistanceColours", "per_vertex", "contrast/distance_view.frag", "vec4(0.0, 1.0, q, 1.0)",
     "vec4(0.0, 1.0, 0.99 * q, 1.0)", "view"},
    {"SummaryLine", "thesis_tone", "contrast/summarize.frag", "0.9 * main_value", "0.85 * main_value",
     "summarize"},
    {"SummaryWidth", "sprites", "contrast/summarize.frag", "half_width = 0.05", "half_width = 0.06",
     "summarize"},
    {"SmokeBase", "sprites", "contrast/sprites.frag", "vec2(0.55, 0.15)", "vec2(0.55, 0.155)", "reflux"},
    {"SmokeTurned", "sprites", "contrast/sprites.frag", "axis.y * d.x - axis.x * d.y",
     "axis.x * d.y - axis.y * d.x", "reflux"},
    {"SmokeFront", "sprites", "contrast/sprites.frag", "view.z * textureLod", "0.97 * view.z * textureLod",
     "reflux"},
    {"SmokeMaskReach", "sprites", "contrast/sprites.frag", "length(d) * axis.w", "0.9 * length(d) * axis.w",
     "reflux"},
    {"SmokeQuadCut", "sprites", "contrast/sprites.vert", "rect.zw, corner", "0.97 * rect.zw, corner",
     "reflux"},
    {"SmokeBrightness", "sprites", "contrast/sprites.frag", "2.0 * smoke", "1.99 * smoke", "reflux"},
    {"Silhouette", "sprites", "contrast/silhouette.frag", "o_mask = 1.0", "o_mask = 0.998", "silhouette"},
    {"BlurWeight", "sprites", "filter/gaussian.frag", "u_centre * textureLod", "1.02 * u_centre * textureLod",
     "blur_x"},
    {"BlurOneSided", "capillary", "filter/gaussian.frag", "v_uv - offset", "v_uv + offset", "blush_x"},
    {"BlurCut", "capillary", "filter/gaussian.frag", "i < TAPS", "i < TAPS - 1", "blush_x"},
    {"Attenuation", "capillary", "contrast/composite.frag", "exp2(u_attenuation",
     "exp2(0.995 * u_attenuation", "composite"},
    {"LayerLost", "capillary", "contrast/composite.frag", "max(ratio, textureLod(u_capillary, v_uv, 0.0).r)",
     "ratio", "composite"},
    {"ThesisTone", "thesis_tone", "contrast/composite.frag", "0.15 * ratio", "0.148 * ratio", "composite"},
    {"ThesisJump", "thesis_tone", "contrast/composite.frag", "ratio < 0.5", "ratio < 0.52", "composite"},
    {"RayTurned", "volume_head", "volume/ray.glsl", "pixel * u_pixel - 1.0", "pixel * u_pixel - 0.998",
     "cast"},
    {"RayLength", "volume_surface", "volume/ray.glsl", "/ length_mm;\n    ray.near",
     "/ (1.01 * length_mm);\n    ray.near", "cast"},
    {"BoxPlanes", "volume_xray", "volume/coordinates_cartesian.glsl", "u_box_max - ray.origin",
     "0.99 * u_box_max - ray.origin", "cast"},
    {"Crop", "volume_narrow", "volume/coordinates_cartesian.glsl", "u_box_min - ray.origin",
     "0.5 * u_box_min - ray.origin", "cast"},
    {"Metric", "volume_head", "volume/coordinates_cartesian.glsl", "u_metric * gradient", "gradient", "cast"},
    {"SlabMiddle", "volume_labels", "volume/march.glsl", "(0.5 + offset) * part", "(0.55 + offset) * part",
     "cast"},
    {"SlabLength", "volume_head", "volume/march.glsl", "slab_mm * part,", "1.01 * slab_mm * part,", "cast"},
    {"SlabLast", "volume_mip", "volume/march.glsl", "clamp(occupied_span(leaper), 0.0, float(count))",
     "clamp(occupied_span(leaper), 0.0, 0.6 * float(count))", "cast"},
    {"LeapTooFar", "volume_head", "volume/skip.glsl", "float(entry & 31u)", "float(entry & 31u) + 1.0",
     "cast"},
    {"BricksShifted", "volume_surface", "volume/skip.glsl", "ivec3(floor(place))", "ivec3(floor(place)) + 1",
     "cast"},
    {"CellMiddle", "volume_xray", "volume/march_cells.glsl", "walk.t + 0.5 * piece", "walk.t + 0.6 * piece",
     "cast"},
    {"CellFaces", "volume_xray", "volume/march_cells.glsl", "first * u_voxels - 0.5", "first * u_voxels",
     "cast"},
    {"Jitter", "volume_labels", "volume/jitter.glsl", "747796405U", "747796407U", "cast"},
    {"BlueNoise", "volume_narrow", "volume/jitter.glsl", "0).r - 0.5", "0).r - 0.45", "cast"},
    {"GaussWeight", "volume_head", "volume/function_composite.glsl", "mix(a.rgb, b.rgb, share)",
     "mix(b.rgb, a.rgb, share)", "cast"},
    {"GaussDepth", "volume_head", "volume/function_composite.glsl", "slab.length_mm * mean;",
     "0.99 * slab.length_mm * mean;", "cast"},
    {"MidpointDepth", "volume_labels", "volume/function_composite.glsl", "c.a * slab.length_mm",
     "0.99 * c.a * slab.length_mm", "cast"},
    {"PreintegratedRise", "volume_narrow", "volume/function_composite.glsl", "behind - before)", "before)",
     "cast"},
    {"EarlyEnd", "volume_head", "volume/function_composite.glsl", "state.depth > u_depth_limit",
     "state.depth > 0.7 * u_depth_limit", "cast"},
    {"SlabPieces", "volume_narrow", "volume/slab_table.glsl", "(ta + tb)", "(ta + 1.1 * tb)", "cast"},
    {"MaximumLost", "volume_mip", "volume/function_projection.glsl", "0.25 * slab.extent",
     "0.45 * slab.extent", "cast"},
    {"Attenuation2", "volume_xray", "volume/function_projection.glsl", "exp(-state.value)",
     "exp(-1.005 * state.value)", "cast"},
    {"GaussSum", "volume_xray", "volume/function_projection.glsl", "0.5 * slab.length_mm",
     "0.495 * slab.length_mm", "cast"},
    {"Classification", "volume_mip", "volume/classify.glsl", "int(place + 0.5)", "int(0.995 * place)",
     "cast"},
    {"SurfaceBehind", "volume_surface", "volume/function_isosurface.glsl", "*= 1.0 - surface_colour.a",
     "*= 1.0 - 1.02 * surface_colour.a", "cast"},
    {"SurfacePlace", "volume_surface", "volume/function_isosurface.glsl", "(exact - 0.5)", "(exact - 0.3)",
     "cast"},
    {"SurfaceLight", "volume_surface", "volume/function_isosurface.glsl", "u_lighting.y * cosine",
     "0.99 * u_lighting.y * cosine", "cast"},
    {"SurfaceTwice", "volume_surface", "volume/function_isosurface.glsl", "from = root + 1e-5", "from = 1.0",
     "cast"},
    {"CubicFit", "volume_surface", "volume/cell_cubic.glsl", "18.0 * f1", "17.0 * f1", "cast"},
    {"Diffuse", "volume_head", "volume/shading.glsl", "max(facing, 0.0)", "0.99 * max(facing, 0.0)", "cast"},
    {"Highlight", "volume_head", "volume/shading.glsl", "pow(max(gloss, 1e-6), u_lighting.w)",
     "pow(max(gloss, 1e-6), 1.2 * u_lighting.w)", "cast"},
    {"NormalTurned", "volume_head", "volume/shading.glsl", "u_outward * unit_or_zero",
     "-u_outward * unit_or_zero", "cast"},
    {"OneSidedGradient", "volume_head", "volume/sample.glsl",
     "sample_volume(place + x) - sample_volume(place - x)", "sample_volume(place + x) - sample_volume(place)",
     "cast"},
    {"GradientOpacity", "volume_labels", "volume/gradient_opacity.glsl", "magnitude * u_gradient_place.x",
     "0.9 * magnitude * u_gradient_place.x", "cast"},
    {"LightVolume", "volume_labels", "volume/material.glsl", "local, view_direction, arrives",
     "local, view_direction, vec2(1.0)", "cast"},
    {"LabelFactor", "volume_labels", "volume/labels.glsl", "c.a * how.x", "c.a", "cast"},
    {"LabelColour", "volume_labels", "volume/labels.glsl", "mix(c.rgb, look.rgb, look.a)", "c.rgb", "cast"},
    {"LabelRamp", "volume_labels", "volume/labels.glsl", "int row = int(how.y)", "int row = 0", "cast"},
    {"LabelShifted", "volume_labels", "volume/labels.glsl", "ivec3(floor(place))", "ivec3(ceil(place))",
     "cast"},
    {"AngleSine", "volume_cylinder", "volume/curvilinear.glsl", "0.199718787", "0.0", "cast"},
    {"CurvedMetric", "volume_cylinder", "volume/place_cylindrical.glsl", "slope.y / max(radius",
     "0.5 * slope.y / max(radius", "cast"},
    {"InnerRadius", "volume_sphere", "volume/coordinates_spherical.glsl", "u_radius_low > 0.0 ?",
     "u_radius_low > 1.0 ?", "cast"},
    {"PolarCone", "volume_sphere", "volume/coordinates_spherical.glsl", "float xo = o.z * c;",
     "float xo = o.z * c + 0.05;", "cast"},
    {"LongitudeGap", "volume_sphere", "volume/curvilinear_limits.glsl", "u_wedge == 2", "u_wedge == 3",
     "cast"},
    {"MixedLattice", "volume_mixed", "volume/mixed_lattice.glsl", "((2 * texel + 1) * lines)",
     "((2 * texel) * lines)", "coarse"},
    {"MixedBend", "volume_mixed", "volume/mixed_plan.glsl", "most /= 8.0", "most /= 9.0", "fine"},
    {"MixedEdges", "volume_mixed", "volume/mixed_plan.glsl", "> u_coarse_depth_tolerance",
     "> 1e4 * u_coarse_depth_tolerance", "fine"},
    {"MixedCubic", "volume_mixed", "volume/mixed_lattice.glsl", "d.x * d.z * d.w", "d.x * d.z * (d.w - 0.2)",
     "fine"},
    {"MixedFill", "volume_mixed", "volume/mixed_fill.glsl", "base + sum", "base + 0.98 * sum", "fine"},
    {"MixedTileSize", "volume_mixed", "volume/mixed_tiles.vert", "gl_PointSize = float(tile_size)",
     "gl_PointSize = float(tile_size - 1)", "fine"},
    {"EyesBothLeft", "volume_stereo", "common/side_by_side.frag",
     "texelFetch(u_right, texel, 0) :", "texelFetch(u_left, texel, 0) :", "side_by_side.volume.colour"},
    {"EyesTurned", "volume_stereo", "volume/ray.glsl", "ndc.x * u_direction[1]",
     "0.998 * ndc.x * u_direction[1]", "coarse.left"},
    {"EyesSurfaceDepth", "volume_stereo", "volume/picture.glsl", "share * ray.scale",
     "share * ray.scale + 20.0", "coarse.left"},
    {"OverlayStrength", "volume_labels", "volume/overlay.glsl", "u_overlay_strength * hue.a",
     "0.95 * u_overlay_strength * hue.a", "cast"},
    {"OverlayBrightness", "volume_labels", "volume/overlay.glsl", "max(max(colour.r, colour.g), colour.b)",
     "colour.g", "cast"},
    {"ClipPlane", "volume_surface", "volume/clip.glsl", "float s = -height", "float s = -1.01 * height",
     "cast"},
    {"ClipSide", "volume_labels", "volume/clip.glsl", "!along && rise > 0.0", "!along && rise < 0.0", "cast"},
    {"ReliefStrength", "organ", "organ/surface.frag", "1.0 + u_bump.y * burn.coagulated",
     "1.0 + 0.7 * u_bump.y * burn.coagulated", "organ"},
    {"ReliefUnderBlood", "organ", "organ/surface.frag", "1.0 - 0.5 * wet", "1.0", "organ"},
    {"ReliefTurned", "organ", "organ/bump.glsl", "rise.x * r1 + rise.y * r2", "rise.x * r1 - rise.y * r2",
     "organ"},
    {"BloodRelief", "organ", "organ/bump.glsl", "-normal.xy / normal.z", "normal.xy / normal.z", "organ"},
    {"BurnCurve", "organ", "organ/burn.glsl", "-40.0 * min(alpha, 1.0)", "-36.0 * min(alpha, 1.0)", "organ"},
    {"CutLost", "organ", "organ/surface.frag", "is_cut ? cut.rgb", "false ? cut.rgb", "organ"},
    {"BloodInCuts", "organ", "organ/surface.frag", "mix(vec3(1.0), blood.rgb, whole)", "blood.rgb", "organ"},
    {"HintShare", "organ", "organ/surface.frag", "u_hint_share * hint.a * whole",
     "0.95 * u_hint_share * hint.a * whole", "organ"},
    {"Bruise", "organ", "organ/hematoma.glsl", "distance(place, spot.xyz) * spot.w",
     "0.97 * distance(place, spot.xyz) * spot.w", "organ"},
    {"FirstLightAlone", "organ", "organ/light.glsl", "i < LIGHTS; ++i", "i < 1; ++i", "organ"},
    {"LightFalloff", "organ", "organ/light.glsl", "squared * u_light_fall[i].x",
     "0.98 * squared * u_light_fall[i].x", "organ"},
    {"LightAngle", "organ", "organ/light.glsl", "u_light_fall[i].y);", "0.98 * u_light_fall[i].y);", "organ"},
    {"LightHighlight", "organ", "organ/light.glsl", "unit(towards + eye)", "unit(towards + 1.1 * eye)",
     "organ"},
    {"LightGlow", "organ", "organ/light.glsl", "u_light_glow[i].x - sqrt(squared)",
     "u_light_glow[i].x - 1.01 * sqrt(squared)", "organ"},
    {"Gloss", "organ", "organ/surface.frag", "max(0.05, (1.0 - burn.coagulated)",
     "max(0.05, (1.0 - 0.98 * burn.coagulated)", "organ"},
    {"FocusCurve", "organ", "organ/focus.glsl", "exp(-10.0 * (f - 0.4))", "exp(-10.0 * (f - 0.41))", "organ"},
    {"MembraneObliquely", "organ", "organ/surface.frag", "1.0 / max(abs(dot(unit(v_normal), eye)), 1e-3)",
     "1.0", "membrane"},
    {"BlurBleeds", "organ", "organ/depth_of_field.frag", "there.a >= here.a ? 1.0 : reach", "1.0",
     "depth_of_field"},
    {"BlurRadius", "organ", "organ/depth_of_field.frag", "radius * u_taps[i]", "1.03 * radius * u_taps[i]",
     "depth_of_field"},
    {"CubicWeight", "volume_narrow", "volume/cubic_weights.glsl", "(4.0 - 3.0 * a * a * (2.0 - a)) / 6.0",
     "(4.0 - 3.0 * a * a * (2.0 - a)) / 6.1", "cast"},
    {"BakeWeight", "tissue_bake", "tissue/bake.frag", "weight.x * (b - a)", "0.99 * weight.x * (b - a)",
     "bake"},
    {"BakeMetric", "tissue_bake", "tissue/bake.frag", "d1.x * d2.y - d1.y * d2.x",
     "d1.x * d2.y - 0.9 * d1.y * d2.x", "bake"},
    {"BakeSeam", "tissue_bake", "tissue/bake.frag", "} else if (!ends) {", "} else if (ends) {", "bake"},
    {"EnergyExponent", "tissue_energy", "tissue/contact.glsl", "exp(-0.5 * min(exponent, 170.0))",
     "exp(-0.52 * min(exponent, 170.0))", "coagulate"},
    {"EnergyAlongTheWay", "tissue_energy", "tissue/contact.glsl", "q > 0.5 ? across2 : exponent", "exponent",
     "coagulate"},
    {"EnergyShortWay", "tissue_energy", "tissue/contact.glsl", "q2 * (h2 / 6.0", "q2 * (h2 / 4.0",
     "coagulate"},
    {"EnergyReach", "tissue_energy", "tissue/contact.glsl", "beyond * beyond < kind.y",
     "beyond * beyond < 0.2 * kind.y", "coagulate"},
    {"EnergyCutOff", "tissue_energy", "tissue/coagulate.frag", "min(sums, largest)",
     "min(sums, 0.9 * largest)", "coagulate"},
    {"EnergyHalvedLater", "tissue_energy", "tissue/energy_rules.glsl", "clamp(0.5 - from",
     "clamp(0.55 - from", "coagulate"},
    {"EnergySounded", "tissue_energy", "tissue/energy_rules.glsl", "min(0.9, e_max)", "min(0.88, e_max)",
     "coagulate"},
    {"EnergyDissected", "tissue_energy", "tissue/energy_rules.glsl", "max(e - dose", "max(e - 0.98 * dose",
     "coagulate"},
    {"EnergyForgotten", "tissue_energy", "tissue/energy_store.glsl", "u_keep * textureLod",
     "0.99 * u_keep * textureLod", "coagulate"},
    {"EnergyTiles", "tissue_energy", "tissue/coagulate.vert", "tile.xy + corner", "tile.xy + 0.9 * corner",
     "coagulate"},
    {"BipolarShape", "tissue_energy", "tissue/bipolar.frag", "dot(p, p) < u_size_mm.z",
     "dot(p, p) < 0.8 * u_size_mm.z", "bipolar"},
    {"BipolarHeld", "tissue_energy", "tissue/bipolar.frag", "held && inside(place)", "inside(place)",
     "bipolar"},
};

class Mutants : public testing::TestWithParam<Mutant> {};

TEST_P(Mutants, IsCaughtAndItsPassIsNamed) {
    const Mutant& mutant = GetParam();
    bool changed = false;
    Stage stage(Backend::osmesa, [&, original = embedded_shader_reader()](std::string_view name) {
        std::optional<std::string> text = original(name);
        if (text && name == mutant.file) {
            const std::string_view from = mutant.from;
            const std::size_t at = text->find(from);
            if (at != std::string::npos) {
                text->replace(at, from.size(), mutant.to);
                changed = true;
            }
        }
        return text;
    });
    const std::vector<Finding> findings = check(load_case(case_folder(mutant.golden)), stage);
    EXPECT_TRUE(changed) << mutant.file << " no longer says: " << mutant.from;
    ASSERT_FALSE(findings.empty()) << "the images let it pass";
    EXPECT_EQ(findings.front().pass, mutant.pass) << to_string(findings.front());
}

INSTANTIATE_TEST_SUITE_P(Broken, Mutants, testing::ValuesIn(mutants),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace viscera::test
