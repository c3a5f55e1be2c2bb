#include <algorithm>
#include <bit>

#include "engine/gl/handle.h"
#include "engine/gl/host_state_rows.h"

namespace viscera::gl {
namespace {

using Values = std::span<GLint64>;
using Saved = std::span<const GLint64>;

// ---- reading and keeping values

GLenum as_enum(GLint64 value) {
    return static_cast<GLenum>(value);
}
GLint as_int(GLint64 value) {
    return static_cast<GLint>(value);
}
GLboolean as_bool(GLint64 value) {
    return value != 0 ? GL_TRUE : GL_FALSE;
}
GLfloat as_float(GLint64 value) {
    return std::bit_cast<GLfloat>(static_cast<GLint>(value));
}
GLdouble as_double(GLint64 value) {
    return std::bit_cast<GLdouble>(value);
}

// Room for what drivers may write: some answer GL_POLYGON_MODE with two values.
using Answer = std::array<GLint, 16>;

void read_ints(const Functions& gl, GLenum name, Values out) {
    Answer answer{};
    gl.GetIntegerv(name, answer.data());
    std::copy_n(answer.begin(), out.size(), out.begin());
}

void read_floats(const Functions& gl, GLenum name, Values out) {
    std::array<GLfloat, 16> answer{};
    gl.GetFloatv(name, answer.data());
    std::transform(answer.begin(), answer.begin() + static_cast<std::ptrdiff_t>(out.size()), out.begin(),
                   [](GLfloat value) { return static_cast<GLint64>(std::bit_cast<GLint>(value)); });
}

void toggle(const Functions& gl, GLenum capability, bool on) {
    if (on) {
        gl.Enable(capability);
    } else {
        gl.Disable(capability);
    }
}

bool always(const Functions& /*gl*/) {
    return true;
}
bool has_4_0(const Functions& gl) {
    return gl.VERSION_4_0 != 0;
}
bool has_4_3(const Functions& gl) {
    return gl.VERSION_4_3 != 0;
}
bool has_clip_control(const Functions& gl) {
    return gl.ARB_clip_control != 0;
}

/// A switch of glEnable. Poisoned by turning it over.
template <GLenum capability>
constexpr HostStateRow switch_row(std::string_view name, bool (*available)(const Functions&) = always) {
    return {name,
            1,
            true,
            available,
            [](const Functions& gl, Values out) { out[0] = gl.IsEnabled(capability); },
            [](const Functions& gl, Saved in) { toggle(gl, capability, in[0] != 0); },
            [](const Functions& gl, const PoisonObjects&) {
                toggle(gl, capability, gl.IsEnabled(capability) == GL_FALSE);
            }};
}

/// `count` integers behind one name of glGetIntegerv.
template <GLenum name, std::size_t count = 1>
constexpr HostStateRow integer_row(std::string_view text, void (*restore)(const Functions&, Saved),
                                   void (*poison)(const Functions&, const PoisonObjects&),
                                   bool raster = true) {
    return {text,
            count,
            raster,
            always,
            [](const Functions& gl, Values out) { read_ints(gl, name, out.first(count)); },
            restore,
            poison};
}

template <GLenum name, std::size_t count = 1>
constexpr HostStateRow float_row(std::string_view text, void (*restore)(const Functions&, Saved),
                                 void (*poison)(const Functions&, const PoisonObjects&), bool raster = true) {
    return {text,
            count,
            raster,
            always,
            [](const Functions& gl, Values out) { read_floats(gl, name, out.first(count)); },
            restore,
            poison};
}

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
        std::ranges::transform(box, out.begin() + 4 * i, [](GLfloat value) {
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
        const Saved box = in.subspan(4 * std::size_t{i}, 4);
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
        out[2 * i] = std::bit_cast<GLint64>(range[0]);
        out[2 * i + 1] = std::bit_cast<GLint64>(range[1]);
    }
}

void restore_depth_range(const Functions& gl, Saved in) {
    if (!has_viewports(gl)) {
        gl.DepthRange(as_double(in[0]), as_double(in[1]));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        gl.DepthRangeIndexed(i, as_double(in[2 * i]), as_double(in[2 * i + 1]));
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
        out[5 * i] = gl.IsEnabledi(GL_SCISSOR_TEST, i);
        std::ranges::copy(box, out.begin() + 5 * i + 1);
    }
}

void restore_scissor(const Functions& gl, Saved in) {
    if (!has_viewports(gl)) {
        toggle(gl, GL_SCISSOR_TEST, in[0] != 0);
        gl.Scissor(as_int(in[1]), as_int(in[2]), as_int(in[3]), as_int(in[4]));
        return;
    }
    for (GLuint i = 0; i < viewports; ++i) {
        const Saved row = in.subspan(5 * std::size_t{i}, 5);
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
        const Saved row = in.subspan(blend_names.size() * i, blend_names.size());
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
        std::ranges::copy(mask, out.begin() + 4 * i);
    }
}

void restore_colour_mask(const Functions& gl, Saved in) {
    for (GLuint i = 0; i < draw_buffers; ++i) {
        const Saved mask = in.subspan(4 * std::size_t{i}, 4);
        gl.ColorMaski(i, as_bool(mask[0]), as_bool(mask[1]), as_bool(mask[2]), as_bool(mask[3]));
    }
}

// ---- stencil

struct StencilNames {
    GLenum face;
    std::array<GLenum, 7> names;  ///< func, ref, value mask, fail, depth fail, pass, write mask
};
constexpr StencilNames stencil_front{
    GL_FRONT,
    {GL_STENCIL_FUNC, GL_STENCIL_REF, GL_STENCIL_VALUE_MASK, GL_STENCIL_FAIL, GL_STENCIL_PASS_DEPTH_FAIL,
     GL_STENCIL_PASS_DEPTH_PASS, GL_STENCIL_WRITEMASK}};
constexpr StencilNames stencil_back{
    GL_BACK,
    {GL_STENCIL_BACK_FUNC, GL_STENCIL_BACK_REF, GL_STENCIL_BACK_VALUE_MASK, GL_STENCIL_BACK_FAIL,
     GL_STENCIL_BACK_PASS_DEPTH_FAIL, GL_STENCIL_BACK_PASS_DEPTH_PASS, GL_STENCIL_BACK_WRITEMASK}};

template <const StencilNames& side>
constexpr HostStateRow stencil_row(std::string_view name) {
    return {name,
            side.names.size(),
            false,
            always,
            [](const Functions& gl, Values out) {
                for (std::size_t i = 0; i < side.names.size(); ++i) {
                    read_ints(gl, side.names[i], out.subspan(i, 1));
                }
            },
            [](const Functions& gl, Saved in) {
                gl.StencilFuncSeparate(side.face, as_enum(in[0]), as_int(in[1]), static_cast<GLuint>(in[2]));
                gl.StencilOpSeparate(side.face, as_enum(in[3]), as_enum(in[4]), as_enum(in[5]));
                gl.StencilMaskSeparate(side.face, static_cast<GLuint>(in[6]));
            },
            [](const Functions& gl, const PoisonObjects&) {
                gl.StencilFuncSeparate(side.face, GL_GREATER, 3, 0x55);
                gl.StencilOpSeparate(side.face, GL_INVERT, GL_INCR, GL_DECR_WRAP);
                gl.StencilMaskSeparate(side.face, 0x0F);
            }};
}

// ---- samples

void save_sample_coverage(const Functions& gl, Values out) {
    read_floats(gl, GL_SAMPLE_COVERAGE_VALUE, out.first(1));
    read_ints(gl, GL_SAMPLE_COVERAGE_INVERT, out.subspan(1, 1));
}

void save_sample_mask(const Functions& gl, Values out) {
    GLint mask = 0;
    gl.GetIntegeri_v(GL_SAMPLE_MASK_VALUE, 0, &mask);
    out[0] = mask;
}

void save_clip_control(const Functions& gl, Values out) {
    read_ints(gl, GL_CLIP_ORIGIN, out.first(1));
    read_ints(gl, GL_CLIP_DEPTH_MODE, out.subspan(1, 1));
}

void save_polygon_offset(const Functions& gl, Values out) {
    read_floats(gl, GL_POLYGON_OFFSET_FACTOR, out.first(1));
    read_floats(gl, GL_POLYGON_OFFSET_UNITS, out.subspan(1, 1));
}

using Objects = PoisonObjects;

constexpr std::array rows{
    HostStateRow{"viewport", 4 * viewports, true, always, save_viewport, restore_viewport, poison_viewport},
    HostStateRow{"depth range", 2 * viewports, true, always, save_depth_range, restore_depth_range,
                 poison_depth_range},
    HostStateRow{"scissor", 5 * viewports, true, always, save_scissor, restore_scissor, poison_scissor},
    HostStateRow{"blend", draw_buffers, true, always, save_blend_switch, restore_blend_switch,
                 [](const Functions& gl, const Objects&) {
                     toggle(gl, GL_BLEND, gl.IsEnabled(GL_BLEND) == GL_FALSE);
                     gl.Enablei(GL_BLEND, 1);
                     gl.Disablei(GL_BLEND, 2);
                 }},
    HostStateRow{"blend functions", blend_names.size() * draw_buffers, true, always, save_blend,
                 restore_blend, poison_blend},
    float_row<GL_BLEND_COLOR, 4>(
        "blend colour",
        [](const Functions& gl, Saved in) {
            gl.BlendColor(as_float(in[0]), as_float(in[1]), as_float(in[2]), as_float(in[3]));
        },
        [](const Functions& gl, const Objects&) { gl.BlendColor(0.1F, 0.2F, 0.3F, 0.4F); }),
    HostStateRow{"colour mask", 4 * draw_buffers, true, always, save_colour_mask, restore_colour_mask,
                 [](const Functions& gl, const Objects&) {
                     gl.ColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE);
                     gl.ColorMaski(1, GL_TRUE, GL_FALSE, GL_FALSE, GL_TRUE);
                 }},
    switch_row<GL_COLOR_LOGIC_OP>("logic op"),
    integer_row<GL_LOGIC_OP_MODE>(
        "logic op mode", [](const Functions& gl, Saved in) { gl.LogicOp(as_enum(in[0])); },
        [](const Functions& gl, const Objects&) { gl.LogicOp(GL_XOR); }, false),
    switch_row<GL_DITHER>("dither"),
    switch_row<GL_FRAMEBUFFER_SRGB>("sRGB writes"),

