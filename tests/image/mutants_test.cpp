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
