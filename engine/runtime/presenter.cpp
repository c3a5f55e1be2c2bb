#include "engine/runtime/presenter.h"

#include <string>

#include "engine/core/error.h"
#include "engine/core/eyes.h"
#include "engine/runtime/executor.h"

namespace viscera {
namespace {

/// Throws unless the framebuffer can be drawn into, which a host may get wrong; binds it.
void bind(const gl::Functions& gl, const Present& present) {
    const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::usage, "present", why); };
    const std::string name = "framebuffer " + std::to_string(present.framebuffer);
    if (present.viewport.width < 0 || present.viewport.height < 0) {
        refuse("the viewport's size is negative");
    }
    if (present.framebuffer != 0 && gl.IsFramebuffer(present.framebuffer) == GL_FALSE) {
        refuse(name + " does not exist in this context");
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, present.framebuffer);
    if (gl.CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        refuse(name +
               (present.framebuffer == 0 ? " does not exist: the context has no surface" : " is incomplete"));
    }
}

}  // namespace

Presenter::Presenter(const Pass::Shared& shared)
    : shared_(shared),
      program_(shared.shaders.entry({"common/fullscreen.vert", "common/present.frag", {}})) {}

void Presenter::present(const Frame& frame, const std::string& first_output, const Executor& executor) {
    const auto name = [&](const Present& present) -> const std::string& {
        return present.output.empty() ? first_output : present.output;
    };
    const bool apart = frame.eye_count == 2 && frame.present_right.enabled;
    if (frame.present.enabled) {
        show(frame.present, name(frame.present), apart ? 0 : -1, executor);
    }
    if (apart) {
        show(frame.present_right, name(frame.present_right), 1, executor);
    }
}

void Presenter::show(const Present& present, const std::string& name, int eye, const Executor& executor) {
    const auto show_one = [&](const Executor::Output& output, const PixelRect& viewport) {
        draw(present, viewport, output.texture, *output.content);
    };
    if (const auto own = eye < 0 ? std::nullopt : executor.output(eye_name(name, eye))) {
        return show_one(*own, present.viewport);
    }
    if (const auto output = executor.output(name)) {
        return show_one(*output, present.viewport);
    }
    const auto left = executor.output(eye_name(name, 0));
    const auto right = executor.output(eye_name(name, 1));
    if (!left || !right) {
        throw Error(ErrorCode::usage, name, "cannot be presented: it is no output of the scene");
    }
    PixelRect half = present.viewport;
    half.width /= 2;
    show_one(*left, half);
    half.x += half.width;
    half.width = present.viewport.width - half.width;
    show_one(*right, half);
}

void Presenter::draw(const Present& present, const PixelRect& viewport, const gl::Texture* texture,
                     const PlanContent& content) {
    const gl::Functions& gl = shared_.gl;
    const gl::Rect place{viewport.x, viewport.y, viewport.width, viewport.height};
    gl::RasterState state = gl::overwrite_state;
    state.scissor = place;  // a clear, too, must not leave the viewport
    bind(gl, present);
    gl::apply(gl, state, place);
    const bool grey = info(content.format).channels == 1;
    if (texture == nullptr) {
        const auto& c = content.clear;
        gl.ClearColor(c[0], grey ? c[0] : c[1], grey ? c[0] : c[2], grey ? 1.0F : c[3]);
        gl.Clear(GL_COLOR_BUFFER_BIT);
        return;
    }
    const gl::Program& program = shared_.shaders.program(program_);
    program.use();
    program.set("u_grey", grey);
    program.set("u_flip", present.flip_y);
    program.bind("u_source", *texture, shared_.samplers.get(gl::Filter::linear, gl::Wrap::clamp));
    shared_.no_vertices.bind();
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace viscera
