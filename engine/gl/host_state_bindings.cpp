#include "engine/gl/debug.h"
#include "engine/gl/host_state_values.h"

namespace viscera::gl {
namespace {

using Objects = PoisonObjects;

GLuint as_name(GLint64 value) {
    return static_cast<GLuint>(value);
}

GLint read_int(const Functions& gl, GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
}

// ---- framebuffers

/// The draw buffers and the read buffer of the framebuffers that the host has bound.
void save_draw_buffers(const Functions& gl, Values out) {
    for (GLuint i = 0; i < draw_buffers; ++i) {
        out[i] = read_int(gl, GL_DRAW_BUFFER0 + i);
    }
    out[draw_buffers] = read_int(gl, GL_READ_BUFFER);
}

/// Sets only what differs: some drivers refuse what they themselves report for a missing framebuffer 0.
void restore_draw_buffers(const Functions& gl, Saved in) {
    std::array<GLint64, draw_buffers + 1> now{};
    save_draw_buffers(gl, now);
    if (now[draw_buffers] != in[draw_buffers]) {
        gl.ReadBuffer(as_enum(in[draw_buffers]));
    }
    if (std::equal(now.begin(), now.end() - 1, in.begin())) {
        return;
    }
    if (read_int(gl, GL_DRAW_FRAMEBUFFER_BINDING) == 0) {
        gl.DrawBuffer(as_enum(in[0]));
        return;
    }
    std::array<GLenum, draw_buffers> buffers{};
    std::transform(in.begin(), in.end() - 1, buffers.begin(), as_enum);
    gl.DrawBuffers(static_cast<GLsizei>(draw_buffers), buffers.data());
}

void poison_draw_buffers(const Functions& gl, const Objects& /*objects*/) {
    gl.DrawBuffer(GL_NONE);
    gl.ReadBuffer(GL_NONE);
}

// ---- buffers

template <GLenum target, GLenum query>
constexpr HostStateRow buffer_row(std::string_view name) {
    return {name,
            1,
            false,
            always,
            [](const Functions& gl, Values out) { out[0] = read_int(gl, query); },
            [](const Functions& gl, Saved in) { gl.BindBuffer(target, as_name(in[0])); },
            [](const Functions& gl, const Objects& objects) { gl.BindBuffer(target, objects.buffer); }};
}

/// Indexed uniform buffers: name, start and size each.
void save_uniform_blocks(const Functions& gl, Values out) {
    for (GLuint i = 0; i < uniform_blocks; ++i) {
        GLint name = 0;
        gl.GetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, i, &name);
        const Values saved = part(out, i, 3);
        saved[0] = name;
        gl.GetInteger64i_v(GL_UNIFORM_BUFFER_START, i, &saved[1]);
        gl.GetInteger64i_v(GL_UNIFORM_BUFFER_SIZE, i, &saved[2]);
    }
}

void restore_uniform_blocks(const Functions& gl, Saved in) {
    for (GLuint i = 0; i < uniform_blocks; ++i) {
        const Saved row = in.subspan(3 * std::size_t{i}, 3);
        if (row[2] == 0) {
            gl.BindBufferBase(GL_UNIFORM_BUFFER, i, as_name(row[0]));
        } else {
            gl.BindBufferRange(GL_UNIFORM_BUFFER, i, as_name(row[0]), static_cast<GLintptr>(row[1]),
                               static_cast<GLsizeiptr>(row[2]));
        }
    }
}

void poison_uniform_blocks(const Functions& gl, const Objects& objects) {
    for (GLuint i = 0; i < uniform_blocks; ++i) {
        gl.BindBufferRange(GL_UNIFORM_BUFFER, i, objects.buffer, 0, 16);
    }
    gl.BindBufferBase(GL_UNIFORM_BUFFER, 1, objects.buffer);
}

// ---- textures and samplers

std::size_t target_count(const Functions& gl) {
    return has_4_0(gl) ? texture_bindings.size() : texture_bindings.size() - 1;
}

constexpr std::size_t slots_per_unit = texture_bindings.size() + 1;

void save_units(const Functions& gl, Values out) {
    const GLint active = read_int(gl, GL_ACTIVE_TEXTURE);
    for (GLuint unit = 0; unit < texture_units; ++unit) {
        const Values row = out.subspan(slots_per_unit * unit, slots_per_unit);
        gl.ActiveTexture(GL_TEXTURE0 + unit);
        for (std::size_t i = 0; i < target_count(gl); ++i) {
            row[i] = read_int(gl, texture_bindings[i].query);
        }
        row.back() = read_int(gl, GL_SAMPLER_BINDING);
    }
    gl.ActiveTexture(static_cast<GLenum>(active));
}

void restore_units(const Functions& gl, Saved in) {
    const GLint active = read_int(gl, GL_ACTIVE_TEXTURE);
    for (GLuint unit = 0; unit < texture_units; ++unit) {
        const Saved row = in.subspan(slots_per_unit * unit, slots_per_unit);
        gl.ActiveTexture(GL_TEXTURE0 + unit);
        for (std::size_t i = 0; i < target_count(gl); ++i) {
            gl.BindTexture(texture_bindings[i].target, as_name(row[i]));
        }
        gl.BindSampler(unit, as_name(row.back()));
    }
    gl.ActiveTexture(static_cast<GLenum>(active));
}

void poison_units(const Functions& gl, const Objects& objects) {
    const GLint active = read_int(gl, GL_ACTIVE_TEXTURE);
    for (GLuint unit = 0; unit < texture_units; ++unit) {
        gl.ActiveTexture(GL_TEXTURE0 + unit);
        for (std::size_t i = 0; i < target_count(gl); ++i) {
            gl.BindTexture(texture_bindings[i].target, objects.textures[i]);
        }
        gl.BindSampler(unit, objects.sampler);
    }
    gl.ActiveTexture(static_cast<GLenum>(active));
}

// ---- images

constexpr std::array<GLenum, 6> image_fields{GL_IMAGE_BINDING_NAME,    GL_IMAGE_BINDING_LEVEL,
                                             GL_IMAGE_BINDING_LAYERED, GL_IMAGE_BINDING_LAYER,
                                             GL_IMAGE_BINDING_ACCESS,  GL_IMAGE_BINDING_FORMAT};

void save_image(const Functions& gl, Values out) {
    for (std::size_t i = 0; i < image_fields.size(); ++i) {
        GLint value = 0;
        gl.GetIntegeri_v(image_fields[i], image_unit, &value);
        out[i] = value;
    }
}

void restore_image(const Functions& gl, Saved in) {
    gl.BindImageTexture(image_unit, as_name(in[0]), static_cast<GLint>(in[1]),
                        in[2] != 0 ? GL_TRUE : GL_FALSE, static_cast<GLint>(in[3]), as_enum(in[4]),
                        as_enum(in[5]));
}

// ---- pixel store

constexpr std::array<GLenum, 16> pixel_store{
    GL_PACK_SWAP_BYTES,   GL_PACK_LSB_FIRST,     GL_PACK_ROW_LENGTH,    GL_PACK_IMAGE_HEIGHT,
    GL_PACK_SKIP_ROWS,    GL_PACK_SKIP_PIXELS,   GL_PACK_SKIP_IMAGES,   GL_PACK_ALIGNMENT,
    GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT,
    GL_UNPACK_SKIP_ROWS,  GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_ALIGNMENT};

// ---- queries

constexpr std::array<GLenum, 5> query_targets{GL_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED,
                                              GL_PRIMITIVES_GENERATED,
                                              GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, GL_TIME_ELAPSED};

void save_queries(const Functions& gl, Values out) {
    for (std::size_t i = 0; i < query_targets.size(); ++i) {
        GLint query = 0;
        gl.GetQueryiv(query_targets[i], GL_CURRENT_QUERY, &query);
        out[i] = query;
    }
}

/// Ends what was not there. A query that has been ended cannot be taken up again, so the engine begins none
/// of a kind that a host may have active: it times with timestamps.
void restore_queries(const Functions& gl, Saved in) {
    std::array<GLint64, query_targets.size()> now{};
    save_queries(gl, now);
    for (std::size_t i = 0; i < query_targets.size(); ++i) {
        if (now[i] != 0 && in[i] == 0) {
            gl.EndQuery(query_targets[i]);
        }
    }
}

// ---- transform feedback

void save_feedback(const Functions& gl, Values out) {
    out[0] = read_int(gl, GL_TRANSFORM_FEEDBACK_BINDING);
    out[1] = read_int(gl, GL_TRANSFORM_FEEDBACK_BUFFER_ACTIVE);
    out[2] = read_int(gl, GL_TRANSFORM_FEEDBACK_BUFFER_PAUSED);
}

void restore_feedback(const Functions& gl, Saved in) {
    std::array<GLint64, 3> now{};
    save_feedback(gl, now);
    if (now[0] != in[0]) {
        gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, as_name(in[0]));
        save_feedback(gl, now);
    }
    if (in[1] != 0 && in[2] == 0 && now[2] != 0) {
        gl.ResumeTransformFeedback();
    }
}

