#include "effects/volume/classification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace viscera::volume {
namespace {

using Knot = ExtinctionKnots::Knot;

/// A knot before it is rounded to float.
struct Place {
    double texel;
    glm::dvec4 value;
};

/// Knots inside the range, ascending, with one at each end of it.
std::vector<Place> clipped(const TransferFunction& function, const TexelMap& map, const TexelRange& range,
                           double resolution) {
    std::vector<Place> places;
    for (const TransferPoint& point : function.points) {
        double texel = map.texel_of(point.value);
        // A knot meant for an end must not end up beside it.
        for (const double end : {range.low, range.high}) {
            texel = std::abs(texel - end) <= resolution ? end : texel;
        }
        if (texel >= range.low && texel <= range.high) {
            places.push_back({texel, glm::dvec4(point.colour, point.opacity)});
        }
    }
    if (map.scale < 0.0) {
        std::ranges::reverse(places);
    }
    if (places.empty() || places.front().texel > range.low) {
        places.insert(places.begin(), {range.low, evaluate(function, map.value_of(range.low))});
    }
    if (places.back().texel < range.high) {
        places.push_back({range.high, evaluate(function, map.value_of(range.high))});
    }
    return places;
}

/// The straight line through two places.
glm::dvec4 on_line(const Place& a, const Place& b, double texel) {
    const double t = std::clamp((texel - a.texel) / (b.texel - a.texel), 0.0, 1.0);
    return a.value * (1.0 - t) + b.value * t;
}

/// Gives steps their width and joins knots too near to be told apart. The function stays what it is from 3
/// resolutions beside a step on.
std::vector<Place> with_steps(std::span<const Place> places, const TexelRange& range, double resolution,
                              bool right_side) {
    std::vector<Place> apart;
    const auto add = [&](double texel, const glm::dvec4& value) {
        if (texel >= range.low && texel <= range.high) {
            apart.push_back({texel, value});
        }
    };
    for (std::size_t first = 0; first < places.size();) {
        std::size_t last = first;
        while (last + 1 < places.size() && places[last + 1].texel - places[first].texel < resolution) {
            ++last;
        }
        const Place& before = places[first];
        const Place& after = places[last];
        const std::size_t next = last + 1;
        if (before.value == after.value) {
            apart.push_back(after);
        } else if (right_side) {
            const double begin = after.texel - 3.0 * resolution;
            add(begin, first > 0 ? on_line(places[first - 1], before, begin) : before.value);
            add(after.texel - resolution, after.value);
            add(after.texel, after.value);
        } else {
            const double end = before.texel + 3.0 * resolution;
            add(before.texel, before.value);
            add(before.texel + resolution, before.value);
            add(end, next < places.size() ? on_line(after, places[next], end) : after.value);
        }
        first = next;
    }
    return apart;
}

/// Rounds to float and keeps the knots apart and inside.
std::vector<Knot> rounded(std::span<const Place> places, const TexelRange& range, double resolution) {
    std::vector<Knot> knots;
    double least = range.low;
    for (const Place& place : places) {
        const double texel = std::max(place.texel, least);
        knots.push_back({static_cast<float>(texel), place.value});
        least = static_cast<double>(knots.back().texel) + resolution;
    }
    double most = range.high;
    for (std::size_t i = knots.size(); i-- > 0;) {
        if (static_cast<double>(knots[i].texel) <= most) {
            break;
        }
        knots[i].texel = static_cast<float>(most);
        most = static_cast<double>(knots[i].texel) - resolution;
    }
    return knots;
}

/// Leaves out what the straight line between its neighbours gives anyway.
std::vector<Place> simplified(std::span<const Place> places) {
    constexpr double exact = 1e-12;
    constexpr std::size_t longest = 64;  // keeps the search linear
    std::vector<Place> kept;
    for (std::size_t from = 0; from < places.size();) {
        kept.push_back(places[from]);
        const auto straight = [&](std::size_t end) {
            return std::all_of(places.begin() + static_cast<std::ptrdiff_t>(from),
                               places.begin() + static_cast<std::ptrdiff_t>(end), [&](const Place& place) {
                                   const glm::dvec4 miss = glm::abs(
                                       on_line(places[from], places[end], place.texel) - place.value);
                                   return std::max({miss.x, miss.y, miss.z, miss.w}) <= exact;
                               });
        };
        std::size_t to = from + 1;
        while (to + 1 < places.size() && to - from < longest && straight(to + 1)) {
            ++to;
        }
        from = to;
    }
    // Constant beyond the ends.
    while (kept.size() > 1 && kept[kept.size() - 2].value == kept.back().value) {
        kept.pop_back();
    }
    const auto varies =
        std::ranges::find_if(kept, [&](const Place& place) { return place.value != kept.front().value; });
    if (varies != kept.begin() && varies != kept.end()) {
        kept.erase(kept.begin(), std::prev(varies));
    }
    return kept;
}

float rounded_down(double value) {
    const auto nearest = static_cast<float>(value);
    return static_cast<double>(nearest) > value
               ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
               : nearest;
}

}  // namespace

double TexelRange::resolution() const {
    return std::max(std::max(std::abs(low), std::abs(high)) * 0x1p-23,
                    static_cast<double>(std::numeric_limits<float>::min()));
}

