#include "engine/gl/timer.h"

namespace viscera::gl {
namespace {

QueryHandle make_query(const Functions& gl) {
    GLuint id = 0;
    gl.GenQueries(1, &id);
    return QueryHandle::own(gl, id);
}

GLuint64 result(const Functions& gl, const QueryHandle& query) {
    GLuint64 nanoseconds = 0;
    gl.GetQueryObjectui64v(query.id(), GL_QUERY_RESULT, &nanoseconds);
    return nanoseconds;
}

}  // namespace

GpuTimer::GpuTimer(const Functions& gl) : gl_(&gl) {
    for (Slot& slot : slots_) {
        slot = {make_query(gl), make_query(gl)};
    }
}

void GpuTimer::begin() {
    running_ = count_ < ring_size;
    if (running_) {
        gl_->QueryCounter(slots_[(first_ + count_) % ring_size].begin.id(), GL_TIMESTAMP);
    }
}

void GpuTimer::end() {
    if (!running_) {
        return;
    }
    gl_->QueryCounter(slots_[(first_ + count_) % ring_size].end.id(), GL_TIMESTAMP);
    running_ = false;
    ++count_;
}

std::optional<double> GpuTimer::latest_ms() {
    while (count_ > 0) {
        const Slot& slot = slots_[first_];
        GLint available = GL_FALSE;
        gl_->GetQueryObjectiv(slot.end.id(), GL_QUERY_RESULT_AVAILABLE, &available);
        if (available == GL_FALSE) {
            break;
        }
        first_ = (first_ + 1) % ring_size;
        --count_;
        const GLuint64 begin = result(*gl_, slot.begin);
        const GLuint64 end = result(*gl_, slot.end);
        latest_ms_ = end > begin ? static_cast<double>(end - begin) * 1e-6 : 0.0;
    }
    return latest_ms_;
}

}  // namespace viscera::gl
