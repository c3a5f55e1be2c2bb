#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "engine/io/exr.h"
#include "tests/effects/scenes.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {

/// Inputs for passes that read pictures: any value in any target, by way of files.
class NoisePictures {
  public:
    /// An EXR of random values in [low, high], a fifth of them exactly `low`. Same seed, same file.
    std::string noise(unsigned seed, int width, int height, float low = 0.0F, float high = 1.0F) const {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> unit(0.0F, 1.0F);
        Image image = make_image(width, height, PixelFormat::rgba32f);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < 4; ++c) {
                    const float value = unit(random);
                    image.set(x, y, c, unit(random) < 0.2F ? low : low + (high - low) * value);
                }
            }
        }
        return write("noise" + std::to_string(seed) + ".exr", image);
    }

    /// One channel of waves in [0, 1], smooth from pixel to pixel.
    std::string waves(int width, int height, float per_pixel) const {
        Image image = make_image(width, height, PixelFormat::r32f);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto u = static_cast<float>(x);
                const auto v = static_cast<float>(y);
                image.set(x, y, 0, 0.5F + 0.5F * std::sin(per_pixel * u) * std::cos(0.7F * per_pixel * v));
            }
        }
        return write("waves" + std::to_string(width) + "-" + std::to_string(per_pixel) + ".exr", image);
    }

    /// A pass that fills a target with a file.
    static nlohmann::json fill(const std::string& target, const std::string& file, bool one_channel = true) {
        return pass("fill-" + target, "picture.image",
                    {{"file", file}, {"fit", "stretch"}, {"monochrome", one_channel}}, {{"image", target}});
    }

  private:
    std::string write(const std::string& name, const Image& image) const {
        const std::array<io::ExrPart, 1> parts{io::ExrPart{.name = "picture", .image = image}};
        io::write_exr(folder_ / name, parts, io::ExrCompression::none);
        return (folder_ / name).string();
    }

    TempFolder folder_;
};

}  // namespace viscera::test
