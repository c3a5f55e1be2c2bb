#include "tests/effects/deviation.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <gtest/gtest.h>

namespace viscera::test {
namespace {

/// Halves in a row: neighbours differ by 1, across 0 too.
int rank_of_half(double value) {
    const int bits = float_to_half(static_cast<float>(value));
    return (bits & 0x8000) != 0 ? -(bits & 0x7fff) : bits;
}

bool is_half(PixelFormat format) {
    return info(format).type == ChannelType::half;
}

}  // namespace

double truncate_to_half(double value) {
    if (value == 0.0 || !std::isfinite(value)) {
        return value;
    }
    int exponent = 0;
    (void)std::frexp(value, &exponent);
    const double unit = std::ldexp(1.0, std::max(exponent - 11, -24));
    return std::trunc(value / unit) * unit;
}

reference::Buffer to_buffer(const Image& image) {
    const std::vector<float> values = to_floats(image);
    reference::Buffer buffer(image.width, image.height, image.channels());
    buffer.data.assign(values.begin(), values.end());
    return buffer;
}

Deviation deviation(const Image& image, const reference::Buffer& wanted, int image_channel,
                    int wanted_channel, const IsCompared& is_compared) {
    if (image.width != wanted.width || image.height != wanted.height) {
        throw std::invalid_argument("target and reference differ in size");
    }
    Deviation found;
    double worst = -1.0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (is_compared && !is_compared(x, y)) {
                ++found.left_out;
                continue;
            }
            const double got = static_cast<double>(image.at(x, y, image_channel));
            const double want = wanted.at(x, y, wanted_channel);
            ++found.compared;
            found.content += want != 0.0 ? 1 : 0;
            if (!std::isfinite(got)) {
                ++found.not_finite;
                continue;
            }
            const int units = std::abs(rank_of_half(got) - rank_of_half(truncate_to_half(want)));
            const double distance = std::abs(got - want);
            found.half_units = std::max(found.half_units, units);
            found.max = std::max(found.max, distance);
            const double measure = is_half(image.format) ? units : distance;
            if (measure > worst) {
                worst = measure;
                found.x = x;
                found.y = y;
                found.got = got;
                found.wanted = want;
            }
        }
    }
    return found;
}

void expect_accurate(const std::string& name, PixelFormat format, const Deviation& found,
                     std::size_t least_content) {
    const std::string measured = is_half(format) ? std::to_string(found.half_units) + " units of half"
                                                 : std::to_string(found.max * 1e6) + "e-6";
    std::printf("  %-44s %-8s %-16s %zu pixels, %zu left out\n", name.c_str(), info(format).name.data(),
                measured.c_str(), found.compared, found.left_out);
    EXPECT_EQ(found.not_finite, 0U) << name;
    EXPECT_GE(found.content, least_content) << name << ": the picture is too empty to prove anything";
    const auto where = [&] {
        return name + " at (" + std::to_string(found.x) + ", " + std::to_string(found.y) +
               "): " + std::to_string(found.got) + " for " + std::to_string(found.wanted);
    };
    if (is_half(format)) {
        EXPECT_LE(found.half_units, half_bound) << where();
    } else {
        EXPECT_LE(found.max, float_bound) << where();
    }
}

}  // namespace viscera::test
