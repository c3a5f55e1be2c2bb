#include "engine/gl/raster_state.h"

#include "engine/gl/handle.h"

namespace viscera::gl {
namespace {

constexpr GLuint clip_distances = 8;

void apply_fixed(const Functions& gl) {
    static constexpr std::array<GLenum, 10> off{
        GL_STENCIL_TEST,        GL_COLOR_LOGIC_OP,  GL_DITHER,      GL_SAMPLE_ALPHA_TO_COVERAGE,
        GL_SAMPLE_ALPHA_TO_ONE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK, GL_RASTERIZER_DISCARD,
        GL_LINE_SMOOTH,         GL_POLYGON_SMOOTH};
    for (const GLenum capability : off) {
        gl.Disable(capability);
    }
    for (GLuint i = 0; i < clip_distances; ++i) {
        gl.Disable(GL_CLIP_DISTANCE0 + i);
    }
    gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    gl.DepthRange(0.0, 1.0);
    gl.ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    gl.LineWidth(1.0F);
    gl.PointSize(1.0F);
    gl.PointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_LOWER_LEFT);
    gl.PointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, 1.0F);
    // A host in a newer context may have switched these on; they must not bend what 3.3 promises.
    if (gl.VERSION_4_0 != 0) {
        gl.Disable(GL_SAMPLE_SHADING);
    }
    if (gl.VERSION_4_3 != 0) {
        gl.Disable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    }
    if (gl.ARB_clip_control != 0) {
        gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    }
}

void apply_depth_and_blend(const Functions& gl, const RasterState& state) {
    toggle(gl, GL_DEPTH_TEST, state.depth_test.has_value());
    gl.DepthFunc(state.depth_test.value_or(GL_LESS));
    gl.DepthMask(state.depth_write ? GL_TRUE : GL_FALSE);
    toggle(gl, GL_DEPTH_CLAMP, state.depth_clamp);

    toggle(gl, GL_BLEND, state.blend.has_value());
    const Blend blend = state.blend.value_or(Blend{});
    gl.BlendEquationSeparate(blend.equation_rgb, blend.equation_alpha);
    gl.BlendFuncSeparate(blend.source_rgb, blend.destination_rgb, blend.source_alpha,
                         blend.destination_alpha);
    gl.BlendColor(0.0F, 0.0F, 0.0F, 0.0F);
    const auto& mask = state.colour_mask;
    gl.ColorMask(mask[0], mask[1], mask[2], mask[3]);
    toggle(gl, GL_FRAMEBUFFER_SRGB, state.srgb_write);
    toggle(gl, GL_MULTISAMPLE, state.multisample);
}

void apply_polygons(const Functions& gl, const RasterState& state) {
    toggle(gl, GL_CULL_FACE, state.cull.has_value());
    gl.CullFace(state.cull.value_or(GL_BACK));
    gl.FrontFace(state.front_face);
    gl.PolygonMode(GL_FRONT_AND_BACK, state.polygon_mode);
    for (const GLenum capability :
         {GL_POLYGON_OFFSET_FILL, GL_POLYGON_OFFSET_LINE, GL_POLYGON_OFFSET_POINT}) {
        toggle(gl, capability, state.polygon_offset.has_value());
    }
    const PolygonOffset offset = state.polygon_offset.value_or(PolygonOffset{});
    gl.PolygonOffset(offset.factor, offset.units);
    toggle(gl, GL_PRIMITIVE_RESTART, state.primitive_restart.has_value());
    gl.PrimitiveRestartIndex(state.primitive_restart.value_or(0));
    toggle(gl, GL_PROGRAM_POINT_SIZE, state.program_point_size);
}

}  // namespace

void apply(const Functions& gl, const RasterState& state, const Rect& viewport) {
    gl.Viewport(viewport.x, viewport.y, viewport.width, viewport.height);
    toggle(gl, GL_SCISSOR_TEST, state.scissor.has_value());
    const Rect scissor = state.scissor.value_or(viewport);
    gl.Scissor(scissor.x, scissor.y, scissor.width, scissor.height);
    apply_depth_and_blend(gl, state);
    apply_polygons(gl, state);
    apply_fixed(gl);
}

}  // namespace viscera::gl
