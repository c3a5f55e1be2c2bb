#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace viscera {

/// Formats that a render target or an image may have. All are required as colour-renderable by OpenGL 3.3
/// (table 3.12 of the core specification) but depth32f, which is depth-renderable.
enum class PixelFormat { r8, rg8, rgba8, r16f, rg16f, rgba16f, r32f, rg32f, rgba32f, depth32f };

enum class ChannelType { unorm8, half, float32 };

struct FormatInfo {
    PixelFormat format;
    std::string_view name;  ///< as it stands in scene files: "r16f"
    ChannelType type;
    int channels;  ///< 1, 2 or 4
    bool is_depth;
};

[[nodiscard]] std::span<const FormatInfo> all_formats();
[[nodiscard]] const FormatInfo& info(PixelFormat format);
[[nodiscard]] std::optional<PixelFormat> parse_format(std::string_view name);
[[nodiscard]] std::size_t bytes_per_channel(ChannelType type);
[[nodiscard]] std::size_t bytes_per_pixel(PixelFormat format);
/// The same channels in 32-bit float; depth32f stays.
[[nodiscard]] PixelFormat as_float32(PixelFormat format);

}  // namespace viscera
