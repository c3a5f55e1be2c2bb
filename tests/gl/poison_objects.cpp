#include "tests/gl/poison_objects.h"

namespace viscera::test {
namespace {

GLuint compile(const gl::Functions& gl, GLenum stage, const char* text) {
    const GLuint shader = gl.CreateShader(stage);
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    return shader;
}

GLuint make_program(const gl::Functions& gl) {
    const GLuint program = gl.CreateProgram();
    const GLuint vertex =
        compile(gl, GL_VERTEX_SHADER, "#version 330\nvoid main() { gl_Position = vec4(0.0); }");
    const GLuint fragment =
        compile(gl, GL_FRAGMENT_SHADER, "#version 330\nout vec4 c; void main() { c = vec4(9.0); }");
    gl.AttachShader(program, vertex);
    gl.AttachShader(program, fragment);
    gl.LinkProgram(program);
    gl.DeleteShader(vertex);
    gl.DeleteShader(fragment);
    return program;
}

}  // namespace

ScopedPoison::ScopedPoison(const gl::Functions& gl) : gl_(gl) {
    const bool has_4_0 = gl.VERSION_4_0 != 0;
    gl.ActiveTexture(GL_TEXTURE0);
    gl.GenTextures(static_cast<GLsizei>(objects_.textures.size()), objects_.textures.data());
    for (std::size_t i = 0; i < objects_.textures.size() - (has_4_0 ? 0 : 1); ++i) {
        gl.BindTexture(gl::texture_bindings[i].target, objects_.textures[i]);
    }
    gl.GenSamplers(1, &objects_.sampler);
    gl.GenBuffers(1, &objects_.buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, objects_.buffer);
    gl.BufferData(GL_ARRAY_BUFFER, 256, nullptr, GL_STATIC_DRAW);
    gl.GenVertexArrays(1, &objects_.vertex_array);
    gl.BindVertexArray(objects_.vertex_array);
    gl.GenRenderbuffers(1, &objects_.renderbuffer);
    gl.BindRenderbuffer(GL_RENDERBUFFER, objects_.renderbuffer);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 4, 4);
    gl.GenFramebuffers(1, &objects_.framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, objects_.framebuffer);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, objects_.renderbuffer);
    objects_.program = make_program(gl);
    gl.GenQueries(1, &objects_.query);
    if (has_4_0) {
        gl.GenTransformFeedbacks(1, &objects_.feedback);
        gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, objects_.feedback);
        gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0);
    }
    gl.BindVertexArray(0);
    gl.BindBuffer(GL_ARRAY_BUFFER, 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl.BindRenderbuffer(GL_RENDERBUFFER, 0);
    for (std::size_t i = 0; i < objects_.textures.size() - (has_4_0 ? 0 : 1); ++i) {
        gl.BindTexture(gl::texture_bindings[i].target, 0);
    }
}

ScopedPoison::~ScopedPoison() {
    gl_.DeleteTextures(static_cast<GLsizei>(objects_.textures.size()), objects_.textures.data());
    gl_.DeleteSamplers(1, &objects_.sampler);
    gl_.DeleteBuffers(1, &objects_.buffer);
    gl_.DeleteVertexArrays(1, &objects_.vertex_array);
    gl_.DeleteRenderbuffers(1, &objects_.renderbuffer);
    gl_.DeleteFramebuffers(1, &objects_.framebuffer);
    gl_.DeleteProgram(objects_.program);
    gl_.DeleteQueries(1, &objects_.query);
    if (objects_.feedback != 0) {
        gl_.DeleteTransformFeedbacks(1, &objects_.feedback);
    }
}

}  // namespace viscera::test