// ---- debug output

/// Depth of the group stack, the two switches, callback and its user pointer.
void save_debug(const Functions& gl, Values out) {
    out[0] = read_int(gl, GL_DEBUG_GROUP_STACK_DEPTH);
    out[1] = gl.IsEnabled(GL_DEBUG_OUTPUT);
    out[2] = gl.IsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    void* pointer = nullptr;
    gl.GetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &pointer);
    out[3] = reinterpret_cast<GLint64>(pointer);
    pointer = nullptr;
    gl.GetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &pointer);
    out[4] = reinterpret_cast<GLint64>(pointer);
}

void restore_debug(const Functions& gl, Saved in) {
    for (GLint64 depth = read_int(gl, GL_DEBUG_GROUP_STACK_DEPTH); depth > in[0]; --depth) {
        gl.PopDebugGroup();
    }
    gl.DebugMessageCallback(reinterpret_cast<GLDEBUGPROC>(in[3]), reinterpret_cast<const void*>(in[4]));
    toggle(gl, GL_DEBUG_OUTPUT, in[1] != 0);
    toggle(gl, GL_DEBUG_OUTPUT_SYNCHRONOUS, in[2] != 0);
}

void GLAD_API_PTR ignore_message(GLenum /*source*/, GLenum /*type*/, GLuint /*id*/, GLenum /*severity*/,
                                 GLsizei /*length*/, const GLchar* /*text*/, const void* /*user*/) {}

