#include "engine/gl/host_state.h"

#include <string>

#include "engine/gl/handle.h"

namespace viscera::gl {

HostState::HostState(const Functions& gl) : gl_(&gl) {
    std::size_t offset = 0;
    for (const auto rows : {fixed_state_rows(), indexed_state_rows(), binding_rows()}) {
        for (const HostStateRow& row : rows) {
            if (row.available(gl)) {
                entries_.push_back({&row, offset});
                offset += row.slots;
            }
        }
    }
    values_.resize(offset);
}

void HostState::save(Log& log) {
    // Bounded: a lost context reports errors for ever.
    constexpr int most = 32;
    for (int i = 0; i < most; ++i) {
        const GLenum error = gl_->GetError();
        if (error == GL_NO_ERROR) {
            break;
        }
        ++host_errors_;
        log.fault("gl.host_error",
                  std::string("the host left an OpenGL error pending: ") + error_name(error));
    }
    for (const Entry& entry : entries_) {
        entry.row->save(*gl_, std::span(values_).subspan(entry.offset, entry.row->slots));
    }
    // While feedback runs, no other program may be used.
    if (gl_->VERSION_4_0 != 0) {
        GLboolean active = GL_FALSE;
        GLboolean paused = GL_FALSE;
        gl_->GetBooleanv(GL_TRANSFORM_FEEDBACK_BUFFER_ACTIVE, &active);
        gl_->GetBooleanv(GL_TRANSFORM_FEEDBACK_BUFFER_PAUSED, &paused);
        if (active == GL_TRUE && paused == GL_FALSE) {
            gl_->PauseTransformFeedback();
        }
    }
}

void HostState::restore() const {
    for (const Entry& entry : entries_) {
        entry.row->restore(*gl_, values(entry));
    }
}

}  // namespace viscera::gl