    switch_row<GL_DEPTH_TEST>("depth test"),
    integer_row<GL_DEPTH_FUNC>(
        "depth function", [](const Functions& gl, Saved in) { gl.DepthFunc(as_enum(in[0])); },
        [](const Functions& gl, const Objects&) { gl.DepthFunc(GL_NOTEQUAL); }),
    integer_row<GL_DEPTH_WRITEMASK>(
        "depth mask", [](const Functions& gl, Saved in) { gl.DepthMask(as_bool(in[0])); },
        [](const Functions& gl, const Objects&) {
            GLboolean on = GL_FALSE;
            gl.GetBooleanv(GL_DEPTH_WRITEMASK, &on);
            gl.DepthMask(on == GL_TRUE ? GL_FALSE : GL_TRUE);
        }),
    switch_row<GL_DEPTH_CLAMP>("depth clamp"),
    switch_row<GL_STENCIL_TEST>("stencil test"),
    stencil_row<stencil_front>("stencil front"),
    stencil_row<stencil_back>("stencil back"),

    float_row<GL_COLOR_CLEAR_VALUE, 4>(
        "clear colour",
        [](const Functions& gl, Saved in) {
            gl.ClearColor(as_float(in[0]), as_float(in[1]), as_float(in[2]), as_float(in[3]));
        },
        [](const Functions& gl, const Objects&) { gl.ClearColor(0.5F, 0.25F, 0.125F, 0.75F); }, false),
    float_row<GL_DEPTH_CLEAR_VALUE>(
        "clear depth", [](const Functions& gl, Saved in) { gl.ClearDepth(as_float(in[0])); },
        [](const Functions& gl, const Objects&) { gl.ClearDepth(0.25); }, false),
    integer_row<GL_STENCIL_CLEAR_VALUE>(
        "clear stencil", [](const Functions& gl, Saved in) { gl.ClearStencil(as_int(in[0])); },
        [](const Functions& gl, const Objects&) { gl.ClearStencil(5); }, false),

