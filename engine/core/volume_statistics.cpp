#include <algorithm>
#include <cstring>
#include <limits>
#include <tuple>

#include "engine/core/log.h"
#include "engine/core/volume.h"

namespace viscera {

namespace {

/// One channel's voxels as they are stored.
template <class T, class Each>
void for_each(const Volume& volume, int channel, const Each& each) {
    const std::size_t step = static_cast<std::size_t>(volume.channels) * sizeof(T);
    for (std::size_t at = static_cast<std::size_t>(channel) * sizeof(T); at < volume.voxels.size();
         at += step) {
        T value{};
        std::memcpy(&value, volume.voxels.data() + at, sizeof value);
        each(value);
    }
}

/// Counts finite values into equal bins once their range is known.
class Binner {
  public:
    Binner(VolumeStatistics& result, int bins)
        : result_(result), scale_(static_cast<double>(bins) / (result.max - result.min)) {
        result_.histogram.assign(static_cast<std::size_t>(bins), 0);
    }
    void add(double value, std::size_t count) {
        const double bin = (value - result_.min) * scale_;
        // A constant volume has no width: its scale is infinite, and 0 times that no number.
        const std::size_t last = result_.histogram.size() - 1;
        const std::size_t place = bin >= 0.0 ? static_cast<std::size_t>(std::min(bin, 1e9)) : 0;
        result_.histogram[std::min(place, last)] += count;
    }

  private:
    VolumeStatistics& result_;
    double scale_;
};

/// Few distinct numbers: count each of them, and take everything from the counts.
template <class T>
VolumeStatistics of_integers(const Volume& volume, int channel, int bins) {
    constexpr int lowest = std::numeric_limits<T>::lowest();
    std::vector<std::size_t> counts(std::size_t{1} << (8 * sizeof(T)), 0);
    for_each<T>(volume, channel, [&](T value) { ++counts[static_cast<std::size_t>(value - lowest)]; });

    VolumeStatistics result;
    const auto is_taken = [](std::size_t count) { return count > 0; };
    const auto first = std::ranges::find_if(counts, is_taken) - counts.begin();
    const auto last = counts.rend() - std::find_if(counts.rbegin(), counts.rend(), is_taken) - 1;
    if (last < 0) {
        return result;
    }
    const auto value_at = [&](std::ptrdiff_t n) { return volume.value_of(static_cast<double>(n + lowest)); };
    std::tie(result.min, result.max) = std::minmax({value_at(first), value_at(last)});
    Binner binner(result, bins);
    double sum = 0.0;
    double total = 0.0;
    for (std::ptrdiff_t n = first; n <= last; ++n) {
        const std::size_t count = counts[static_cast<std::size_t>(n)];
        binner.add(value_at(n), count);
        sum += value_at(n) * static_cast<double>(count);
        total += static_cast<double>(count);
    }
    result.mean = sum / total;
    return result;
}

VolumeStatistics of_floats(const Volume& volume, int channel, int bins) {
    VolumeStatistics result;
    float low = std::numeric_limits<float>::max();
    float high = std::numeric_limits<float>::lowest();
    double sum = 0.0;
    std::size_t finite = 0;
    for_each<float>(volume, channel, [&](float value) {
        if (is_number(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
            sum += static_cast<double>(value);
            ++finite;
        } else {
            ++result.non_finite;
        }
    });
    if (finite > 0) {
        std::tie(result.min, result.max) = std::minmax(
            {volume.value_of(static_cast<double>(low)), volume.value_of(static_cast<double>(high))});
        result.mean = volume.value_of(sum / static_cast<double>(finite));
    }
    Binner binner(result, bins);
    for_each<float>(volume, channel, [&](float value) {
        if (is_number(value)) {
            binner.add(volume.value_of(static_cast<double>(value)), 1);
        }
    });
    return result;
}

}  // namespace

void report_no_numbers(const Volume& volume, std::uint64_t count, Log& log) {
    if (count > 0) {
        log.fault("volume.non_finite",
                  volume.source + ": " + std::to_string(count) +
                      " voxels are NaN, infinite or beyond 1e36; they stay empty",
                  count);
    }
}

VolumeStatistics statistics(const Volume& volume, int channel, int bins) {
    bins = std::max(bins, 1);
    switch (volume.type) {
        case ScalarType::u8:
            return of_integers<std::uint8_t>(volume, channel, bins);
        case ScalarType::i8:
            return of_integers<std::int8_t>(volume, channel, bins);
        case ScalarType::u16:
            return of_integers<std::uint16_t>(volume, channel, bins);
        case ScalarType::i16:
            return of_integers<std::int16_t>(volume, channel, bins);
        case ScalarType::f32:
            break;
    }
    return of_floats(volume, channel, bins);
}

}  // namespace viscera
