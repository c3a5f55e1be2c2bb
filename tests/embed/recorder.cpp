#include "tests/embed/recorder.h"

#include <string_view>
#include <utility>

namespace viscera::test {
namespace {

constexpr std::array<std::string_view, 7> kind_names{"Textures", "Buffers",      "Framebuffers", "Samplers",
                                                     "Queries",  "VertexArrays", "Renderbuffers"};

thread_local Recorder* current = nullptr;

}  // namespace

struct Recorder::Wrapped {
    template <class Function>
    static Function real(const std::string& name) {
        return reinterpret_cast<Function>(current->real_(name.c_str()));
    }

    template <std::size_t kind>
    static void GLAD_API_PTR gen(GLsizei count, GLuint* names) {
        real<void(GLAD_API_PTR*)(GLsizei, GLuint*)>("glGen" + std::string(kind_names[kind]))(count, names);
        current->alive_[kind].insert(names, names + count);
        current->made_ += static_cast<std::size_t>(count);
    }
    template <std::size_t kind>
    static void GLAD_API_PTR remove(GLsizei count, const GLuint* names) {
        real<void(GLAD_API_PTR*)(GLsizei, const GLuint*)>("glDelete" + std::string(kind_names[kind]))(count,
                                                                                                      names);
        for (GLsizei i = 0; i < count; ++i) {
            current->alive_[kind].erase(names[i]);
        }
    }
    static GLuint GLAD_API_PTR create_shader(GLenum stage) {
        const GLuint shader = real<PFNGLCREATESHADERPROC>("glCreateShader")(stage);
        current->shaders_.insert(shader);
        ++current->made_;
        return shader;
    }
    static void GLAD_API_PTR delete_shader(GLuint shader) {
        real<PFNGLDELETESHADERPROC>("glDeleteShader")(shader);
        current->shaders_.erase(shader);
    }
    static GLuint GLAD_API_PTR create_program() {
        const GLuint program = real<PFNGLCREATEPROGRAMPROC>("glCreateProgram")();
        current->programs_.insert(program);
        ++current->made_;
        return program;
    }
    static void GLAD_API_PTR delete_program(GLuint program) {
        real<PFNGLDELETEPROGRAMPROC>("glDeleteProgram")(program);
        current->programs_.erase(program);
    }
    static GLsync GLAD_API_PTR fence(GLenum condition, GLbitfield flags) {
        const GLsync sync = real<PFNGLFENCESYNCPROC>("glFenceSync")(condition, flags);
        current->syncs_.insert(sync);
        ++current->made_;
        return sync;
    }
    static void GLAD_API_PTR delete_sync(GLsync sync) {
        real<PFNGLDELETESYNCPROC>("glDeleteSync")(sync);
        current->syncs_.erase(sync);
    }
    static GLenum GLAD_API_PTR wait_sync(GLsync sync, GLbitfield flags, GLuint64 timeout_ns) {
        current->waits_ += timeout_ns > 0 ? 1 : 0;
        return current->fences_held_ && timeout_ns == 0
                   ? GL_TIMEOUT_EXPIRED
                   : real<PFNGLCLIENTWAITSYNCPROC>("glClientWaitSync")(sync, flags, timeout_ns);
    }
    static void GLAD_API_PTR finish() {
        ++current->waits_;
        real<PFNGLFINISHPROC>("glFinish")();
    }
    /// With a buffer bound `pixels` is an offset, and nobody waits.
    static void GLAD_API_PTR read_pixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format,
                                         GLenum type, void* pixels) {
        GLint buffer = 0;
        real<PFNGLGETINTEGERVPROC>("glGetIntegerv")(GL_PIXEL_PACK_BUFFER_BINDING, &buffer);
        current->waits_ += buffer == 0 ? 1 : 0;
        real<PFNGLREADPIXELSPROC>("glReadPixels")(x, y, width, height, format, type, pixels);
    }
    static void* GLAD_API_PTR map(GLenum target, GLintptr offset, GLsizeiptr bytes, GLbitfield access) {
        current->waits_ += (access & GL_MAP_READ_BIT) != 0 ? 1 : 0;
        return real<PFNGLMAPBUFFERRANGEPROC>("glMapBufferRange")(target, offset, bytes, access);
    }
    static GLboolean GLAD_API_PTR unmap(GLenum target) {
        const GLboolean kept = real<PFNGLUNMAPBUFFERPROC>("glUnmapBuffer")(target);
        return std::exchange(current->mapping_lost_, false) ? GLboolean{GL_FALSE} : kept;
    }
    static GLuint texture(GLuint name) {
        return name != 0 && name == current->renamed_.first ? current->renamed_.second : name;
    }
    static void GLAD_API_PTR bind_texture(GLenum target, GLuint name) {
        real<PFNGLBINDTEXTUREPROC>("glBindTexture")(target, texture(name));
    }
    static GLboolean GLAD_API_PTR is_texture(GLuint name) {
        return real<PFNGLISTEXTUREPROC>("glIsTexture")(texture(name));
    }
    static void GLAD_API_PTR attach(GLenum target, GLenum point, GLenum kind, GLuint name, GLint level) {
        real<PFNGLFRAMEBUFFERTEXTURE2DPROC>("glFramebufferTexture2D")(target, point, kind, texture(name),
                                                                      level);
    }
    static void GLAD_API_PTR bind_framebuffer(GLenum target, GLuint framebuffer) {
        real<PFNGLBINDFRAMEBUFFERPROC>("glBindFramebuffer")(target, framebuffer);
        current->default_framebuffer_binds_ += framebuffer == 0 ? 1 : 0;
    }

