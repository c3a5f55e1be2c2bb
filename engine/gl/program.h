#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/shader_source.h"
#include "engine/gl/sampler.h"
#include "engine/gl/texture.h"

namespace viscera::gl {

/// A linked shader program. Vertex inputs named a_position, a_normal, a_uv, a_scalar and
/// a_picture_uv have the locations that Mesh fills; each sampler has a texture unit of its own, given at link
/// time.
///
/// The setters act on the program in use: call use() first. Nothing is allocated. A name that no shader uses
/// is ignored, because compilers drop unused uniforms; a type that does not fit is an Error(gl).
class Program {
  public:
    /// Throws Error(gl) with the driver's log, in which lines of the expanded text have become "file:line";
    /// Error(limit) when it needs more textures than there are units. An empty fragment source makes a
    /// program for transform feedback, which writes `feedback` interleaved.
    Program(const Functions& gl, const ShaderSource& vertex, const ShaderSource& fragment,
            std::string_view label, std::span<const std::string> feedback = {});
    /// A compute program; throws as the constructor does. Only where Capabilities::compute says so.
    [[nodiscard]] static Program make_compute(const Functions& gl, const ShaderSource& compute,
                                              std::string_view label);

    [[nodiscard]] GLuint id() const { return handle_.id(); }
    [[nodiscard]] const std::string& label() const { return label_; }
    /// Invocations of a group of a compute program; 0 for others.
    [[nodiscard]] glm::ivec3 group_size() const { return group_size_; }
    /// What the driver remarked although it compiled; often empty.
    [[nodiscard]] const std::string& warnings() const { return warnings_; }

    /// From here on every uniform waits to be set.
    void use() const;

    struct Uniform {
        std::string name;  ///< arrays without "[0]"
        GLint location = -1;
        GLenum type = GL_FLOAT;
        GLint size = 1;   ///< elements of an array
        GLuint unit = 0;  ///< samplers only
        mutable bool waits = false;
    };
    /// The first active uniform that still waits, or empty: it holds 0, or what another pass has left there.
    [[nodiscard]] std::string_view unset() const;
    /// Active uniforms outside blocks, sorted by name.
    [[nodiscard]] std::span<const Uniform> uniforms() const { return uniforms_; }

    void set(std::string_view name, bool value) const { set(name, static_cast<int>(value)); }
    void set(std::string_view name, int value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, unsigned value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, float value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::vec2& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::vec3& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::vec4& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::ivec2& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::ivec3& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::ivec4& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::mat3& value) const { set(name, std::span(&value, 1)); }
    void set(std::string_view name, const glm::mat4& value) const { set(name, std::span(&value, 1)); }
    /// Arrays, from element 0; elements beyond the shader's array are dropped.
    void set(std::string_view name, std::span<const int> values) const;
    void set(std::string_view name, std::span<const unsigned> values) const;
    void set(std::string_view name, std::span<const float> values) const;
    void set(std::string_view name, std::span<const glm::vec2> values) const;
    void set(std::string_view name, std::span<const glm::vec3> values) const;
    void set(std::string_view name, std::span<const glm::vec4> values) const;
    void set(std::string_view name, std::span<const glm::ivec2> values) const;
    void set(std::string_view name, std::span<const glm::ivec3> values) const;
    void set(std::string_view name, std::span<const glm::ivec4> values) const;
    void set(std::string_view name, std::span<const glm::mat3> values) const;
    void set(std::string_view name, std::span<const glm::mat4> values) const;
    /// For double precision, convert first: what is lost must be visible.
    void set(std::string_view name, double value) const = delete;

    /// Binds texture and sampler to the unit of the sampler uniform `name`; ignored where no shader uses it.
    void bind(std::string_view name, const Texture& texture, const Sampler& sampler) const;

  private:
    Program(const Functions& gl, std::string_view label);
    void link();
    void reflect();
    void assign_units();
    [[nodiscard]] const Uniform* find(std::string_view name) const;
    template <class T>
    void set_array(std::string_view name, std::span<const T> values) const;

    ProgramHandle handle_;
    std::string label_;
    std::string warnings_;
    glm::ivec3 group_size_{0};
    std::vector<Uniform> uniforms_;
};

}  // namespace viscera::gl
