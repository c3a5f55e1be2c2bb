#include <algorithm>
#include <array>
#include <string_view>

#include "effects/organ/lights.h"
#include "effects/organ/surface_effect.h"

// What an organ reads and writes, and the programs that this may take.
namespace viscera::organ {
namespace {

constexpr std::string_view own_uv = " v_picture_uv";
constexpr std::string_view tissue_uv = " v_uv";

/// Both values of what only a frame decides, one of what the parameters do.
std::vector<bool> choices(bool possible, bool certain) {
    if (certain) {
        return {true};
    }
    return possible ? std::vector<bool>{false, true} : std::vector<bool>{false};
}

Port optional_read(const char* name, const char* target, const char* doc) {
    return {.name = name, .access = Access::read, .target = target, .doc = doc, .optional = true};
}

}  // namespace

std::vector<Port> SurfaceEffect::ports() const {
    const Access access = params_.into_picture ? Access::modify : Access::write;
    const double beyond = params_.focus ? params_.focus->clamp_far : 0.0;
    std::vector<Port> ports{
        {.name = "colour",
         .access = access,
         .target = "organ.color",
         .doc = "Colour as it is lit; alpha: blurriness b as b/2 + 1/2.",
         .format = PixelFormat::rgba16f,
         .clear = {0.0F, 0.0F, 0.0F, static_cast<float>(stored_blurriness(beyond))},
         .behind_depth = params_.blending == Blending::opaque},
        {.name = "depth",
         .access = access,
         .target = "organ.depth",
         .doc = "Depth of the nearest opaque surface; 1 where there is none.",
         .format = PixelFormat::depth32f,
         .clear = {1.0F, 0.0F, 0.0F, 0.0F}},
        optional_read("energy", "tissue.energy", "Energy: above 0 coagulated, below 0 dissected."),
        optional_read("blood_colour", "tissue.blood_color", "Factor on the colour, and the amount of blood."),
        optional_read("blood_normal", "tissue.blood_normal", "Tangent-space normal of the blood's surface."),
        optional_read("blood_height", "tissue.blood_height",
                      "Height of the blood [mm]; in place of a normal.")};
    if (params_.diffuse_map.empty()) {
        ports.push_back(optional_read("diffuse", "", "Colour of the tissue, in texture space."));
    }
    if (params_.cut.map.empty()) {
        ports.push_back(optional_read("cut", "", "What cut faces look like, in texture space."));
    }
    if (params_.hint.map.empty()) {
        ports.push_back(optional_read("hint", "", "What the trainee is shown, in texture space."));
    }
    return ports;
}

bool SurfaceEffect::has_relief() const {
    return !params_.normal_map.map.empty() && params_.normal_map.strength != 0.0;
}

std::span<const ProgramDesc> SurfaceEffect::programs() const {
    std::vector<std::string> common;
    const auto add = [&common](bool when, std::string define) {
        if (when) {
            common.push_back(std::move(define));
        }
    };
    add(has_relief(), "NORMAL_MAP");
    add(!params_.lights.empty(), "LIGHTS " + std::to_string(params_.lights.size()));
    add(std::ranges::any_of(params_.lights, glows), "GLOW");
    add(params_.focus.has_value(), "FOCUS");
    add(params_.blending == Blending::blended, "BLENDED");

    const auto defines_of = [&](const Variant& variant) {
        std::vector<std::string> defines = common;
        const auto with = [&defines](bool when, std::string_view define, std::string_view value = "") {
            if (when) {
                defines.push_back(std::string(define) + std::string(value));
            }
        };
        const auto uv = [](const AssetPath& file) { return file.empty() ? tissue_uv : own_uv; };
        with(variant.diffuse, "DIFFUSE_MAP", uv(params_.diffuse_map));
        with(variant.energy, "ENERGY");
        with(variant.energy && params_.coagulation.burn_curve == BurnCurve::thesis, "THESIS_BURN");
        with(variant.blood, "BLOOD");
        with(variant.relief == BloodRelief::normal, "BLOOD_NORMAL");
        with(variant.relief == BloodRelief::height, "BLOOD_HEIGHT");
        with(variant.cut, "CUT", uv(params_.cut.map));
        with(variant.cut && !params_.cut.vertex_scalar.empty(), "CUT_BY_VERTEX");
        with(variant.hint, "HINT", uv(params_.hint.map));
        with(variant.hematoma, "HEMATOMA",
             params_.hematoma.metric == SpotMetric::world ? std::string_view(" 1") : std::string_view(" 2"));
        return defines;
    };

    programs_.clear();
    variants_.clear();
    constexpr std::array<Variant, 4> bloods{{{},
                                             {.blood = true},
                                             {.blood = true, .relief = BloodRelief::normal},
                                             {.blood = true, .relief = BloodRelief::height}}};
    for (const bool diffuse : choices(true, !params_.diffuse_map.empty())) {
        for (const bool energy : choices(true, false)) {
            for (const Variant& blood : bloods) {
                for (const bool cut : choices(true, !params_.cut.map.empty())) {
                    for (const bool hint : choices(true, false)) {
                        for (const bool hematoma : choices(params_.hematoma.used(), false)) {
                            Variant variant = blood;
                            variant.diffuse = diffuse;
                            variant.energy = energy;
                            variant.cut = cut;
                            variant.hint = hint;
                            variant.hematoma = hematoma;
                            variants_.push_back(variant);
                            programs_.push_back(
                                {"organ/surface.vert", "organ/surface.frag", defines_of(variant), ""});
                        }
                    }
                }
            }
        }
    }
    return programs_;
}

}  // namespace viscera::organ
