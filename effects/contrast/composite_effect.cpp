#include "effects/contrast/composite_effect.h"

#include <array>
#include <cmath>

#include "engine/runtime/pass.h"

namespace viscera::contrast {
namespace {

constexpr std::array<std::string_view, 2> tone_names{"beer_lambert", "thesis"};

struct Layer {
    const char* port;
    const char* target;
    const char* define;
    const char* uniform;
    const char* doc;
    gl::Filter filter = gl::Filter::nearest;
};
// What a scene may lay over one another; each is compiled out where it is empty.
constexpr std::array<Layer, 5> layers{{
    {"background", "background", "BACKGROUND", "u_background", "The picture without contrast, one channel."},
    {"summary", "contrast.summary", "SUMMARY", "u_summary", "The vessels."},
    {"reflux", "contrast.reflux", "REFLUX", "u_reflux", "Smoke that flows back."},
    {"extravasate", "contrast.extravasate", "EXTRAVASATE", "u_extravasate",
     "Smoke that leaves a ruptured vessel."},
    {"capillary", "contrast.capillary", "CAPILLARY", "u_capillary",
     "Blush of the small vessels; of any resolution.", gl::Filter::linear},
}};
constexpr std::size_t combinations = 1U << layers.size();

}  // namespace

std::span<const std::string_view> choice_names(Tone) {
    return tone_names;
}

void CompositeParams::visit(ParamVisitor& v) {
    v.field({.name = "tone",
             .doc = "beer_lambert attenuates the background; thesis is the published curve, which jumps."},
            tone);
    v.field({.name = "darkest",
             .doc = "beer_lambert: transmission of the densest contrast.",
             .min = 0.0,
             .max = 1.0,
             .min_excluded = true},
            darkest);
    v.field(
        {.name = "background", .doc = "Level where there is no background picture.", .min = 0.0, .max = 1.0},
        background);
}

CompositeEffect::CompositeEffect() {
    for (std::size_t index = 0; index < 2 * combinations; ++index) {
        ProgramDesc program{"common/fullscreen.vert", "contrast/composite.frag", {}};
        for (std::size_t i = 0; i < layers.size(); ++i) {
            if (((index >> i) & 1U) != 0) {
                program.defines.emplace_back(layers[i].define);
            }
        }
        if (index >= combinations) {
            program.defines.emplace_back("THESIS_TONE");
        }
        programs_.push_back(std::move(program));
    }
}

std::vector<Port> CompositeEffect::ports() const {
    std::vector<Port> ports{{.name = "final",
                             .access = Access::write,
                             .target = "final",
                             .doc = "The picture on the detector.",
                             .overwrites = true}};
    for (const Layer& layer : layers) {
        ports.push_back({.name = layer.port,
                         .access = Access::read,
                         .target = layer.target,
                         .doc = layer.doc,
                         .optional = true});
    }
    return ports;
}

Work CompositeEffect::prepare(Prepare& prepare) {
    return Work::all(prepare.parameters_key());
}

void CompositeEffect::draw(const Pass& pass) {
    std::size_t index = params_.tone == Tone::thesis ? combinations : 0;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        index |= pass.has(layers[i].port) ? std::size_t{1} << i : 0;
    }
    const gl::Program& program = pass.use(index);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (((index >> i) & 1U) != 0) {
            pass.bind(program, layers[i].uniform, layers[i].port, layers[i].filter);
        }
    }
    program.set("u_background_level", static_cast<float>(params_.background));
    program.set("u_attenuation", static_cast<float>(std::log2(params_.darkest)));
    pass.draw_fullscreen();
}

}  // namespace viscera::contrast
