#pragma once

#include <array>
#include <optional>

#include "engine/gl/functions.h"

namespace viscera::gl {

/// Pixels, origin bottom-left.
struct Rect {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    bool operator==(const Rect&) const = default;
};

struct Blend {
    GLenum equation_rgb = GL_FUNC_ADD;
    GLenum equation_alpha = GL_FUNC_ADD;
    GLenum source_rgb = GL_ONE;
    GLenum destination_rgb = GL_ZERO;
    GLenum source_alpha = GL_ONE;
    GLenum destination_alpha = GL_ZERO;

    bool operator==(const Blend&) const = default;
};

struct PolygonOffset {
    float factor = 0.0F;
    float units = 0.0F;

    bool operator==(const PolygonOffset&) const = default;
};

/// Everything of the fixed pipeline that decides what a draw or a clear writes. The default overwrites all
/// channels without tests. What has no member is always the same: no stencil, logic op, dither, alpha to
/// coverage, sample masks, clip distances, rasterizer discard or smoothing; depth range [0, 1]; lines and
/// points of 1 pixel; last vertex provokes.
struct RasterState {
    std::optional<GLenum> cull = std::nullopt;  ///< GL_BACK or GL_FRONT; none: both sides are drawn
    GLenum front_face = GL_CCW;
    std::optional<GLenum> depth_test =
        std::nullopt;  ///< the comparison; none: no test, and then no depth is written
    bool depth_write = false;
    bool depth_clamp = false;
    std::optional<Blend> blend = std::nullopt;  ///< of all draw buffers
    std::array<bool, 4> colour_mask{true, true, true, true};
    std::optional<Rect> scissor = std::nullopt;
    GLenum polygon_mode = GL_FILL;
    std::optional<PolygonOffset> polygon_offset = std::nullopt;
    bool multisample = true;
    bool srgb_write = false;
    std::optional<GLuint> primitive_restart = std::nullopt;  ///< the index that restarts
    bool program_point_size = false;

    bool operator==(const RasterState&) const = default;
};

/// Full-screen passes and clears of colour.
inline constexpr RasterState overwrite_state{};
/// The largest value per channel wins, whatever the order.
inline constexpr RasterState max_blend_state{.blend = Blend{.equation_rgb = GL_MAX,
                                                            .equation_alpha = GL_MAX,
                                                            .destination_rgb = GL_ONE,
                                                            .destination_alpha = GL_ONE}};
inline constexpr RasterState add_blend_state{
    .blend = Blend{.destination_rgb = GL_ONE, .destination_alpha = GL_ONE}};
/// Nearest surface wins. Also for clears of colour and depth.
inline constexpr RasterState depth_tested_state{.depth_test = GL_LESS, .depth_write = true};

/// Sets all of the state, every time: nothing of what was set before, by whomever, shows through.
void apply(const Functions& gl, const RasterState& state, const Rect& viewport);

}  // namespace viscera::gl
