#include "engine/core/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace viscera {
namespace {

constexpr std::array<std::string_view, 2> interpolation_names{"hold", "linear"};

}  // namespace

std::span<const std::string_view> choice_names(Interpolation /*interpolation*/) {
    return interpolation_names;
}

void TimelineKey::visit(ParamVisitor& v) {
    constexpr double most = std::numeric_limits<float>::max();
    v.field({.name = "time_s", .doc = "From when on.", .unit = "s", .required = true}, time_s);
    v.field(
        {.name = "values", .doc = "The numbers; none: there is no such value.", .min = -most, .max = most},
        values);
    v.field({.name = "mesh",
             .doc = "Mesh whose vertices stand for the numbers, three a vertex: glTF, GLB, STL, OBJ, PLY or "
                    "VTP."},
            mesh);
    v.field({.name = "move_mm", .doc = "Moves the mesh.", .unit = "mm", .min = -1e9, .max = 1e9}, move_mm);
}

void TimelineTrack::visit(ParamVisitor& v) {
    v.field({.name = "value", .doc = "Name of the host value.", .required = true}, value);
    v.field({.name = "interpolation", .doc = "What the value is between keys."}, interpolation);
    v.field({.name = "period_s",
             .doc = "Repeats the time from 0 to here for ever; 0: does not repeat.",
             .unit = "s",
             .min = 0.0},
            period_s);
    v.field({.name = "keys", .doc = "What the value is, in the order of times.", .required = true}, keys);
}

std::string TimelineTrack::fault() const {
    if (value.empty()) {
        return "no value is named";
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const std::string key = "key " + std::to_string(i);
        if (!std::isfinite(keys[i].time_s)) {
            return key + " has no time";
        }
        if (i > 0 && !(keys[i].time_s > keys[i - 1].time_s)) {
            return key + " is not later than the one before";
        }
        if (!keys[i].values.empty() && !keys[i].mesh.empty()) {
            return key + " has values and a mesh, which exclude each other";
        }
        if (period_s > 0.0 && !(keys[i].time_s >= 0.0 && keys[i].time_s <= period_s)) {
            return key + " lies outside the period";
        }
    }
    return {};
}

std::optional<TimelinePlace> place_at(const TimelineTrack& track, double time_s) {
    const double time =
        track.period_s > 0.0 ? time_s - track.period_s * std::floor(time_s / track.period_s) : time_s;
    const auto after = std::ranges::upper_bound(track.keys, time, {}, &TimelineKey::time_s);
    if (after == track.keys.begin()) {
        return std::nullopt;
    }
    const auto before = std::prev(after);
    const auto index = [&](auto key) { return static_cast<std::size_t>(key - track.keys.begin()); };
    if (after == track.keys.end() || track.interpolation == Interpolation::hold) {
        return TimelinePlace{index(before), index(before), 0.0};
    }
    const double share = (time - before->time_s) / (after->time_s - before->time_s);
    return TimelinePlace{index(before), index(after), share};
}

}  // namespace viscera