glm::dvec4 ExtinctionKnots::evaluate(double texel) const {
    if (std::isnan(texel)) {
        return glm::dvec4(0.0);
    }
    const auto after = std::ranges::upper_bound(
        knots, texel, {}, [](const Knot& knot) { return static_cast<double>(knot.texel); });
    if (after == knots.begin() || after == knots.end()) {
        return after == knots.end() ? knots.back().value : after->value;
    }
    const Knot& before = *std::prev(after);
    return on_line({static_cast<double>(before.texel), before.value},
                   {static_cast<double>(after->texel), after->value}, texel);
}

glm::dvec4 ExtinctionKnots::classify(double texel) const {
    const glm::dvec4 at = evaluate(texel);
    return {glm::dvec3(at), extinction(at.w, reference_length_mm)};
}

double ExtinctionKnots::most_extinction() const {
    double most = 0.0;
    for (const Knot& knot : knots) {
        most = std::max(most, knot.value.w);
    }
    return extinction(most, reference_length_mm);
}

ExtinctionKnots extinction_knots(const TransferFunction& function, const TexelMap& map,
                                 const TexelRange& range) {
    const double resolution = range.resolution();
    ExtinctionKnots result;
    result.reference_length_mm = function.reference_length_mm;
    if (!(range.high - range.low > 4.0 * resolution)) {
        result.knots = {{static_cast<float>(range.low), evaluate(function, map.value_of(range.low))}};
        return result;
    }
    const std::vector<Place> places = clipped(function, map, range, resolution);
    result.knots =
        rounded(simplified(with_steps(places, range, resolution, map.scale > 0.0)), range, resolution);
    return result;
}

glm::dvec4 ClassificationTable::mixed(double texel) const {
    const double last = static_cast<double>(entries.size() - 1);
    const double at = std::clamp(texel * place.x + place.y, 0.0, last);
    const auto low = static_cast<std::size_t>(at);
    const std::size_t high = std::min(low + 1, entries.size() - 1);
    return glm::mix(glm::dvec4(entries[low]), glm::dvec4(entries[high]), at - static_cast<double>(low));
}

std::size_t ClassificationTable::first_seen() const {
    const auto seen = [](const glm::vec4& entry) { return entry.a > 0.0F; };
    return static_cast<std::size_t>(std::ranges::find_if(entries, seen) - entries.begin());
}

ClassificationTable tabulate(const ExtinctionKnots& knots, const TexelRange& range, int entries) {
    const int count = std::max(entries, 2);
    const double width = range.high - range.low;
    ClassificationTable table;
    for (int i = 0; i < count; ++i) {
        const glm::dvec4 at = knots.classify(range.low + width * i / (count - 1));
        table.entries.emplace_back(at);
        table.premultiplied.emplace_back(glm::dvec4(glm::dvec3(at) * at.w, at.w));
    }
    if (width > 0.0) {
        table.place.x = (count - 1) / width;
        table.place.y = -range.low * table.place.x;
    }
    return table;
}

std::vector<StoredRange> stored_ranges(const TransferFunction& function, const TexelMap& map,
                                       const TexelRange& range, int entries) {
    const double entry = entries > 1 ? (range.high - range.low) / (entries - 1) : 0.0;
    const double more = entry + 4.0 * range.resolution();
    std::vector<ValueRange> visible = visible_ranges(function);
    for (ValueRange& values : visible) {
        values = {map.texel_of(values.low), map.texel_of(values.high)};
        if (map.scale < 0.0) {
            std::swap(values.low, values.high);
        }
    }
    if (map.scale < 0.0) {
        std::ranges::reverse(visible);
    }
    std::vector<StoredRange> stored;
    for (const ValueRange& values : visible) {
        const StoredRange wide{rounded_down(values.low - more), -rounded_down(-(values.high + more))};
        if (!stored.empty() && wide.low <= stored.back().high) {
            stored.back().high = std::max(stored.back().high, wide.high);
        } else {
            stored.push_back(wide);
        }
    }
    return stored;
}

std::vector<StoredRange> stored_ranges(const ClassificationTable& table, const TexelRange& range,
                                       const TexelMap& stored_of_texel) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const std::vector<glm::vec4>& entries = table.entries;
    const double entry = (range.high - range.low) / static_cast<double>(entries.size() - 1);
    // Filters and the place in the table are rounded.
    const double slack = 0.02 * entry + 8.0 * range.resolution();
    std::vector<StoredRange> stored;
    for (std::size_t i = 0; i < entries.size();) {
        if (!(entries[i].a > 0.0F)) {
            ++i;
            continue;
        }
        const auto first = static_cast<double>(i);
        while (i < entries.size() && entries[i].a > 0.0F) {
            ++i;
        }
        const double low = range.low + (first - 0.5) * entry - slack;
        const double high = range.low + (static_cast<double>(i) - 0.5) * entry + slack;
        stored.push_back({first == 0.0 ? -infinity : rounded_down(stored_of_texel.value_of(low)),
                          i == entries.size() ? infinity : -rounded_down(-stored_of_texel.value_of(high))});
    }
    return stored;
}

double opacity_of(double extinction_per_mm, double length_mm) {
    return -std::expm1(-extinction_per_mm * length_mm);
}

}  // namespace viscera::volume
