#include "engine/gl/host_state_values.h"

namespace viscera::gl {
namespace {

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

constexpr std::array fixed_rows{
    float_row<GL_BLEND_COLOR, 4>(
        "blend colour",
        [](const Functions& gl, Saved in) {
            gl.BlendColor(as_float(in[0]), as_float(in[1]), as_float(in[2]), as_float(in[3]));
        },
        [](const Functions& gl, const Objects&) { gl.BlendColor(0.1F, 0.2F, 0.3F, 0.4F); }),
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
    return fixed_rows;
}

}  // namespace viscera::gl
