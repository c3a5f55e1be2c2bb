#include "effects/filter/gaussian_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/log.h"
#include "engine/runtime/pass.h"

namespace viscera::filter {
namespace {

constexpr std::array<std::string_view, 2> axis_names{"x", "y"};

}  // namespace

std::span<const std::string_view> choice_names(Axis) {
    return axis_names;
}

void GaussianParams::visit(ParamVisitor& v) {
    v.field({.name = "axis", .doc = "Direction of this pass; a second pass takes the other."}, axis);
    v.field({.name = "sigma",
             .doc = "Standard deviation as a fraction of the target's height; 0: no blur.",
             .min = 0.0,
             .max = 0.5},
            sigma);
    v.field({.name = "gain", .doc = "Factor on the result, which is cut at 1.", .min = 0.0, .max = 65504.0},
            gain);
}

GaussianTaps make_gaussian(double sigma_pixels) {
    GaussianTaps taps;
    if (!(sigma_pixels > 0.0)) {
        return taps;
    }
    const int radius =
        std::min(static_cast<int>(std::ceil(3.0 * sigma_pixels)), static_cast<int>(2 * gaussian_taps));
    const auto weight = [&](int i) {
        return i > radius ? 0.0 : std::exp(-0.5 * i * i / (sigma_pixels * sigma_pixels));
    };
    double sum = 1.0;
    for (int i = 1; i <= radius; i += 2) {
        const double pair = weight(i) + weight(i + 1);
        // Both weights are positive, so one linear fetch between the two pixels reads their weighted sum.
        taps.pairs.emplace_back(i + weight(i + 1) / pair, pair);
        sum += 2.0 * pair;
    }
    taps.centre = 1.0 / sum;
    for (glm::dvec2& pair : taps.pairs) {
        pair.y /= sum;
    }
    return taps;
}

GaussianEffect::GaussianEffect() {
    for (std::size_t taps = 0; taps <= gaussian_taps; ++taps) {
        programs_.push_back(
            {"common/fullscreen.vert", "filter/gaussian.frag", {"TAPS " + std::to_string(taps)}});
    }
}

std::vector<Port> GaussianEffect::ports() const {
    return {{.name = "blurred",
             .access = Access::write,
             .target = "filter.blurred",
             .doc = "The blurred picture, one channel.",
             .overwrites = true},
            {.name = "source",
             .access = Access::read,
             .target = "filter.source",
             .doc = "The picture, one channel, of any resolution."}};
}

Work GaussianEffect::prepare(Prepare& prepare) {
    if (!prepare.has("source")) {
        return Work::idle("nothing to blur");
    }
    const double sigma_pixels = params_.sigma * prepare.size("blurred").y;
    if (sigma_pixels != sigma_pixels_) {
        sigma_pixels_ = sigma_pixels;
        taps_ = make_gaussian(sigma_pixels);
        std::ranges::transform(taps_.pairs, uniform_.begin(),
                               [](const glm::dvec2& pair) { return glm::vec2(pair); });
        if (sigma_pixels > 2.0 * static_cast<double>(gaussian_taps) / 3.0) {
            prepare.log().fault("filter.gaussian_sigma",
                                "a Gaussian of " + std::to_string(sigma_pixels) +
                                    " pixels is cut short of 3 sigma; blur at a lower resolution");
        }
    }
    return Work::all(prepare.parameters_key());
}

void GaussianEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(taps_.pairs.size());
    pass.bind(program, "u_source", "source", gl::Filter::linear);
    const glm::vec2 texel = 1.0F / glm::vec2(pass.size());
    program.set("u_direction", params_.axis == Axis::x ? glm::vec2(texel.x, 0.0F) : glm::vec2(0.0F, texel.y));
    program.set("u_centre", static_cast<float>(taps_.centre));
    program.set("u_taps", std::span<const glm::vec2>(uniform_));
    program.set("u_gain", static_cast<float>(params_.gain));
    pass.draw_fullscreen();
}

}  // namespace viscera::filter
