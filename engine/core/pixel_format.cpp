#include "engine/core/pixel_format.h"

namespace viscera {
namespace {

using enum PixelFormat;
using enum ChannelType;

// In the order of the enumeration, so that info() is an index.
constexpr std::array<FormatInfo, 10> formats{{
    {r8, "r8", unorm8, 1, false},
    {rg8, "rg8", unorm8, 2, false},
    {rgba8, "rgba8", unorm8, 4, false},
    {r16f, "r16f", half, 1, false},
    {rg16f, "rg16f", half, 2, false},
    {rgba16f, "rgba16f", half, 4, false},
    {r32f, "r32f", float32, 1, false},
    {rg32f, "rg32f", float32, 2, false},
    {rgba32f, "rgba32f", float32, 4, false},
    {depth32f, "depth32f", float32, 1, true},
}};

}  // namespace

std::span<const FormatInfo> all_formats() {
    return formats;
}

const FormatInfo& info(PixelFormat format) {
    return formats[static_cast<std::size_t>(format)];
}

std::optional<PixelFormat> parse_format(std::string_view name) {
    for (const FormatInfo& entry : formats) {
        if (entry.name == name) {
            return entry.format;
        }
    }
    return std::nullopt;
}

std::size_t bytes_per_channel(ChannelType type) {
    switch (type) {
        case unorm8:
            return 1;
        case half:
            return 2;
        case float32:
            return 4;
    }
    return 0;
}

std::size_t bytes_per_pixel(PixelFormat format) {
    const FormatInfo& entry = info(format);
    return bytes_per_channel(entry.type) * static_cast<std::size_t>(entry.channels);
}

PixelFormat as_float32(PixelFormat format) {
    const FormatInfo& entry = info(format);
    if (entry.is_depth) {
        return depth32f;
    }
    return entry.channels == 1 ? r32f : entry.channels == 2 ? rg32f : rgba32f;
}

}  // namespace viscera
