#include <Imath/half.h>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/core/image.h"

namespace viscera {
namespace {

unsigned short imath_bits(float value) {
    return Imath::half(value).bits();
}

TEST(Half, WidensEveryValueAsImathDoes) {
    for (unsigned bits = 0; bits < 0x10000U; ++bits) {
        Imath::half expected;
        expected.setBits(static_cast<unsigned short>(bits));
        const float widened = half_to_float(static_cast<unsigned short>(bits));
        ASSERT_EQ(std::bit_cast<std::uint32_t>(widened),
                  std::bit_cast<std::uint32_t>(static_cast<float>(expected)))
            << std::hex << bits;
    }
}

TEST(Half, EveryValueComesBack) {
    for (unsigned bits = 0; bits < 0x10000U; ++bits) {
        const auto half = static_cast<unsigned short>(bits);
        ASSERT_EQ(float_to_half(half_to_float(half)), half) << std::hex << bits;
    }
}

TEST(Half, RoundsAsImathDoesAtAndBesideEveryMidpoint) {
    for (unsigned bits = 0; bits < 0x7C00U; ++bits) {
        const double low = half_to_float(static_cast<unsigned short>(bits));
        const double high = bits == 0x7BFFU ? 65536.0 : half_to_float(static_cast<unsigned short>(bits + 1));
        const auto midpoint = static_cast<float>((low + high) / 2.0);
        for (const float value :
             {midpoint, std::nextafter(midpoint, 0.0F), std::nextafter(midpoint, 1e30F)}) {
            ASSERT_EQ(float_to_half(value), imath_bits(value)) << value;
            ASSERT_EQ(float_to_half(-value), imath_bits(-value)) << -value;
        }
    }
}

TEST(Half, RoundsAsImathDoesOverAllExponents) {
    std::uint32_t bits = 0;
    do {
        const auto value = std::bit_cast<float>(bits);
        if (std::isnan(value)) {
            ASSERT_TRUE(std::isnan(half_to_float(float_to_half(value)))) << std::hex << bits;
        } else {
            ASSERT_EQ(float_to_half(value), imath_bits(value)) << std::hex << bits;
        }
        bits += 4099U;  // a prime, so that all low bits come by
    } while (bits > 4099U);
}

TEST(Image, StoresEachTypeRoundedToNearest) {
    Image bytes = make_image(2, 1, PixelFormat::rgba8);
    bytes.set(1, 0, 2, 0.5F);  // 127.5 rounds up
    bytes.set(0, 0, 0, 2.0F);
    bytes.set(0, 0, 1, -1.0F);
    bytes.set(0, 0, 2, std::numeric_limits<float>::quiet_NaN());
    EXPECT_EQ(bytes.at(1, 0, 2), 128.0F / 255.0F);
    EXPECT_EQ(bytes.at(0, 0, 0), 1.0F);
    EXPECT_EQ(bytes.at(0, 0, 1), 0.0F);
    EXPECT_EQ(bytes.at(0, 0, 2), 0.0F);

    Image half = make_image(1, 2, PixelFormat::rg16f);
    half.set(0, 1, 1, 1.0F + 0x1.0p-11F);  // halfway: to even, downwards
    EXPECT_EQ(half.at(0, 1, 1), 1.0F);
    half.set(0, 1, 1, 1.0F + 0x1.8p-10F);  // halfway: to even, upwards
    EXPECT_EQ(half.at(0, 1, 1), 1.0F + 0x1.0p-9F);

    Image wide = make_image(1, 1, PixelFormat::r32f);
    wide.set(0, 0, 0, 0.1F);
    EXPECT_EQ(to_floats(wide), std::vector<float>{0.1F});
}

}  // namespace
}  // namespace viscera
