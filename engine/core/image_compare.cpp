#include "engine/core/image_compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "engine/core/error.h"

namespace viscera {
namespace {

bool is_whole(const Image& image) {
    return image.width >= 0 && image.height >= 0 &&
           image.data.size() == static_cast<std::size_t>(image.width) *
                                    static_cast<std::size_t>(image.height) * bytes_per_pixel(image.format);
}

std::string shape_text(const Image& image) {
    return std::to_string(image.width) + "x" + std::to_string(image.height) + " with " +
           std::to_string(image.channels()) + " channels";
}

/// Why the pictures cannot be compared; empty when they can.
std::string mismatch(const Image& a, const Image& b) {
    if (!is_whole(a) || !is_whole(b)) {
        return "an image's data does not fit its size";
    }
    if (a.width != b.width || a.height != b.height || a.channels() != b.channels()) {
        return "images differ in shape: " + shape_text(a) + " and " + shape_text(b);
    }
    return a.empty() ? "images are empty: there is nothing to compare" : "";
}

/// Values of two pictures of one shape.
struct Pair {
    Pair(const Image& first, const Image& second)
        : a(to_floats(first)),
          b(to_floats(second)),
          width(static_cast<std::size_t>(first.width)),
          channels(static_cast<std::size_t>(first.channels())) {}

    [[nodiscard]] std::size_t pixels() const { return a.size() / channels; }
    [[nodiscard]] bool finite(std::size_t i) const { return std::isfinite(a[i]) && std::isfinite(b[i]); }
    [[nodiscard]] double difference(std::size_t i) const {
        return std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    }
    /// Largest difference of a pixel's channels; NaN when a value is not finite.
    [[nodiscard]] double difference_of_pixel(std::size_t pixel) const {
        double largest = 0.0;
        for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
            if (!finite(i)) {
                return std::numeric_limits<double>::quiet_NaN();
            }
            largest = std::max(largest, difference(i));
        }
        return largest;
    }

    std::vector<float> a;
    std::vector<float> b;
    std::size_t width;
    std::size_t channels;
};

void note_worst(CompareResult& result, const Pair& pair, std::size_t i) {
    result.max = pair.difference(i);
    const std::size_t pixel = i / pair.channels;
    result.worst_x = static_cast<int>(pixel % pair.width);
    result.worst_y = static_cast<int>(pixel / pair.width);
    result.worst_channel = static_cast<int>(i % pair.channels);
}

void measure(CompareResult& result, const Pair& pair, double limit) {
    double sum = 0.0;
    double sum_of_squares = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pair.a.size(); ++i) {
        for (const float value : {pair.a[i], pair.b[i]}) {
            result.nan += std::isnan(value) ? 1 : 0;
            result.inf += std::isinf(value) ? 1 : 0;
        }
        if (!pair.finite(i)) {
            continue;
        }
        const double difference = pair.difference(i);
        if (difference > result.max) {
            note_worst(result, pair, i);
        }
        sum += difference;
        sum_of_squares += difference * difference;
        ++count;
    }
    std::size_t over = 0;
    for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
        over += pair.difference_of_pixel(pixel) <= limit ? 0 : 1;  // NaN counts as over
    }
    const double n = static_cast<double>(std::max<std::size_t>(count, 1));
    result.mean = sum / n;
    result.rms = std::sqrt(sum_of_squares / n);
    result.psnr_db =
        result.rms > 0.0 ? -20.0 * std::log10(result.rms) : std::numeric_limits<double>::infinity();
    result.fraction = static_cast<double>(over) / static_cast<double>(pair.pixels());
}

std::string verdict(const CompareResult& result, const CompareLimits& limits) {
    std::ostringstream text;
    // Written so that a limit that is NaN lets nothing pass.
    if (result.nan + result.inf > 0) {
        text << result.nan << " values are NaN and " << result.inf << " infinite";
    } else if (!(result.fraction <= limits.fraction)) {
        text << "largest difference " << result.max << " at pixel (" << result.worst_x << ", "
             << result.worst_y << ") channel " << result.worst_channel << "; a share of " << result.fraction
             << " of the pixels is over " << limits.max << ", allowed is " << limits.fraction;
    } else if (!(result.mean <= limits.mean)) {
        text << "mean difference " << result.mean << " is over " << limits.mean;
    }
    return text.str();
}

unsigned char to_byte(double value) {
    return static_cast<unsigned char>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

std::array<unsigned char, 4> heat(double share) {
    // Any difference at all is to be told from none.
    const double red = share > 0.0 ? std::max(3.0 * share, 1.0 / 255.0) : 0.0;
    return {to_byte(red), to_byte(3.0 * share - 1.0), to_byte(3.0 * share - 2.0), 255};
}

}  // namespace

CompareResult compare(const Image& a, const Image& b, const CompareLimits& limits) {
    CompareResult result;
    result.reason = mismatch(a, b);
    if (result.reason.empty()) {
        measure(result, Pair(a, b), limits.max);
        result.reason = verdict(result, limits);
    }
    result.equal = result.reason.empty();
    return result;
}

Image heatmap(const Image& a, const Image& b, double scale) {
    if (std::string reason = mismatch(a, b); !reason.empty()) {
        throw Error(ErrorCode::usage, "heatmap", reason);
    }
    const Pair pair(a, b);
    std::vector<double> differences(pair.pixels());
    double largest = 0.0;
    for (std::size_t pixel = 0; pixel < differences.size(); ++pixel) {
        differences[pixel] = pair.difference_of_pixel(pixel);
        largest = std::fmax(largest, differences[pixel]);
    }
    const double white = scale > 0.0 ? scale : largest;
    Image map = make_image(a.width, a.height, PixelFormat::rgba8);
    auto out = map.data.begin();
    for (const double difference : differences) {
        const bool finite = std::isfinite(difference);
        const auto colour = finite ? heat(difference > 0.0 ? difference / white : 0.0)
                                   : std::array<unsigned char, 4>{255, 0, 255, 255};
        out = std::ranges::transform(colour, out, [](unsigned char c) { return std::byte{c}; }).out;
    }
    return map;
}

}  // namespace viscera
