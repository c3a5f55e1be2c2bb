#include "engine/core/image_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace viscera {
namespace {

/// A picture in numbers that are not rounded to its format: rows of width * channels.
struct Grid {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> values;
};

/// What of `from` sections one of half as many covers: calls add(to, from, weight). Where the number is odd
/// each new one covers two and a bit of the old ones.
template <class Add>
void for_each_share(int from, Add add) {
    const int to = std::max(from / 2, 1);
    const double share = static_cast<double>(from) / to;
    for (int t = 0; t < to; ++t) {
        const double begin = t * share;
        const double end = begin + share;
        const int last = std::min(static_cast<int>(std::ceil(end)), from);
        for (int f = static_cast<int>(begin); f < last; ++f) {
            const double part = std::min(end, f + 1.0) - std::max(begin, static_cast<double>(f));
            add(static_cast<std::size_t>(t), static_cast<std::size_t>(f), static_cast<float>(part / share));
        }
    }
}

/// Half as many blocks of `block` values in each of `rows` rows of `count` blocks.
std::vector<float> halved(const std::vector<float>& values, std::size_t rows, int count, std::size_t block) {
    const auto half = static_cast<std::size_t>(std::max(count / 2, 1));
    std::vector<float> result(rows * half * block, 0.0F);
    for (std::size_t row = 0; row < rows; ++row) {
        float* const to = result.data() + row * half * block;
        const float* const from = values.data() + row * static_cast<std::size_t>(count) * block;
        for_each_share(count, [&](std::size_t t, std::size_t f, float weight) {
            for (std::size_t i = 0; i < block; ++i) {
                to[t * block + i] += weight * from[f * block + i];
            }
        });
    }
    return result;
}

Grid halved(const Grid& from) {
    const auto channels = static_cast<std::size_t>(from.channels);
    Grid to{std::max(from.width / 2, 1), std::max(from.height / 2, 1), from.channels, {}};
    to.values = halved(from.values, static_cast<std::size_t>(from.height), from.width, channels);
    to.values = halved(to.values, 1, from.height, static_cast<std::size_t>(to.width) * channels);
    return to;
}

Image image_of(const Grid& grid, PixelFormat format) {
    Image image = make_image(grid.width, grid.height, format);
    const float* value = grid.values.data();
    for (int y = 0; y < grid.height; ++y) {
        for (int x = 0; x < grid.width; ++x) {
            for (int c = 0; c < grid.channels; ++c) {
                image.set(x, y, c, *value++);
            }
        }
    }
    return image;
}

}  // namespace

std::vector<Image> image_levels(Image picture) {
    Grid grid{picture.width, picture.height, picture.channels(), to_floats(picture)};
    const PixelFormat format = picture.format;
    std::vector<Image> levels;
    levels.push_back(std::move(picture));
    while (grid.width > 1 || grid.height > 1) {
        grid = halved(grid);
        levels.push_back(image_of(grid, format));
    }
    return levels;
}

}  // namespace viscera
