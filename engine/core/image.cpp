#include "engine/core/image.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/size_text.h"

namespace viscera {

namespace {

constexpr float unorm8_max = 255.0F;

std::size_t offset_of(const Image& image, int x, int y, int c) {
    assert(x >= 0 && x < image.width && y >= 0 && y < image.height && c >= 0 && c < image.channels());
    const FormatInfo& format = info(image.format);
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
    return (pixel * static_cast<std::size_t>(format.channels) + static_cast<std::size_t>(c)) *
           bytes_per_channel(format.type);
}

float load(const std::byte* bytes, ChannelType type) {
    switch (type) {
        case ChannelType::unorm8:
            return static_cast<float>(std::to_integer<unsigned>(*bytes)) / unorm8_max;
        case ChannelType::half: {
            unsigned short bits = 0;
            std::memcpy(&bits, bytes, sizeof bits);
            return half_to_float(bits);
        }
        case ChannelType::float32: {
            float value = 0.0F;
            std::memcpy(&value, bytes, sizeof value);
            return value;
        }
    }
    return 0.0F;
}

void store(std::byte* bytes, ChannelType type, float value) {
    switch (type) {
        case ChannelType::unorm8: {
            // NaN fails the first comparison and so becomes 0.
            const float clamped = value > 0.0F ? std::fmin(value, 1.0F) : 0.0F;
            *bytes = static_cast<std::byte>(std::lround(clamped * unorm8_max));
            break;
        }
        case ChannelType::half: {
            const unsigned short bits = float_to_half(value);
            std::memcpy(bytes, &bits, sizeof bits);
            break;
        }
        case ChannelType::float32:
            std::memcpy(bytes, &value, sizeof value);
            break;
    }
}

}  // namespace

float half_to_float(unsigned short bits) {
    const std::uint32_t sign = (bits & 0x8000U) << 16U;
    const std::uint32_t exponent = (bits >> 10U) & 0x1FU;
    const std::uint32_t mantissa = bits & 0x3FFU;
    if (exponent == 0x1FU) {
        return std::bit_cast<float>(sign | 0x7F800000U | (mantissa << 13U));
    }
    if (exponent != 0) {
        return std::bit_cast<float>(sign | ((exponent + 112U) << 23U) | (mantissa << 13U));
    }
    constexpr float subnormal_step = 0x1.0p-24F;
    const float magnitude = static_cast<float>(mantissa) * subnormal_step;
    return sign != 0 ? -magnitude : magnitude;
}

unsigned short float_to_half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = (bits >> 16U) & 0x8000U;
    const std::uint32_t magnitude = bits & 0x7FFFFFFFU;

    constexpr std::uint32_t infinity = 0x7F800000U;
    constexpr std::uint32_t overflow = 0x477FF000U;         // 65520: halfway from 65504 to what would be next
    constexpr std::uint32_t smallest_normal = 0x38800000U;  // 2^-14
    constexpr std::uint32_t smallest_rounded = 0x33000000U;  // 2^-25: at or below it all round to zero

    if (magnitude > infinity) {
        const std::uint32_t payload = (magnitude >> 13U) & 0x3FFU;
        return static_cast<unsigned short>(sign | 0x7C00U | (payload != 0 ? payload : 1U));
    }
    if (magnitude >= overflow) {
        return static_cast<unsigned short>(sign | 0x7C00U);
    }
    if (magnitude <= smallest_rounded) {
        return static_cast<unsigned short>(sign);
    }
    // Both cases round to even by adding half a unit less the odd bit; a carry runs into the exponent as it
    // should.
    if (magnitude >= smallest_normal) {
        const std::uint32_t rebased = magnitude - (112U << 23U);
        const std::uint32_t odd = (rebased >> 13U) & 1U;
        return static_cast<unsigned short>(sign | ((rebased + 0xFFFU + odd) >> 13U));
    }
    const std::uint32_t mantissa = (magnitude & 0x7FFFFFU) | 0x800000U;
    const std::uint32_t shift = 126U - (magnitude >> 23U);  // 14 to 24
    const std::uint32_t half_unit = 1U << (shift - 1U);
    const std::uint32_t odd = (mantissa >> shift) & 1U;
    return static_cast<unsigned short>(sign | ((mantissa + half_unit - 1U + odd) >> shift));
}

float Image::at(int x, int y, int c) const {
    return load(data.data() + offset_of(*this, x, y, c), info(format).type);
}

void Image::set(int x, int y, int c, float value) {
    store(data.data() + offset_of(*this, x, y, c), info(format).type, value);
}

Image make_image(int width, int height, PixelFormat format) {
    if (width < 0 || height < 0) {
        throw Error(ErrorCode::limit, "image", "width and height must not be negative");
    }
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(height);
    const std::size_t pixel_bytes = bytes_per_pixel(format);
    constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
    if (rows != 0 && columns > most / pixel_bytes / rows) {
        throw Error(ErrorCode::limit, "image", size_text({width, height}) + " pixels are too many bytes");
    }
    Image image{width, height, format, {}};
    try {
        image.data.resize(columns * rows * pixel_bytes);
    } catch (const std::exception&) {
        throw Error(ErrorCode::limit, "image", "no memory for " + size_text({width, height}) + " pixels");
    }
    return image;
}

std::vector<float> to_floats(const Image& image) {
    const ChannelType type = info(image.format).type;
    const std::size_t step = bytes_per_channel(type);
    std::vector<float> values(image.data.size() / step);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = load(image.data.data() + i * step, type);
    }
    return values;
}

std::vector<std::string> default_channel_names(PixelFormat format) {
    const FormatInfo& format_info = info(format);
    if (format_info.is_depth) {
        return {"Z"};
    }
    switch (format_info.channels) {
        case 1:
            return {"Y"};
        case 2:
            return {"R", "G"};
        default:
            return {"R", "G", "B", "A"};
    }
}

}  // namespace viscera
