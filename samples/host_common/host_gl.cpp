#include "samples/host_common/host_gl.h"

#include <stdexcept>
#include <string>

namespace host {
namespace {

template <class Function>
Function find(ProcAddress proc, const char* name) {
    return reinterpret_cast<Function>(proc(name));
}

GLuint compile(ProcAddress proc, GLenum stage, const char* text) {
    const GLuint shader = find<PFNGLCREATESHADERPROC>(proc, "glCreateShader")(stage);
    find<PFNGLSHADERSOURCEPROC>(proc, "glShaderSource")(shader, 1, &text, nullptr);
    find<PFNGLCOMPILESHADERPROC>(proc, "glCompileShader")(shader);
    GLint compiled = GL_FALSE;
    find<PFNGLGETSHADERIVPROC>(proc, "glGetShaderiv")(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_FALSE) {
        throw std::runtime_error("the host's shader does not compile");
    }
    return shader;
}

}  // namespace

Triangle::Triangle(ProcAddress proc) : proc_(proc) {
    const GLuint vertex = compile(proc, GL_VERTEX_SHADER,
                                  "#version 330 core\n"
                                  "void main() {\n"
                                  "    vec2 corner = vec2(gl_VertexID - 1, gl_VertexID == 1 ? 0.8 : -0.8);\n"
                                  "    gl_Position = vec4(0.8 * corner, 0.0, 1.0);\n"
                                  "}\n");
    const GLuint fragment = compile(proc, GL_FRAGMENT_SHADER,
                                    "#version 330 core\n"
                                    "out vec4 colour;\n"
                                    "void main() { colour = vec4(1.0, 0.6, 0.2, 1.0); }\n");
    program_ = find<PFNGLCREATEPROGRAMPROC>(proc, "glCreateProgram")();
    find<PFNGLATTACHSHADERPROC>(proc, "glAttachShader")(program_, vertex);
    find<PFNGLATTACHSHADERPROC>(proc, "glAttachShader")(program_, fragment);
    find<PFNGLLINKPROGRAMPROC>(proc, "glLinkProgram")(program_);
    find<PFNGLDELETESHADERPROC>(proc, "glDeleteShader")(vertex);
    find<PFNGLDELETESHADERPROC>(proc, "glDeleteShader")(fragment);
    find<PFNGLGENVERTEXARRAYSPROC>(proc, "glGenVertexArrays")(1, &vertices_);
    find<PFNGLUSEPROGRAMPROC>(proc, "glUseProgram")(program_);
    find<PFNGLBINDVERTEXARRAYPROC>(proc, "glBindVertexArray")(vertices_);
    find<PFNGLCLEARCOLORPROC>(proc, "glClearColor")(0.05F, 0.1F, 0.2F, 1.0F);
}

Triangle::~Triangle() {
    find<PFNGLDELETEVERTEXARRAYSPROC>(proc_, "glDeleteVertexArrays")(1, &vertices_);
    find<PFNGLDELETEPROGRAMPROC>(proc_, "glDeleteProgram")(program_);
}

void Triangle::draw(GLuint framebuffer, int width, int height) const {
    find<PFNGLBINDFRAMEBUFFERPROC>(proc_, "glBindFramebuffer")(GL_FRAMEBUFFER, framebuffer);
    find<PFNGLCLEARPROC>(proc_, "glClear")(GL_COLOR_BUFFER_BIT);
    find<PFNGLVIEWPORTPROC>(proc_, "glViewport")(0, 0, width / 2, height);
    find<PFNGLDRAWARRAYSPROC>(proc_, "glDrawArrays")(GL_TRIANGLES, 0, 3);
}

viscera::Image Triangle::read(GLuint framebuffer, int width, int height) const {
    viscera::Image image = viscera::make_image(width, height, viscera::PixelFormat::rgba8);
    find<PFNGLBINDFRAMEBUFFERPROC>(proc_, "glBindFramebuffer")(GL_FRAMEBUFFER, framebuffer);
    find<PFNGLREADPIXELSPROC>(proc_, "glReadPixels")(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE,
                                                     image.data.data());
    return image;
}

Offscreen::Offscreen(ProcAddress proc, int width, int height) : proc_(proc) {
    find<PFNGLGENTEXTURESPROC>(proc, "glGenTextures")(1, &texture_);
    find<PFNGLBINDTEXTUREPROC>(proc, "glBindTexture")(GL_TEXTURE_2D, texture_);
    find<PFNGLTEXIMAGE2DPROC>(proc, "glTexImage2D")(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA,
                                                    GL_UNSIGNED_BYTE, nullptr);
    find<PFNGLGENFRAMEBUFFERSPROC>(proc, "glGenFramebuffers")(1, &framebuffer_);
    find<PFNGLBINDFRAMEBUFFERPROC>(proc, "glBindFramebuffer")(GL_FRAMEBUFFER, framebuffer_);
    find<PFNGLFRAMEBUFFERTEXTURE2DPROC>(proc, "glFramebufferTexture2D")(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                                                                        GL_TEXTURE_2D, texture_, 0);
}

Offscreen::~Offscreen() {
    find<PFNGLDELETEFRAMEBUFFERSPROC>(proc_, "glDeleteFramebuffers")(1, &framebuffer_);
    find<PFNGLDELETETEXTURESPROC>(proc_, "glDeleteTextures")(1, &texture_);
}

}  // namespace host