void poison_debug(const Functions& gl, const Objects& objects) {
    gl.DebugMessageCallback(ignore_message, &objects);
    toggle(gl, GL_DEBUG_OUTPUT, gl.IsEnabled(GL_DEBUG_OUTPUT) == GL_FALSE);
    toggle(gl, GL_DEBUG_OUTPUT_SYNCHRONOUS, gl.IsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS) == GL_FALSE);
    gl.PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 1, -1, "poison");
}

// ---- hints

constexpr std::array<GLenum, 4> hints{GL_LINE_SMOOTH_HINT, GL_POLYGON_SMOOTH_HINT,
                                      GL_TEXTURE_COMPRESSION_HINT, GL_FRAGMENT_SHADER_DERIVATIVE_HINT};

// Framebuffers before their draw buffers; the vertex array before nothing else (its index buffer is its own);
// the program before feedback, which can only go on with the program that it began with.
constexpr std::array bindings{
    HostStateRow{"framebuffers", 2, false, always,
                 [](const Functions& gl, Values out) {
                     out[0] = read_int(gl, GL_DRAW_FRAMEBUFFER_BINDING);
                     out[1] = read_int(gl, GL_READ_FRAMEBUFFER_BINDING);
                 },
                 [](const Functions& gl, Saved in) {
                     gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, as_name(in[0]));
                     gl.BindFramebuffer(GL_READ_FRAMEBUFFER, as_name(in[1]));
                 },
                 [](const Functions& gl, const Objects& objects) {
                     gl.BindFramebuffer(GL_FRAMEBUFFER, objects.framebuffer);
                 }},
    HostStateRow{"draw and read buffers", draw_buffers + 1, false, always, save_draw_buffers,
                 restore_draw_buffers, poison_draw_buffers},
    HostStateRow{"renderbuffer", 1, false, always,
                 [](const Functions& gl, Values out) { out[0] = read_int(gl, GL_RENDERBUFFER_BINDING); },
                 [](const Functions& gl, Saved in) { gl.BindRenderbuffer(GL_RENDERBUFFER, as_name(in[0])); },
                 [](const Functions& gl, const Objects& objects) {
                     gl.BindRenderbuffer(GL_RENDERBUFFER, objects.renderbuffer);
                 }},
    HostStateRow{"program", 1, false, always,
                 [](const Functions& gl, Values out) { out[0] = read_int(gl, GL_CURRENT_PROGRAM); },
                 [](const Functions& gl, Saved in) { gl.UseProgram(as_name(in[0])); },
                 [](const Functions& gl, const Objects& objects) { gl.UseProgram(objects.program); }},
    HostStateRow{
        "vertex array", 1, false, always,
        [](const Functions& gl, Values out) { out[0] = read_int(gl, GL_VERTEX_ARRAY_BINDING); },
        [](const Functions& gl, Saved in) { gl.BindVertexArray(as_name(in[0])); },
        [](const Functions& gl, const Objects& objects) { gl.BindVertexArray(objects.vertex_array); }},
    buffer_row<GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING>("array buffer"),
    buffer_row<GL_COPY_READ_BUFFER, GL_COPY_READ_BUFFER_BINDING>("copy read buffer"),
    buffer_row<GL_COPY_WRITE_BUFFER, GL_COPY_WRITE_BUFFER_BINDING>("copy write buffer"),
    buffer_row<GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING>("pixel pack buffer"),
    buffer_row<GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING>("pixel unpack buffer"),
    // The query has the target's own name.
    buffer_row<GL_TEXTURE_BUFFER, GL_TEXTURE_BUFFER>("texture buffer"),
    HostStateRow{"uniform blocks", std::size_t{3} * uniform_blocks, false, always, save_uniform_blocks,
                 restore_uniform_blocks, poison_uniform_blocks},
    // After the indexed ones, whose restoring changes it.
    buffer_row<GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING>("uniform buffer"),
    HostStateRow{"texture units", slots_per_unit* texture_units, false, always, save_units, restore_units,
                 poison_units},
    HostStateRow{"image unit", image_fields.size(), false, has_4_3, save_image, restore_image,
                 [](const Functions& gl, const Objects& objects) {
                     gl.BindImageTexture(image_unit, objects.textures[2], 0, GL_TRUE, 0, GL_READ_WRITE,
                                         GL_R32F);
                 }},
    HostStateRow{"active texture", 1, false, always,
                 [](const Functions& gl, Values out) { out[0] = read_int(gl, GL_ACTIVE_TEXTURE); },
                 [](const Functions& gl, Saved in) { gl.ActiveTexture(as_enum(in[0])); },
                 [](const Functions& gl, const Objects&) { gl.ActiveTexture(GL_TEXTURE0 + 7); }},
    HostStateRow{"pixel store", pixel_store.size(), false, always,
                 [](const Functions& gl, Values out) {
                     std::ranges::transform(pixel_store, out.begin(),
                                            [&](GLenum name) { return read_int(gl, name); });
                 },
                 [](const Functions& gl, Saved in) {
                     for (std::size_t i = 0; i < pixel_store.size(); ++i) {
                         gl.PixelStorei(pixel_store[i], static_cast<GLint>(in[i]));
                     }
                 },
                 [](const Functions& gl, const Objects&) {
                     for (const GLenum name : pixel_store) {
                         const bool alignment = name == GL_PACK_ALIGNMENT || name == GL_UNPACK_ALIGNMENT;
                         gl.PixelStorei(name, alignment ? 8 : 1);
                     }
                 }},
    HostStateRow{"read colour clamp", 1, false, always,
                 [](const Functions& gl, Values out) { out[0] = read_int(gl, GL_CLAMP_READ_COLOR); },
                 [](const Functions& gl, Saved in) { gl.ClampColor(GL_CLAMP_READ_COLOR, as_enum(in[0])); },
                 [](const Functions& gl, const Objects&) { gl.ClampColor(GL_CLAMP_READ_COLOR, GL_TRUE); }},
    HostStateRow{"hints", hints.size(), false, always,
                 [](const Functions& gl, Values out) {
                     std::ranges::transform(hints, out.begin(),
                                            [&](GLenum name) { return read_int(gl, name); });
                 },
                 [](const Functions& gl, Saved in) {
                     for (std::size_t i = 0; i < hints.size(); ++i) {
                         gl.Hint(hints[i], as_enum(in[i]));
                     }
                 },
                 [](const Functions& gl, const Objects&) {
                     for (const GLenum name : hints) {
                         gl.Hint(name, GL_NICEST);
                     }
                 }},
    HostStateRow{
        "queries", query_targets.size(), false, always, save_queries, restore_queries,
        [](const Functions& gl, const Objects& objects) { gl.BeginQuery(GL_SAMPLES_PASSED, objects.query); }},
    HostStateRow{"transform feedback", 3, false, has_4_0, save_feedback, restore_feedback,
                 [](const Functions& gl, const Objects& objects) {
                     gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, objects.feedback);
                 }},
    HostStateRow{"debug output", 5, false, has_debug, save_debug, restore_debug, poison_debug},
};

}  // namespace

std::span<const HostStateRow> binding_rows() {
    return bindings;
}

}  // namespace viscera::gl
