#include "effects/organ/pictures.h"

#include <array>
#include <cmath>
#include <filesystem>

#include "engine/core/hash.h"
#include "engine/core/image_levels.h"
#include "engine/runtime/pass.h"

namespace viscera::organ {
namespace {

constexpr double least_z = 1e-3;

/// Largest whole number that a map's components were stored as; 0: as floats.
double largest_whole(const Image& normals, const std::string& name) {
    if (info(normals.format).type == ChannelType::unorm8) {
        return 255.0;
    }
    const std::string ending = std::filesystem::path(name).extension().string();
    return ending == ".png" || ending == ".PNG" ? 65535.0 : 0.0;
}

/// Whole numbers cannot say 0 but for the convention that 128, or 32768, is it: without that a flat map of 8
/// bits would tilt everything by a quarter of a degree.
double component(float stored, const BumpParams& how, double largest) {
    if (how.encoding == NormalEncoding::signed_xyz) {
        return static_cast<double>(stored);
    }
    if (largest > 0.0) {
        const double half = 0.5 * (largest + 1.0);
        return (std::round(static_cast<double>(stored) * largest) - half) / (half - 1.0);
    }
    return 2.0 * static_cast<double>(stored) - 1.0;
}

}  // namespace

Image slopes_of(const Image& normals, const BumpParams& how, Log& log, const std::string& name) {
    const bool eight_bit = info(normals.format).type == ChannelType::unorm8;
    Image slopes =
        make_image(normals.width, normals.height, eight_bit ? PixelFormat::rg16f : PixelFormat::rg32f);
    const double largest = largest_whole(normals, name);
    std::uint64_t faults = 0;
    for (int y = 0; y < normals.height; ++y) {
        for (int x = 0; x < normals.width; ++x) {
            std::array<double, 3> n{};
            for (int c = 0; c < 3; ++c) {
                n[static_cast<std::size_t>(c)] =
                    component(c < normals.channels() ? normals.at(x, y, c) : 1.0F, how, largest);
            }
            if (!(n[2] >= least_z) || !std::isfinite(n[0] / n[2]) || !std::isfinite(n[1] / n[2])) {
                ++faults;
                continue;
            }
            slopes.set(x, y, 0, static_cast<float>(-n[0] / n[2]));
            slopes.set(x, y, 1, static_cast<float>((how.green_down ? n[1] : -n[1]) / n[2]));
        }
    }
    if (faults > 0) {
        log.fault("organ.normal_map", name + " has normals that do not point outwards; they are flat",
                  faults);
    }
    return slopes;
}

Image colours_of(const Image& picture, Log& log, const std::string& name) {
    const bool grey = picture.channels() < 3;
    PixelFormat format = PixelFormat::rgba32f;
    if (info(picture.format).type == ChannelType::unorm8) {
        format = PixelFormat::rgba8;
    } else if (info(picture.format).type == ChannelType::half) {
        format = PixelFormat::rgba16f;
    }
    Image colours = make_image(picture.width, picture.height, format);
    std::uint64_t faults = 0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            for (int c = 0; c < 4; ++c) {
                const bool alpha = c == 3;
                float value = grey && alpha ? 1.0F : picture.at(x, y, grey ? 0 : c);
                if (!std::isfinite(value)) {
                    value = 0.0F;
                    ++faults;
                }
                colours.set(x, y, c, value);
            }
        }
    }
    if (faults > 0) {
        log.fault("organ.not_finite", name + " has values that are not finite; they show as 0", faults);
    }
    return colours;
}

std::shared_ptr<gl::Texture> slope_texture(const Pass& pass, const BumpParams& how) {
    const std::string& name = how.map.path.native();
    const std::uint64_t key = Hash()
                                  .add(std::string_view("organ slopes"))
                                  .add(pass.assets().file_key(how.map.path))
                                  .add(how.encoding)
                                  .add(how.green_down)
                                  .value();
    return pass.assets().shared<gl::Texture>(key, [&] {
        const std::shared_ptr<const Image> image = pass.assets().image(how.map.path);
        return std::make_shared<gl::Texture>(gl::Texture::from_levels(
            pass.gl(), image_levels(slopes_of(*image, how, pass.log(), name)), name));
    });
}

std::shared_ptr<gl::Texture> colour_texture(const Pass& pass, const AssetPath& file) {
    const std::string& name = file.path.native();
    const std::uint64_t key =
        Hash().add(std::string_view("organ colours")).add(pass.assets().file_key(file.path)).value();
    return pass.assets().shared<gl::Texture>(key, [&] {
        const std::shared_ptr<const Image> image = pass.assets().image(file.path);
        return std::make_shared<gl::Texture>(
            gl::Texture::from_levels(pass.gl(), image_levels(colours_of(*image, pass.log(), name)), name));
    });
}

}  // namespace viscera::organ
