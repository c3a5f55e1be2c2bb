#include "engine/runtime/pass.h"

#include <algorithm>

namespace viscera {

Samplers::Samplers(const gl::Functions& gl)
    : samplers_{gl::Sampler(gl, {.filter = gl::Filter::nearest, .wrap = gl::Wrap::clamp}),
                gl::Sampler(gl, {.filter = gl::Filter::nearest, .wrap = gl::Wrap::repeat}),
                gl::Sampler(gl, {.filter = gl::Filter::nearest, .wrap = gl::Wrap::border}),
                gl::Sampler(gl, {.filter = gl::Filter::linear, .wrap = gl::Wrap::clamp}),
                gl::Sampler(gl, {.filter = gl::Filter::linear, .wrap = gl::Wrap::repeat}),
                gl::Sampler(gl, {.filter = gl::Filter::linear, .wrap = gl::Wrap::border}),
                gl::Sampler(gl, {.filter = gl::Filter::trilinear, .wrap = gl::Wrap::clamp}),
                gl::Sampler(gl, {.filter = gl::Filter::trilinear, .wrap = gl::Wrap::repeat}),
                gl::Sampler(gl, {.filter = gl::Filter::trilinear, .wrap = gl::Wrap::border})} {}

const gl::Sampler& Samplers::get(gl::Filter filter, gl::Wrap wrap) const {
    return samplers_[static_cast<std::size_t>(filter) * 3 + static_cast<std::size_t>(wrap)];
}

const gl::Texture* Pass::texture(std::string_view port) const {
    const auto found = std::ranges::find(inputs_, port, &Input::port);
    return found == inputs_.end() ? nullptr : found->texture;
}

const gl::Program& Pass::use(std::size_t index) const {
    const gl::Program& program = shared_.shaders.program(*programs_[index]);
    program.use();
    return program;
}

void Pass::bind(const gl::Program& program, std::string_view uniform, std::string_view port,
                gl::Filter filter, gl::Wrap wrap) const {
    const gl::Texture* found = texture(port);
    bind(program, uniform, found == nullptr ? shared_.black : *found, filter, wrap);
}

void Pass::bind(const gl::Program& program, std::string_view uniform, const gl::Texture& texture,
                gl::Filter filter, gl::Wrap wrap) const {
    program.bind(uniform, texture, shared_.samplers.get(filter, wrap));
}

void Pass::raster(const gl::RasterState& state) const {
    gl::RasterState confined = state;
    if (bounds_ != PixelRect{0, 0, size_.x, size_.y}) {
        confined.scissor = gl::Rect{bounds_.x, bounds_.y, bounds_.width, bounds_.height};
    }
    gl::apply(gl(), confined, {0, 0, size_.x, size_.y});
}

void Pass::draw_fullscreen() const {
    if (rects().size() == 1) {
        draw_generated(GL_TRIANGLES, 3, 1);
        return;
    }
    for (const PixelRect& rect : rects()) {
        gl().Enable(GL_SCISSOR_TEST);
        gl().Scissor(rect.x, rect.y, rect.width, rect.height);
        draw_generated(GL_TRIANGLES, 3, 1);
    }
}

void Pass::draw_generated(GLenum mode, int vertices, int instances) const {
    shared_.no_vertices.bind();
    gl().DrawArraysInstanced(mode, 0, vertices, instances);
}

bool Pass::compute(std::string_view port) const {
    if (!shared_.compute) {
        return false;
    }
    const auto found = std::ranges::find(outputs_, port, &Output::port);
    return found != outputs_.end() && found->texture != nullptr && found->texture->owned() &&
           found->texture->format().external != GL_DEPTH_COMPONENT;
}

void Pass::dispatch(const gl::Program& program, std::string_view port) const {
    dispatch(program, *std::ranges::find(outputs_, port, &Output::port)->texture, rects());
    dispatched_ = true;
}

void Pass::dispatch(const gl::Program& program, const gl::Texture& target) const {
    const PixelRect all{0, 0, target.width(), target.height()};
    dispatch(program, target, std::span(&all, 1));
}

void Pass::dispatch(const gl::Program& program, const gl::Texture& target,
                    std::span<const PixelRect> rects) const {
    const gl::Functions& gl = shared_.gl;
    const auto groups = [](int pixels, int size) { return static_cast<GLuint>((pixels + size - 1) / size); };
    const glm::ivec3 size = program.group_size();
    gl.BindImageTexture(gl::image_unit, target.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, target.format().internal);
    for (const PixelRect& rect : rects) {
        program.set("u_region", glm::ivec4(rect.x, rect.y, rect.width, rect.height));
        gl.DispatchCompute(groups(rect.width, size.x), groups(rect.height, size.y), 1);
    }
    // Whatever may be done with a target next: read in a shader, drawn into, read back, copied, filled again.
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT |
                     GL_TEXTURE_UPDATE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    gl.BindImageTexture(gl::image_unit, 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R8);
}

}  // namespace viscera
