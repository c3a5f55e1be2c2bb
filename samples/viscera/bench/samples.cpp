#include "samples/viscera/bench/samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace viscera::app {
namespace {

Spread spread_of(const Samples& samples, double Sample::*what) {
    std::vector<double> values(samples.size());
    std::ranges::transform(samples, values.begin(), [what](const Sample& s) { return s.*what; });
    return spread(std::move(values));
}

}  // namespace

Spread spread(std::vector<double> values) {
    if (values.empty()) {
        return {};
    }
    std::ranges::sort(values);
    const auto at = [&](double share) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(place);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return std::lerp(values[below], values[above], place - static_cast<double>(below));
    };
    return {at(0.25), at(0.5), at(0.75)};
}

Spread times(const Samples& samples) {
    return spread_of(samples, &Sample::time_ms);
}
Spread works(const Samples& samples) {
    return spread_of(samples, &Sample::work_ms);
}

double ratio(const Samples& samples, const Samples& base, double Sample::*what) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(samples.size(), base.size()); ++i) {
        if (base[i].*what > 0.0) {
            ratios.push_back(samples[i].*what / (base[i].*what));
        }
    }
    return ratios.empty() ? std::numeric_limits<double>::quiet_NaN() : spread(std::move(ratios)).median;
}

Samples operator+(const Samples& a, const Samples& b) {
    Samples sum(std::min(a.size(), b.size()));
    for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] = {a[i].time_ms + b[i].time_ms, a[i].work_ms + b[i].work_ms};
    }
    return sum;
}

Samples means(const Samples& samples, std::size_t count, double parts) {
    Samples result(samples.size() / count);
    for (std::size_t i = 0; i < result.size() * count; ++i) {
        result[i / count].time_ms += samples[i].time_ms / parts;
        result[i / count].work_ms += samples[i].work_ms / parts;
    }
    return result;
}

}  // namespace viscera::app
