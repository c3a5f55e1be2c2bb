#include "engine/gl/host_state_values.h"

// State that there is once per viewport or per draw buffer where the context is new enough.
namespace viscera::gl {
namespace {

using Objects = PoisonObjects;

// ---- viewports: from 4.1 on there are several, and the plain calls set all of them

constexpr GLuint viewports = 16;

bool has_viewports(const Functions& gl) {
    return gl.VERSION_4_1 != 0;
}

void save_viewport(const Functions& gl, Values out) {
    if (!has_viewports(gl)) {
        read_floats(gl, GL_VIEWPORT, out.first(4));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        std::array<GLfloat, 4> box{};
        gl.GetFloati_v(GL_VIEWPORT, i, box.data());
        std::ranges::transform(box, part(out, i, 4).begin(), [](GLfloat value) {
            return static_cast<GLint64>(std::bit_cast<GLint>(value));
        });
    }
}

void restore_viewport(const Functions& gl, Saved in) {
    if (!has_viewports(gl)) {
        gl.Viewport(static_cast<GLint>(as_float(in[0])), static_cast<GLint>(as_float(in[1])),
                    static_cast<GLsizei>(as_float(in[2])), static_cast<GLsizei>(as_float(in[3])));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        const Saved box = part(in, i, 4);
        gl.ViewportIndexedf(i, as_float(box[0]), as_float(box[1]), as_float(box[2]), as_float(box[3]));
    }
}

void save_depth_range(const Functions& gl, Values out) {
    for (GLuint i = 0; i < (has_viewports(gl) ? viewports : 1); ++i) {
        std::array<GLdouble, 2> range{};
        if (has_viewports(gl)) {
            gl.GetDoublei_v(GL_DEPTH_RANGE, i, range.data());
        } else {
            gl.GetDoublev(GL_DEPTH_RANGE, range.data());
        }
        const Values saved = part(out, i, 2);
        saved[0] = std::bit_cast<GLint64>(range[0]);
        saved[1] = std::bit_cast<GLint64>(range[1]);
    }
}

void restore_depth_range(const Functions& gl, Saved in) {
    if (!has_viewports(gl)) {
        gl.DepthRange(as_double(in[0]), as_double(in[1]));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        const Saved range = part(in, i, 2);
        gl.DepthRangeIndexed(i, as_double(range[0]), as_double(range[1]));
    }
}

/// Five values each: on, and the box.
void save_scissor(const Functions& gl, Values out) {
    if (!has_viewports(gl)) {
        out[0] = gl.IsEnabled(GL_SCISSOR_TEST);
        read_ints(gl, GL_SCISSOR_BOX, out.subspan(1, 4));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        std::array<GLint, 4> box{};
        gl.GetIntegeri_v(GL_SCISSOR_BOX, i, box.data());
        const Values saved = part(out, i, 5);
        saved[0] = gl.IsEnabledi(GL_SCISSOR_TEST, i);
        std::ranges::copy(box, saved.begin() + 1);
    }
}

void restore_scissor(const Functions& gl, Saved in) {
    if (!has_viewports(gl)) {
        toggle(gl, GL_SCISSOR_TEST, in[0] != 0);
        gl.Scissor(as_int(in[1]), as_int(in[2]), as_int(in[3]), as_int(in[4]));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        const Saved row = part(in, i, 5);
        if (row[0] != 0) {
            gl.Enablei(GL_SCISSOR_TEST, i);
        } else {
            gl.Disablei(GL_SCISSOR_TEST, i);
        }
        gl.ScissorIndexed(i, as_int(row[1]), as_int(row[2]), as_int(row[3]), as_int(row[4]));
    }
}

void poison_viewport(const Functions& gl, const PoisonObjects& /*objects*/) {
    gl.Viewport(3, 5, 7, 11);
    if (has_viewports(gl)) {
        gl.ViewportIndexedf(2, 1.5F, 2.5F, 9.0F, 4.0F);
    }
}

void poison_depth_range(const Functions& gl, const PoisonObjects& /*objects*/) {
    gl.DepthRange(0.75, 0.25);
    if (has_viewports(gl)) {
        gl.DepthRangeIndexed(2, 0.1, 0.2);
    }
}

void poison_scissor(const Functions& gl, const PoisonObjects& /*objects*/) {
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(1, 2, 1, 1);
    if (has_viewports(gl)) {
        gl.Disablei(GL_SCISSOR_TEST, 3);
        gl.ScissorIndexed(4, 9, 9, 2, 2);
    }
}

// ---- blending and colour masks, per draw buffer

constexpr std::array<GLenum, 6> blend_names{GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA,
                                            GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,
                                            GL_BLEND_SRC_ALPHA,    GL_BLEND_DST_ALPHA};

void save_blend_switch(const Functions& gl, Values out) {
    for (GLuint i = 0; i < draw_buffers; ++i) {
        out[i] = gl.IsEnabledi(GL_BLEND, i);
    }
}

void restore_blend_switch(const Functions& gl, Saved in) {
    for (GLuint i = 0; i < draw_buffers; ++i) {
        if (in[i] != 0) {
            gl.Enablei(GL_BLEND, i);
        } else {
            gl.Disablei(GL_BLEND, i);
        }
    }
}

void save_blend(const Functions& gl, Values out) {
    for (GLuint i = 0; i < (has_4_0(gl) ? draw_buffers : 1); ++i) {
        for (std::size_t k = 0; k < blend_names.size(); ++k) {
            GLint value = 0;
            if (has_4_0(gl)) {
                gl.GetIntegeri_v(blend_names[k], i, &value);
            } else {
                gl.GetIntegerv(blend_names[k], &value);
            }
            out[blend_names.size() * i + k] = value;
        }
    }
}

void restore_blend(const Functions& gl, Saved in) {
    if (!has_4_0(gl)) {
        gl.BlendEquationSeparate(as_enum(in[0]), as_enum(in[1]));
        gl.BlendFuncSeparate(as_enum(in[2]), as_enum(in[3]), as_enum(in[4]), as_enum(in[5]));
        return;
    }
    for (GLuint i = 0; i < draw_buffers; ++i) {
        const Saved row = part(in, i, blend_names.size());
        gl.BlendEquationSeparatei(i, as_enum(row[0]), as_enum(row[1]));
        gl.BlendFuncSeparatei(i, as_enum(row[2]), as_enum(row[3]), as_enum(row[4]), as_enum(row[5]));
    }
}

void poison_blend(const Functions& gl, const PoisonObjects& /*objects*/) {
    gl.BlendEquationSeparate(GL_FUNC_REVERSE_SUBTRACT, GL_MIN);
    gl.BlendFuncSeparate(GL_DST_COLOR, GL_CONSTANT_COLOR, GL_ZERO, GL_SRC_ALPHA_SATURATE);
    if (has_4_0(gl)) {
        gl.BlendFuncSeparatei(1, GL_ZERO, GL_ZERO, GL_ONE, GL_ONE);
        gl.BlendEquationSeparatei(2, GL_FUNC_SUBTRACT, GL_FUNC_SUBTRACT);
    }
}

void save_colour_mask(const Functions& gl, Values out) {
    for (GLuint i = 0; i < draw_buffers; ++i) {
        std::array<GLboolean, 4> mask{};
        gl.GetBooleani_v(GL_COLOR_WRITEMASK, i, mask.data());
        std::ranges::copy(mask, part(out, i, 4).begin());
    }
}

void restore_colour_mask(const Functions& gl, Saved in) {
    for (GLuint i = 0; i < draw_buffers; ++i) {
        const Saved mask = part(in, i, 4);
        gl.ColorMaski(i, as_bool(mask[0]), as_bool(mask[1]), as_bool(mask[2]), as_bool(mask[3]));
    }
}

constexpr std::array indexed_rows{
    HostStateRow{"viewport", 4 * std::size_t{viewports}, true, always, save_viewport, restore_viewport,
                 poison_viewport},
    HostStateRow{"depth range", 2 * std::size_t{viewports}, true, always, save_depth_range,
                 restore_depth_range, poison_depth_range},
    HostStateRow{"scissor", 5 * std::size_t{viewports}, true, always, save_scissor, restore_scissor,
                 poison_scissor},
    HostStateRow{"blend", draw_buffers, true, always, save_blend_switch, restore_blend_switch,
                 [](const Functions& gl, const Objects&) {
                     toggle(gl, GL_BLEND, gl.IsEnabled(GL_BLEND) == GL_FALSE);
                     gl.Enablei(GL_BLEND, 1);
                     gl.Disablei(GL_BLEND, 2);
                 }},
    HostStateRow{"blend functions", blend_names.size() * draw_buffers, true, always, save_blend,
                 restore_blend, poison_blend},
    HostStateRow{"colour mask", 4 * std::size_t{draw_buffers}, true, always, save_colour_mask,
                 restore_colour_mask, [](const Functions& gl, const Objects&) {
                     gl.ColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE);
                     gl.ColorMaski(1, GL_TRUE, GL_FALSE, GL_FALSE, GL_TRUE);
                 }}};

}  // namespace

std::span<const HostStateRow> indexed_state_rows() {
    return indexed_rows;
}

}  // namespace viscera::gl
