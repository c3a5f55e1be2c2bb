#include "effects/picture/image_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::picture {
namespace {

constexpr std::array<std::string_view, 3> fit_names{"cover", "stretch", "height"};

/// Nothing that is not finite may reach a target: such texels count as black, and are counted.
Image finite_picture(const Image& image, Log& log, const std::string& file) {
    Image clean = image;
    std::uint64_t faults = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                if (!std::isfinite(image.at(x, y, c))) {
                    clean.set(x, y, c, 0.0F);
                    ++faults;
                }
            }
        }
    }
    if (faults > 0) {
        log.fault("picture.not_finite", file + " has values that are not finite; they show as 0", faults);
    }
    return clean;
}

}  // namespace

std::span<const std::string_view> choice_names(Fit) {
    return fit_names;
}

void ImageParams::visit(ParamVisitor& v) {
    v.field({.name = "file", .doc = "PNG, JPEG or EXR; values are taken as stored.", .required = true}, file);
    v.field({.name = "fit",
             .doc = "cover cuts off what does not fit; stretch gives up the shape; height is as high as the "
                    "target and black beside."},
            fit);
    v.field({.name = "gain", .doc = "Factor on the values.", .min = 0.0, .max = 65504.0}, gain);
    v.field({.name = "monochrome", .doc = "One channel, the file's first; otherwise four."}, monochrome);
}

ImageEffect::ImageEffect()
    : programs_{{"common/fullscreen.vert", "picture/image.frag", {}},
                {"common/fullscreen.vert", "picture/image.frag", {"MONOCHROME"}}} {}

std::vector<Port> ImageEffect::ports() const {
    return {{.name = "image",
             .access = Access::write,
             .target = "background",
             .doc = "The picture.",
             .format = params_.monochrome ? PixelFormat::r16f : PixelFormat::rgba16f,
             .overwrites = true}};
}

Work ImageEffect::prepare(Prepare& prepare) {
    return Work::all(prepare.parameters_key());
}

void ImageEffect::draw(const Pass& pass) {
    const gl::Texture& texture =
        *pass.assets().shared<gl::Texture>(pass.assets().file_key(params_.file.path), [&] {
            const std::string file = params_.file.path.string();
            const std::shared_ptr<const Image> image = pass.assets().image(params_.file.path);
            return std::make_shared<gl::Texture>(
                gl::Texture::from_image(pass.gl(), finite_picture(*image, pass.log(), file), file));
        });
    glm::dvec2 scale(1.0);
    if (params_.fit != Fit::stretch) {
        const double ratio = (static_cast<double>(pass.size().x) / pass.size().y) /
                             (static_cast<double>(texture.width()) / texture.height());
        scale = params_.fit == Fit::height ? glm::dvec2(ratio, 1.0)
                                           : glm::dvec2(std::min(1.0, ratio), std::min(1.0, 1.0 / ratio));
    }
    const gl::Program& program = pass.use(params_.monochrome ? 1 : 0);
    pass.bind(program, "u_image", texture);
    program.set("u_scale", glm::vec2(scale));
    program.set("u_offset", glm::vec2(0.5 - 0.5 * scale));
    program.set("u_gain", static_cast<float>(params_.gain));
    pass.draw_fullscreen();
}

}  // namespace viscera::picture