    template <class Function>
    static void* pointer(Function function) {
        return reinterpret_cast<void*>(function);
    }

    template <std::size_t... kind>
    static void* of_kind(std::string_view name, std::index_sequence<kind...>) {
        void* found = nullptr;
        const auto match = [&]<std::size_t k>() {
            if (name == "glGen" + std::string(kind_names[k])) {
                found = pointer(&gen<k>);
            } else if (name == "glDelete" + std::string(kind_names[k])) {
                found = pointer(&remove<k>);
            }
        };
        (match.template operator()<kind>(), ...);
        return found;
    }

    static void* proc(const char* name) {
        static const std::map<std::string_view, void*> singles{
            {"glCreateShader", pointer(&create_shader)},
            {"glDeleteShader", pointer(&delete_shader)},
            {"glCreateProgram", pointer(&create_program)},
            {"glDeleteProgram", pointer(&delete_program)},
            {"glFenceSync", pointer(&fence)},
            {"glDeleteSync", pointer(&delete_sync)},
            {"glClientWaitSync", pointer(&wait_sync)},
            {"glFinish", pointer(&finish)},
            {"glReadPixels", pointer(&read_pixels)},
            {"glMapBufferRange", pointer(&map)},
            {"glUnmapBuffer", pointer(&unmap)},
            {"glBindTexture", pointer(&bind_texture)},
            {"glIsTexture", pointer(&is_texture)},
            {"glFramebufferTexture2D", pointer(&attach)},
            {"glBindFramebuffer", pointer(&bind_framebuffer)}};
        if (const auto single = singles.find(name); single != singles.end()) {
            return single->second;
        }
        void* const wrapped = of_kind(name, std::make_index_sequence<kinds>());
        return wrapped != nullptr ? wrapped : current->real_(name);
    }
};

Recorder::Recorder(ProcAddress real) : real_(real) {
    current = this;
}

Recorder::~Recorder() {
    current = nullptr;
}

ProcAddress Recorder::proc() const {
    return &Wrapped::proc;
}

void Recorder::forget_texture(GLuint texture) {
    alive_[0].erase(texture);
}

std::map<std::string, std::size_t> Recorder::alive() const {
    std::map<std::string, std::size_t> counts;
    const auto count = [&](std::string_view kind, std::size_t number) {
        if (number > 0) {
            counts.emplace(kind, number);
        }
    };
    for (std::size_t i = 0; i < kinds; ++i) {
        count(kind_names[i], alive_[i].size());
    }
    count("Shaders", shaders_.size());
    count("Programs", programs_.size());
    count("Syncs", syncs_.size());
    return counts;
}

}  // namespace viscera::test
