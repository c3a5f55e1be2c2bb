#include "engine/gl/sampler.h"

namespace viscera::gl {
namespace {

GLint to_gl(Wrap wrap) {
    switch (wrap) {
        case Wrap::clamp:
            return GL_CLAMP_TO_EDGE;
        case Wrap::repeat:
            return GL_REPEAT;
        case Wrap::border:
            return GL_CLAMP_TO_BORDER;
    }
    return GL_CLAMP_TO_EDGE;
}

SamplerHandle make_sampler(const Functions& gl) {
    GLuint id = 0;
    gl.GenSamplers(1, &id);
    return SamplerHandle::own(gl, id);
}

}  // namespace

Sampler::Sampler(const Functions& gl, const SamplerDesc& desc) : handle_(make_sampler(gl)) {
    const GLint filter = desc.filter == Filter::nearest ? GL_NEAREST : GL_LINEAR;
    gl.SamplerParameteri(id(), GL_TEXTURE_MIN_FILTER,
                         desc.filter == Filter::trilinear ? GL_LINEAR_MIPMAP_LINEAR : filter);
    gl.SamplerParameteri(id(), GL_TEXTURE_MAG_FILTER, filter);
    for (const GLenum direction : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
        gl.SamplerParameteri(id(), direction, to_gl(desc.wrap));
    }
    gl.SamplerParameterfv(id(), GL_TEXTURE_BORDER_COLOR, desc.border.data());
}

}  // namespace viscera::gl
