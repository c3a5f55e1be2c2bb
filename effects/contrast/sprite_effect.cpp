#include "effects/contrast/sprite_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/size_text.h"
#include "engine/gl/texture.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/pass.h"

namespace viscera::contrast {
namespace {

constexpr std::size_t batch = 16;               // as glsl/contrast/sprites.vert
constexpr std::size_t floats_per_emitter = 10;  // base, tip, edge, size

gl::Texture upload(const gl::Functions& gl, std::span<const std::shared_ptr<const Image>> layers,
                   std::string_view label) {
    const Image& first = *layers.front();
    std::vector<unsigned short> texels;
    for (const std::shared_ptr<const Image>& layer : layers) {
        const int channels = layer->channels();
        const std::vector<float> values = to_floats(*layer);
        for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(channels)) {
            texels.push_back(
                float_to_half(std::isfinite(values[i]) ? std::clamp(values[i], 0.0F, 1.0F) : 0.0F));
        }
    }
    const gl::TextureFormat format = gl::texture_format(PixelFormat::r16f);
    gl::Texture texture =
        layers.size() == 1
            ? gl::Texture::make_2d(gl, first.width, first.height, format, label)
            : gl::Texture::make_3d(gl, {first.width, first.height, static_cast<int>(layers.size())}, format,
                                   label);
    texture.upload(std::as_bytes(std::span(texels)));
    return texture;
}

}  // namespace

/// The smoke's pictures on the GPU, shared by all passes that name the same files.
struct SpriteEffect::Pictures {
    Pictures(const gl::Functions& gl, Assets& assets, const SpriteParams& params)
        : views(upload(gl, load(assets, params), "views")) {
        if (!params.front.empty()) {
            const std::shared_ptr<const Image> image = assets.image(params.front.path);
            front.emplace(upload(gl, std::span(&image, 1), "front"));
        }
    }
    static std::vector<std::shared_ptr<const Image>> load(Assets& assets, const SpriteParams& params) {
        std::vector<std::shared_ptr<const Image>> images;
        for (const SpriteViewParams& view : params.views) {
            images.push_back(assets.image(view.image.path));
            const Image& image = *images.back();
            if (image.width != images.front()->width || image.height != images.front()->height) {
                throw Error(ErrorCode::scene, "/views/" + std::to_string(images.size() - 1) + "/image",
                            view.image.path.string() + " has " + size_text({image.width, image.height}) +
                                " pixels, the first view's picture " +
                                size_text({images.front()->width, images.front()->height}) +
                                "; all views need the same size");
            }
        }
        if (images.size() == 1) {
            images.push_back(
                images.front());  // a volume texture of its own kind, whatever the number of views
        }
        return images;
    }
    gl::Texture views;  ///< one layer per view, in the order of the parameters
    std::optional<gl::Texture> front;
};

void SpriteViewParams::visit(ParamVisitor& v) {
    v.field({.name = "angle_deg",
             .doc = "Between the line of sight and the smoke's axis: 90 is from the side.",
             .unit = "deg",
             .min = 0.0,
             .max = 90.0},
            angle_deg);
    v.field({.name = "image",
             .doc = "One-channel picture; the smoke starts at (0.55, 0.15) and rises.",
             .required = true},
            image);
}

void SpriteParams::visit(ParamVisitor& v) {
    v.field({.name = "emitters", .doc = "Where contrast leaves the vessel."}, emitters);
    v.field({.name = "host_emitters",
             .doc = "Name of a host array with more: base, tip, edge [mm] and size, 10 floats each."},
            host_emitters);
    v.field({.name = "views",
             .doc = "Pictures of the smoke by rising angle; between two of them it is blended.",
             .required = true},
            views);
    v.field({.name = "front",
             .doc = "Picture of the smoke coming towards the eye, added as the axis turns to it."},
            front);
}

SpriteEffect::SpriteEffect(std::string target) : target_(std::move(target)) {
    for (int bits = 0; bits < 4; ++bits) {
        ProgramDesc program{"contrast/sprites.vert", "contrast/sprites.frag", {}};
        if ((bits & 1) != 0) {
            program.defines.emplace_back("FRONT");
        }
        if ((bits & 2) != 0) {
            program.defines.emplace_back("MASK");
        }
        programs_.push_back(std::move(program));
    }
}

void SpriteEffect::validate() const {
    if (params_.views.empty()) {
        throw Error(ErrorCode::scene, "/views", "needs at least one picture");
    }
    const auto falls = [](const SpriteViewParams& a, const SpriteViewParams& b) {
        return a.angle_deg >= b.angle_deg;
    };
    if (std::ranges::adjacent_find(params_.views, falls) != params_.views.end()) {
        throw Error(ErrorCode::scene, "/views", "angles must rise from one view to the next");
    }
}

