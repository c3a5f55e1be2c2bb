#include "engine/gl/program.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

#include <glm/gtc/type_ptr.hpp>

#include "engine/core/error.h"
#include "engine/gl/debug.h"
#include "engine/gl/mesh.h"

namespace viscera::gl {
namespace {

struct AttributeName {
    Attribute attribute;
    const char* name;
};
constexpr std::array<AttributeName, 5> attribute_names{{{Attribute::position, "a_position"},
                                                        {Attribute::normal, "a_normal"},
                                                        {Attribute::uv, "a_uv"},
                                                        {Attribute::scalar, "a_scalar"},
                                                        {Attribute::picture_uv, "a_picture_uv"}}};

// Of the textures that a Texture can be; any other sampler could never be bound.
constexpr std::array<GLenum, 9> sampler_types{GL_SAMPLER_2D,
                                              GL_SAMPLER_BUFFER,
                                              GL_SAMPLER_3D,
                                              GL_SAMPLER_2D_ARRAY,
                                              GL_INT_SAMPLER_2D,
                                              GL_INT_SAMPLER_3D,
                                              GL_UNSIGNED_INT_SAMPLER_2D,
                                              GL_UNSIGNED_INT_SAMPLER_3D,
                                              GL_UNSIGNED_INT_SAMPLER_2D_ARRAY};

/// Which have their unit from the shader.
bool is_image(GLenum type) {
    return type >= GL_IMAGE_1D && type <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY;
}

bool is_sampler(GLenum type) {
    return std::ranges::find(sampler_types, type) != sampler_types.end();
}

bool takes(GLenum type, const int* /*value*/) {
    return type == GL_INT || type == GL_BOOL;
}
bool takes(GLenum type, const unsigned* /*value*/) {
    return type == GL_UNSIGNED_INT || type == GL_BOOL;
}
bool takes(GLenum type, const float* /*value*/) {
    return type == GL_FLOAT;
}
bool takes(GLenum type, const glm::vec2* /*value*/) {
    return type == GL_FLOAT_VEC2;
}
bool takes(GLenum type, const glm::vec3* /*value*/) {
    return type == GL_FLOAT_VEC3;
}
bool takes(GLenum type, const glm::vec4* /*value*/) {
    return type == GL_FLOAT_VEC4;
}
bool takes(GLenum type, const glm::ivec2* /*value*/) {
    return type == GL_INT_VEC2 || type == GL_BOOL_VEC2;
}
bool takes(GLenum type, const glm::ivec3* /*value*/) {
    return type == GL_INT_VEC3 || type == GL_BOOL_VEC3;
}
bool takes(GLenum type, const glm::ivec4* /*value*/) {
    return type == GL_INT_VEC4 || type == GL_BOOL_VEC4;
}
bool takes(GLenum type, const glm::mat3* /*value*/) {
    return type == GL_FLOAT_MAT3;
}
bool takes(GLenum type, const glm::mat4* /*value*/) {
    return type == GL_FLOAT_MAT4;
}

void send(const Functions& gl, GLint location, GLsizei n, const int* v) {
    gl.Uniform1iv(location, n, v);
}
void send(const Functions& gl, GLint location, GLsizei n, const unsigned* v) {
    gl.Uniform1uiv(location, n, v);
}
void send(const Functions& gl, GLint location, GLsizei n, const float* v) {
    gl.Uniform1fv(location, n, v);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::vec2* v) {
    gl.Uniform2fv(location, n, &v->x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::vec3* v) {
    gl.Uniform3fv(location, n, &v->x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::vec4* v) {
    gl.Uniform4fv(location, n, &v->x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::ivec2* v) {
    gl.Uniform2iv(location, n, &v->x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::ivec3* v) {
    gl.Uniform3iv(location, n, &v->x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::ivec4* v) {
    gl.Uniform4iv(location, n, &v->x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::mat3* v) {
    gl.UniformMatrix3fv(location, n, GL_FALSE, &(*v)[0].x);
}
void send(const Functions& gl, GLint location, GLsizei n, const glm::mat4* v) {
    gl.UniformMatrix4fv(location, n, GL_FALSE, &(*v)[0].x);
}

std::string shader_log(const Functions& gl, GLuint shader) {
    GLint length = 0;
    gl.GetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    gl.GetShaderInfoLog(shader, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    return log;
}

std::string program_log(const Functions& gl, GLuint program) {
    GLint length = 0;
    gl.GetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    gl.GetProgramInfoLog(program, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    return log;
}

/// Compiles one stage; what the driver remarked is added to `warnings`.
ShaderHandle compile_stage(const Functions& gl, GLenum stage, const ShaderSource& source,
                           std::string_view label, std::string& warnings) {
    ShaderHandle shader = ShaderHandle::own(gl, gl.CreateShader(stage));
    const char* text = source.text.data();
    const auto length = static_cast<GLint>(source.text.size());
    gl.ShaderSource(shader.id(), 1, &text, &length);
    gl.CompileShader(shader.id());
    GLint compiled = GL_FALSE;
    gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
    const std::string log = map_shader_log(shader_log(gl, shader.id()), source);
    if (compiled == GL_FALSE) {
        throw Error(ErrorCode::gl, std::string(label), "does not compile:\n" + log);
    }
    warnings += log;
    return shader;
}

}  // namespace

Program::Program(const Functions& gl, std::string_view label)
    : handle_(ProgramHandle::own(gl, gl.CreateProgram())), label_(label) {}

Program::Program(const Functions& gl, const ShaderSource& vertex, const ShaderSource& fragment,
                 std::string_view label, std::span<const std::string> feedback)
    : Program(gl, label) {
    const ShaderHandle vertex_shader = compile_stage(gl, GL_VERTEX_SHADER, vertex, label, warnings_);
    std::optional<ShaderHandle> fragment_shader;
    gl.AttachShader(id(), vertex_shader.id());
    if (!fragment.text.empty()) {
        fragment_shader = compile_stage(gl, GL_FRAGMENT_SHADER, fragment, label, warnings_);
        gl.AttachShader(id(), fragment_shader->id());
    }
    for (const AttributeName& entry : attribute_names) {
        gl.BindAttribLocation(id(), static_cast<GLuint>(entry.attribute), entry.name);
    }
    if (!feedback.empty()) {
        std::vector<const char*> names;
        for (const std::string& name : feedback) {
            names.push_back(name.c_str());
        }
        gl.TransformFeedbackVaryings(id(), static_cast<GLsizei>(names.size()), names.data(),
                                     GL_INTERLEAVED_ATTRIBS);
    }
    link();
    // The program keeps its code; the shaders need not stay.
    gl.DetachShader(id(), vertex_shader.id());
    if (fragment_shader) {
        gl.DetachShader(id(), fragment_shader->id());
    }
}

Program Program::make_compute(const Functions& gl, const ShaderSource& compute, std::string_view label) {
    Program program(gl, label);
    const ShaderHandle shader = compile_stage(gl, GL_COMPUTE_SHADER, compute, label, program.warnings_);
    gl.AttachShader(program.id(), shader.id());
    program.link();
    gl.DetachShader(program.id(), shader.id());
    gl.GetProgramiv(program.id(), GL_COMPUTE_WORK_GROUP_SIZE, glm::value_ptr(program.group_size_));
    return program;
}

void Program::link() {
    const Functions& gl = handle_.gl();
    gl.LinkProgram(id());
    GLint linked = GL_FALSE;
    gl.GetProgramiv(id(), GL_LINK_STATUS, &linked);
    const std::string log = program_log(gl, id());
    if (linked == GL_FALSE) {
        throw Error(ErrorCode::gl, label_, "does not link:\n" + log);
    }
    warnings_ += log;
    label_object(gl, GL_PROGRAM, id(), label_);
    reflect();
    assign_units();
}

void Program::reflect() {
    const Functions& gl = handle_.gl();
    GLint count = 0;
    GLint longest = 0;
    gl.GetProgramiv(id(), GL_ACTIVE_UNIFORMS, &count);
    gl.GetProgramiv(id(), GL_ACTIVE_UNIFORM_MAX_LENGTH, &longest);
    std::string buffer(static_cast<std::size_t>(std::max(longest, 1)), '\0');
    for (GLint i = 0; i < count; ++i) {
        Uniform uniform;
        GLsizei length = 0;
        gl.GetActiveUniform(id(), static_cast<GLuint>(i), longest, &length, &uniform.size, &uniform.type,
                            buffer.data());
        uniform.name.assign(buffer.data(), static_cast<std::size_t>(length));
        uniform.location = gl.GetUniformLocation(id(), uniform.name.c_str());
        if (uniform.location < 0) {
            continue;  // in a block
        }
        if (uniform.name.ends_with("[0]")) {
            uniform.name.resize(uniform.name.size() - 3);
        }
        uniforms_.push_back(std::move(uniform));
    }
    std::ranges::sort(uniforms_, {}, &Uniform::name);
}

void Program::assign_units() {
    const Functions& gl = handle_.gl();
    gl.UseProgram(id());
    GLuint next = 0;
    for (Uniform& uniform : uniforms_) {
        if (!is_sampler(uniform.type)) {
            continue;
        }
        uniform.unit = next;
        next += static_cast<GLuint>(uniform.size);
        if (next > editing_unit) {
            throw Error(ErrorCode::limit, label_,
                        "samples more than " + std::to_string(editing_unit) + " textures");
        }
        std::array<GLint, editing_unit> units{};
        for (std::size_t i = 0; i < static_cast<std::size_t>(uniform.size); ++i) {
            units[i] = static_cast<GLint>(uniform.unit + i);
        }
        gl.Uniform1iv(uniform.location, uniform.size, units.data());
    }
}

void Program::use() const {
    handle_.gl().UseProgram(id());
    for (const Uniform& uniform : uniforms_) {
        uniform.waits = !is_image(uniform.type);
    }
}

std::string_view Program::unset() const {
    const auto found = std::ranges::find_if(uniforms_, &Uniform::waits);
    return found != uniforms_.end() ? std::string_view(found->name) : std::string_view();
}

const Program::Uniform* Program::find(std::string_view name) const {
    const auto found = std::ranges::lower_bound(
        uniforms_, name, {}, [](const Uniform& uniform) { return std::string_view(uniform.name); });
    return found != uniforms_.end() && found->name == name ? &*found : nullptr;
}

template <class T>
void Program::set_array(std::string_view name, std::span<const T> values) const {
    const Uniform* uniform = find(name);
    if (uniform == nullptr) {
        return;
    }
    uniform->waits = false;
    if (values.empty()) {
        return;
    }
    if (!takes(uniform->type, values.data())) {
        throw Error(ErrorCode::gl, label_,
                    "uniform '" + std::string(name) + "' has another type than the value given");
    }
    const auto size = static_cast<std::size_t>(uniform->size);
    send(handle_.gl(), uniform->location, static_cast<GLsizei>(std::min(values.size(), size)), values.data());
}

void Program::set(std::string_view name, std::span<const int> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const unsigned> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const float> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::vec2> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::vec3> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::vec4> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::ivec2> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::ivec3> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::ivec4> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::mat3> v) const {
    set_array(name, v);
}
void Program::set(std::string_view name, std::span<const glm::mat4> v) const {
    set_array(name, v);
}

void Program::bind(std::string_view name, const Texture& texture, const Sampler& sampler) const {
    const Uniform* uniform = find(name);
    if (uniform == nullptr) {
        return;
    }
    if (!is_sampler(uniform->type)) {
        throw Error(ErrorCode::gl, label_, "uniform '" + std::string(name) + "' is no sampler");
    }
    uniform->waits = false;
    texture.bind(uniform->unit);
    sampler.bind(uniform->unit);
}

}  // namespace viscera::gl
