#include "engine/runtime/presenter.h"

namespace viscera {

Presenter::Presenter(const Pass::Shared& shared)
    : shared_(shared),
      program_(shared.shaders.entry({"common/fullscreen.vert", "common/present.frag", {}})) {}

void Presenter::present(const Present& present, const gl::Texture* texture, const PlanContent& content) {
    const gl::Functions& gl = shared_.gl;
    const gl::Rect viewport{present.viewport.x, present.viewport.y, present.viewport.width,
                            present.viewport.height};
    gl::RasterState state = gl::overwrite_state;
    state.scissor = viewport;  // a clear, too, must not leave the viewport
    gl.BindFramebuffer(GL_FRAMEBUFFER, present.framebuffer);
    gl::apply(gl, state, viewport);
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