std::vector<Port> SpriteEffect::ports() const {
    return {{.name = "smoke",
             .access = Access::write,
             .target = target_,
             .doc = "Density of the smoke, the densest of all emitters."},
            {.name = "summary",
             .access = Access::read,
             .target = "contrast.summary",
             .doc = "The vessels: smoke is as dense as they are at its base."},
            {.name = "mask_sharp",
             .access = Access::read,
             .target = "",
             .doc = "Silhouette in which smoke may show near its base.",
             .optional = true},
            {.name = "mask_blurred",
             .access = Access::read,
             .target = "",
             .doc = "The same, blurred, further off.",
             .optional = true}};
}

void SpriteEffect::collect(const Frame& frame, Log& log) {
    emitters_.assign(params_.emitters.begin(), params_.emitters.end());
    const HostValues::Entry* given = frame.values == nullptr || params_.host_emitters.empty()
                                         ? nullptr
                                         : frame.values->find(params_.host_emitters);
    if (given == nullptr) {
        return;
    }
    if (given->values.size() % floats_per_emitter != 0) {
        log.fault("contrast.host_emitters", "host values '" + params_.host_emitters +
                                                "' are no multiple of 10 floats; the rest is not used");
    }
    for (std::size_t i = 0; i + floats_per_emitter <= given->values.size(); i += floats_per_emitter) {
        const float* f = &given->values[i];
        emitters_.push_back({.base_mm = {f[0], f[1], f[2]},
                             .tip_mm = {f[3], f[4], f[5]},
                             .edge_mm = {f[6], f[7], f[8]},
                             .size = f[9]});
    }
}

void SpriteEffect::report(EmitterFault fault, Log& log) const {
    switch (fault) {
        case EmitterFault::not_finite:
            return log.fault("contrast.emitter_not_finite",
                             target_ + ": an emitter has a coordinate that is not finite; it gives no smoke");
        case EmitterFault::no_length:
            return log.fault("contrast.emitter_length",
                             target_ + ": an emitter's base and tip fall on one point; it gives no smoke");
        case EmitterFault::behind_camera:
            return log.fault("contrast.emitter_behind",
                             target_ + ": an emitter lies behind the camera; it gives no smoke");
        case EmitterFault::none:
        case EmitterFault::off_screen:
        case EmitterFault::not_active:
            return;
    }
}

bool SpriteEffect::add_quads(Prepare& prepare) {
    const Frame& frame = prepare.frame();
    quads_.clear();
    bool active = false;
    for (const EmitterParams& emitter : emitters_) {
        if (frame.time_s < emitter.start_s || frame.time_s > emitter.stop_s || emitter.strength == 0.0) {
            continue;
        }
        active = true;
        SpriteQuad quad;
        const EmitterFault fault =
            place(emitter, frame.eye(), prepare.size("smoke"), !params_.front.empty(), quad);
        report(fault, prepare.log());
        if (fault == EmitterFault::none) {
            quads_.push_back(quad);
        }
    }
    idle_reason_ = active ? "no emitter in the view" : "no emitter active";
    return !quads_.empty();
}

Work SpriteEffect::prepare(Prepare& prepare) {
    if (!prepare.has("summary")) {
        return Work::idle("no contrast that could leave the vessels");
    }
    masked_ = prepare.size("mask_sharp").x > 0 && prepare.size("mask_blurred").x > 0;
    if (masked_ && !prepare.has("mask_sharp") && !prepare.has("mask_blurred")) {
        return Work::idle("the mask is empty");
    }
    collect(prepare.frame(), prepare.log());
    if (!add_quads(prepare)) {
        return Work::idle(idle_reason_);
    }
    Hash key;
    key.add(prepare.parameters_key());
    PixelRect cover = quads_.front().cover;
    for (const SpriteQuad& quad : quads_) {
        key.add(quad.base)
            .add(quad.tip)
            .add(quad.width)
            .add(quad.front_width)
            .add(quad.angle_deg)
            .add(quad.strength);
        const int right = std::max(cover.x + cover.width, quad.cover.x + quad.cover.width);
        const int top = std::max(cover.y + cover.height, quad.cover.y + quad.cover.height);
        cover.x = std::min(cover.x, quad.cover.x);
        cover.y = std::min(cover.y, quad.cover.y);
        cover.width = right - cover.x;
        cover.height = top - cover.y;
    }
    return Work::in_region(cover, "only the emitters' own quads", key.value());
}