    switch_row<GL_CULL_FACE>("cull"),
    integer_row<GL_CULL_FACE_MODE>(
        "cull face", [](const Functions& gl, Saved in) { gl.CullFace(as_enum(in[0])); },
        [](const Functions& gl, const Objects&) { gl.CullFace(GL_FRONT_AND_BACK); }),
    integer_row<GL_FRONT_FACE>(
        "front face", [](const Functions& gl, Saved in) { gl.FrontFace(as_enum(in[0])); },
        [](const Functions& gl, const Objects&) { gl.FrontFace(GL_CW); }),
    integer_row<GL_POLYGON_MODE>(
        "polygon mode",
        [](const Functions& gl, Saved in) { gl.PolygonMode(GL_FRONT_AND_BACK, as_enum(in[0])); },
        [](const Functions& gl, const Objects&) { gl.PolygonMode(GL_FRONT_AND_BACK, GL_POINT); }),
    switch_row<GL_POLYGON_OFFSET_FILL>("polygon offset fill"),
    switch_row<GL_POLYGON_OFFSET_LINE>("polygon offset line"),
    switch_row<GL_POLYGON_OFFSET_POINT>("polygon offset point"),
    HostStateRow{"polygon offset", 2, true, always, save_polygon_offset,
                 [](const Functions& gl, Saved in) { gl.PolygonOffset(as_float(in[0]), as_float(in[1])); },
                 [](const Functions& gl, const Objects&) { gl.PolygonOffset(3.0F, 7.0F); }},
    switch_row<GL_POLYGON_SMOOTH>("polygon smooth"),
    switch_row<GL_LINE_SMOOTH>("line smooth"),
    float_row<GL_LINE_WIDTH>(
        "line width", [](const Functions& gl, Saved in) { gl.LineWidth(as_float(in[0])); },
        [](const Functions& gl, const Objects&) { gl.LineWidth(0.5F); }),
    float_row<GL_POINT_SIZE>(
        "point size", [](const Functions& gl, Saved in) { gl.PointSize(as_float(in[0])); },
        [](const Functions& gl, const Objects&) { gl.PointSize(3.0F); }),
    float_row<GL_POINT_FADE_THRESHOLD_SIZE>(
        "point fade threshold",
        [](const Functions& gl, Saved in) {
            gl.PointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, as_float(in[0]));
        },
        [](const Functions& gl, const Objects&) { gl.PointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, 2.0F); }),
    integer_row<GL_POINT_SPRITE_COORD_ORIGIN>(
        "point sprite origin",
        [](const Functions& gl, Saved in) {
            gl.PointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, as_int(in[0]));
        },
        [](const Functions& gl, const Objects&) {
            GLint origin = 0;
            gl.GetIntegerv(GL_POINT_SPRITE_COORD_ORIGIN, &origin);
            gl.PointParameteri(GL_POINT_SPRITE_COORD_ORIGIN,
                               origin == GL_LOWER_LEFT ? GL_UPPER_LEFT : GL_LOWER_LEFT);
        }),
    switch_row<GL_PROGRAM_POINT_SIZE>("program point size"),
    integer_row<GL_PROVOKING_VERTEX>(
        "provoking vertex", [](const Functions& gl, Saved in) { gl.ProvokingVertex(as_enum(in[0])); },
        [](const Functions& gl, const Objects&) { gl.ProvokingVertex(GL_FIRST_VERTEX_CONVENTION); }),
    switch_row<GL_PRIMITIVE_RESTART>("primitive restart"),
    integer_row<GL_PRIMITIVE_RESTART_INDEX>(
        "primitive restart index",
        [](const Functions& gl, Saved in) { gl.PrimitiveRestartIndex(static_cast<GLuint>(in[0])); },
        [](const Functions& gl, const Objects&) { gl.PrimitiveRestartIndex(2); }),
    switch_row<GL_PRIMITIVE_RESTART_FIXED_INDEX>("primitive restart fixed index", has_4_3),
    switch_row<GL_RASTERIZER_DISCARD>("rasterizer discard"),
    switch_row<GL_CLIP_DISTANCE0>("clip distance 0"),
    switch_row<GL_CLIP_DISTANCE1>("clip distance 1"),
    switch_row<GL_CLIP_DISTANCE2>("clip distance 2"),
    switch_row<GL_CLIP_DISTANCE3>("clip distance 3"),
    switch_row<GL_CLIP_DISTANCE4>("clip distance 4"),
    switch_row<GL_CLIP_DISTANCE5>("clip distance 5"),
    switch_row<GL_CLIP_DISTANCE6>("clip distance 6"),
    switch_row<GL_CLIP_DISTANCE7>("clip distance 7"),
    HostStateRow{"clip control", 2, true, has_clip_control, save_clip_control,
                 [](const Functions& gl, Saved in) { gl.ClipControl(as_enum(in[0]), as_enum(in[1])); },
                 [](const Functions& gl, const Objects&) { gl.ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE); }},

    switch_row<GL_MULTISAMPLE>("multisample"),
    switch_row<GL_SAMPLE_ALPHA_TO_COVERAGE>("alpha to coverage"),
    switch_row<GL_SAMPLE_ALPHA_TO_ONE>("alpha to one"),
    switch_row<GL_SAMPLE_COVERAGE>("sample coverage"),
    HostStateRow{"sample coverage value", 2, false, always, save_sample_coverage,
                 [](const Functions& gl, Saved in) { gl.SampleCoverage(as_float(in[0]), as_bool(in[1])); },
                 [](const Functions& gl, const Objects&) { gl.SampleCoverage(0.25F, GL_TRUE); }},
    switch_row<GL_SAMPLE_MASK>("sample mask"),
    HostStateRow{"sample mask value", 1, false, always, save_sample_mask,
                 [](const Functions& gl, Saved in) { gl.SampleMaski(0, static_cast<GLbitfield>(in[0])); },
                 [](const Functions& gl, const Objects&) { gl.SampleMaski(0, 0x2); }},
    switch_row<GL_SAMPLE_SHADING>("sample shading", has_4_0),
    switch_row<GL_TEXTURE_CUBE_MAP_SEAMLESS>("seamless cube map"),
};

}  // namespace

std::span<const HostStateRow> fixed_state_rows() {
    return rows;
}

}  // namespace viscera::gl
