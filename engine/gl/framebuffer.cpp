#include "engine/gl/framebuffer.h"

#include <string>

#include "engine/core/error.h"
#include "engine/gl/debug.h"

namespace viscera::gl {
namespace {

FramebufferHandle make_framebuffer(const Functions& gl) {
    GLuint id = 0;
    gl.GenFramebuffers(1, &id);
    return FramebufferHandle::own(gl, id);
}

std::string_view status_text(GLenum status) {
    switch (status) {
        case GL_FRAMEBUFFER_UNDEFINED:
            return "there is no default framebuffer";
        case GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT:
            return "an attachment has no storage or a format that cannot be drawn into";
        case GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT:
            return "it has no attachment";
        case GL_FRAMEBUFFER_INCOMPLETE_DRAW_BUFFER:
        case GL_FRAMEBUFFER_INCOMPLETE_READ_BUFFER:
            return "a draw or read buffer names an attachment that is not there";
        case GL_FRAMEBUFFER_UNSUPPORTED:
            return "the driver does not support this combination of formats";
        case GL_FRAMEBUFFER_INCOMPLETE_MULTISAMPLE:
            return "the attachments differ in their number of samples";
        case GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS:
            return "the attachments differ in being layered";
        default:
            return "the driver gave no reason";
    }
}

void attach(const Functions& gl, GLenum point, const Texture& texture) {
    if (texture.target() != GL_TEXTURE_2D) {
        gl.FramebufferTextureLayer(GL_FRAMEBUFFER, point, texture.id(), 0, 0);
    } else {
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, point, texture.target(), texture.id(), 0);
    }
}

}  // namespace

Framebuffer::Framebuffer(const Functions& gl, std::span<const Texture* const> colours, const Texture* depth,
                         std::string_view label)
    : handle_(make_framebuffer(gl)) {
    if (colours.size() > draw_buffers) {
        throw Error(ErrorCode::usage, std::string(label),
                    std::to_string(colours.size()) + " colour attachments; at most " +
                        std::to_string(draw_buffers) + " are possible");
    }
    const auto take_size = [&](const Texture& texture) {
        if (width_ != 0 && (width_ != texture.width() || height_ != texture.height())) {
            throw Error(ErrorCode::usage, std::string(label), "its attachments differ in size");
        }
        width_ = texture.width();
        height_ = texture.height();
    };
    bind();
    label_object(gl, GL_FRAMEBUFFER, id(), label);
    std::array<GLenum, draw_buffers> buffers{};  // zero is GL_NONE
    GLenum read_buffer = GL_NONE;
    for (std::size_t i = 0; i < colours.size(); ++i) {
        if (colours[i] == nullptr) {
            continue;
        }
        take_size(*colours[i]);
        buffers[i] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
        attach(gl, buffers[i], *colours[i]);
        read_buffer = read_buffer == GL_NONE ? buffers[i] : read_buffer;
    }
    if (depth != nullptr) {
        take_size(*depth);
        attach(gl, GL_DEPTH_ATTACHMENT, *depth);
    }
    gl.DrawBuffers(static_cast<GLsizei>(draw_buffers), buffers.data());
    gl.ReadBuffer(read_buffer);
    if (const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER); status != GL_FRAMEBUFFER_COMPLETE) {
        throw Error(ErrorCode::gl, std::string(label),
                    "the framebuffer is incomplete: " + std::string(status_text(status)));
    }
}

Framebuffer::Framebuffer(const Functions& gl, const Texture& colour, std::string_view label)
    : Framebuffer(gl, std::array{&colour}, nullptr, label) {}

void Framebuffer::bind() const {
    handle_.gl().BindFramebuffer(GL_FRAMEBUFFER, id());
}

void Framebuffer::clear_colour(int index, const std::array<float, 4>& colour) const {
    handle_.gl().ClearBufferfv(GL_COLOR, index, colour.data());
}

void Framebuffer::clear_depth(float depth) const {
    handle_.gl().ClearBufferfv(GL_DEPTH, 0, &depth);
}

}  // namespace viscera::gl