double SpriteEffect::layer_of(double angle_deg) const {
    const auto& views = params_.views;
    const double layers = static_cast<double>(std::max<std::size_t>(views.size(), 2));
    const auto above = std::ranges::upper_bound(views, angle_deg, {}, &SpriteViewParams::angle_deg);
    double layer = 0.0;
    if (above == views.end()) {
        layer = static_cast<double>(views.size() - 1);
    } else if (above != views.begin()) {
        const SpriteViewParams& below = *(above - 1);
        layer = static_cast<double>(above - views.begin() - 1) +
                (angle_deg - below.angle_deg) / (above->angle_deg - below.angle_deg);
    }
    return (layer + 0.5) / layers;
}

void SpriteEffect::draw(const Pass& pass) {
    Hash key;
    for (const SpriteViewParams& view : params_.views) {
        key.add(pass.assets().file_key(view.image.path));
    }
    key.add(pass.assets().file_key(params_.front.path));
    const Pictures& pictures = *pass.assets().shared<Pictures>(
        key.value(), [&] { return std::make_shared<Pictures>(pass.gl(), pass.assets(), params_); });
    const gl::Program& program = pass.use((pictures.front ? 1U : 0U) | (masked_ ? 2U : 0U));
    pass.bind(program, "u_summary", "summary", gl::Filter::linear);
    pass.bind(program, "u_views", pictures.views);
    if (pictures.front) {
        pass.bind(program, "u_front", *pictures.front);
    }
    const glm::vec2 size(pass.size());
    if (masked_) {
        const auto same = [&](const char* port) {
            const gl::Texture* mask = pass.texture(port);
            return mask != nullptr && mask->width() == pass.size().x && mask->height() == pass.size().y;
        };
        pass.bind(program, "u_mask_sharp", "mask_sharp", gl::Filter::linear);
        pass.bind(program, "u_mask_blurred", "mask_blurred", gl::Filter::linear);
        program.set("u_sharp_same_size", same("mask_sharp"));
        program.set("u_blurred_same_size", same("mask_blurred"));
        program.set("u_inv_size", 1.0F / size);
    }
    pass.raster(gl::max_blend_state);
    for (std::size_t first = 0; first < quads_.size(); first += batch) {
        const std::size_t count = std::min(batch, quads_.size() - first);
        std::array<glm::vec4, batch> rect{};
        std::array<glm::vec3, batch> source{};
        std::array<glm::vec4, batch> base{};
        std::array<glm::vec4, batch> tip{};
        std::array<glm::vec4, batch> axis{};
        std::array<glm::vec3, batch> view{};
        for (std::size_t i = 0; i < count; ++i) {
            const SpriteQuad& quad = quads_[first + i];
            const glm::dvec2 whole_base = glm::floor(quad.base);
            const glm::dvec2 whole_tip = glm::floor(quad.tip);
            const glm::vec2 low(quad.cover.x, quad.cover.y);
            rect[i] = glm::vec4(low / size, (low + glm::vec2(quad.cover.width, quad.cover.height)) / size);
            source[i] = glm::vec3(quad.base / glm::dvec2(size), quad.strength);
            // Of no width: counted from far outside the target, no pixel lies in the side view, and all of
            // them far off from the base.
            const bool side = quad.width > 0.0;
            base[i] =
                side ? glm::vec4(whole_base, quad.base - whole_base) : glm::vec4(-1e6F, -1e6F, 0.0F, 0.0F);
            tip[i] = glm::vec4(whole_tip, quad.tip - whole_tip);
            axis[i] = glm::vec4(glm::vec2(quad.axis), side ? 1.0 / quad.width : 1.0,
                                side ? 1.0 / (0.3 * quad.length) : 1.0);
            view[i] = glm::vec3(layer_of(quad.angle_deg),
                                quad.front_width > 0.0 ? 1.0 / quad.front_width : 0.0, quad.front_weight);
        }
        program.set("u_rect", std::span<const glm::vec4>(rect));
        program.set("u_source", std::span<const glm::vec3>(source));
        program.set("u_base", std::span<const glm::vec4>(base));
        program.set("u_tip", std::span<const glm::vec4>(tip));
        program.set("u_axis", std::span<const glm::vec4>(axis));
        program.set("u_view", std::span<const glm::vec3>(view));
        pass.draw_generated(GL_TRIANGLE_STRIP, 4, static_cast<int>(count));
    }
}

}  // namespace viscera::contrast
