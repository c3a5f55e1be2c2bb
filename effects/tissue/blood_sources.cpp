#include "effects/tissue/blood_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "engine/core/finite.h"
#include "engine/core/log.h"

namespace viscera::tissue {
namespace {

// More drops than this from one wound in one step become larger ones instead.
constexpr int most_drops_per_step = 8;
// Smaller ones have squares that floats do not hold.
constexpr double smallest_tool_mm = 1e-6;
// More than any film's thickness.
constexpr double most_sucked_mm = 1e6;

/// The host's array in records of a length; what does not fit is a fault.
template <class Take>
void each_record(const HostValues* values, std::string_view name, std::size_t length, Log& log, Take take) {
    const HostValues::Entry* given = values == nullptr || name.empty() ? nullptr : values->find(name);
    if (given == nullptr) {
        return;
    }
    const std::span<const float> all(given->values);
    if (all.size() % length != 0) {
        log.fault("tissue.host_records", "host values '" + std::string(name) + "' are no multiple of " +
                                             std::to_string(length) + " floats; the rest is left out");
    }
    for (std::size_t i = 0; i + length <= all.size(); i += length) {
        take(all.subspan(i, length));
    }
}

bool usable(const WoundParams& w, Log& log) {
    if (finite(w.position_mm) && finite(w.direction) && finite(w.radius_mm) && finite(w.rate_mm3_s) &&
        finite(w.speed_mm_s) && finite(w.pulse_hz) && finite(w.pulse_depth)) {
        return true;
    }
    log.fault("tissue.wound_not_finite", "a wound has a value that is not finite; it does not bleed");
    return false;
}

bool usable(const CleanerParams& t, Log& log) {
    if (finite(t.position_mm) && finite(t.radius_mm) && t.radius_mm >= smallest_tool_mm && finite(t.rate)) {
        return true;
    }
    log.fault("tissue.tool_not_finite",
              "a tool has a value that is not finite, or a radius below 1e-6 mm; it does nothing");
    return false;
}

}  // namespace

void collect_wounds(const BloodParams& params, const HostValues* values, Log& log,
                    std::vector<WoundParams>& wounds) {
    wounds.clear();
    const auto add = [&](const WoundParams& wound) {
        if (!usable(wound, log)) {
            return;
        }
        if (wounds.size() >= most_wounds) {
            log.fault("tissue.too_many_wounds", "more than 65536 wounds; the others do not bleed");
            return;
        }
        wounds.push_back(wound);
        const double length = glm::length(wound.direction);
        if (wound.kind == BleedingKind::jet && !(length > 0.0 && finite(length))) {
            log.fault("tissue.jet_no_direction",
                      "a jet's direction has no length; its blood wells up instead");
            wounds.back().kind = BleedingKind::ooze;
        }
    };
    for (const WoundParams& wound : params.wounds) {
        add(wound);
    }
    each_record(values, params.host_emitters, floats_per_wound, log, [&](std::span<const float> v) {
        add({.position_mm = {v[0], v[1], v[2]},
             .radius_mm = std::max(v[3], 0.0F),
             .rate_mm3_s = std::clamp(v[4], 0.0F, 1.0e7F),
             .kind = v[5] >= 0.5F ? BleedingKind::jet : BleedingKind::ooze,
             .direction = {v[6], v[7], v[8]},
             .speed_mm_s = std::clamp(v[9], 0.0F, 1.0e5F),
             .pulse_hz = std::clamp(v[10], 0.0F, 10.0F),
             .pulse_depth = std::clamp(v[11], 0.0F, 1.0F)});
    });
}

void collect_tools(const BloodParams& params, const HostValues* values, Log& log,
                   std::vector<CleanerParams>& tools) {
    tools.clear();
    const auto add = [&](const CleanerParams& tool) {
        if (!usable(tool, log)) {
            return;
        }
        if (tools.size() >= most_tools) {
            log.fault("tissue.too_many_tools", "more than 16 tools; the others do nothing");
            return;
        }
        tools.push_back(tool);
    };
    for (const CleanerParams& tool : params.tools) {
        add(tool);
    }
    const auto take = [&](CleanerKind kind) {
        return [&add, kind](std::span<const float> v) {
            add({.kind = kind,
                 .position_mm = {v[0], v[1], v[2]},
                 .radius_mm = v[3],
                 .rate = std::max(v[4], 0.0F)});
        };
    };
    each_record(values, params.host_suction, floats_per_tool, log, take(CleanerKind::suction));
    each_record(values, params.host_rinse, floats_per_tool, log, take(CleanerKind::rinse));
}

double pulse_of(const WoundParams& wound, double time_s) {
    if (wound.kind == BleedingKind::ooze || wound.pulse_hz <= 0.0) {
        return 1.0;
    }
    return 1.0 + wound.pulse_depth * std::sin(2.0 * std::numbers::pi * wound.pulse_hz * time_s);
}

glm::vec2 tool_power(const CleanerParams& tool, double dt_s) {
    if (tool.kind == CleanerKind::rinse) {
        return {0.0F, static_cast<float>(-std::expm1(-tool.rate * dt_s))};
    }
    // The shader's profile 1 - d^2/r^2 has the volume pi r^2 / 2 per unit of height.
    const double volume = std::numbers::pi / 2.0 * tool.radius_mm * tool.radius_mm;
    return {static_cast<float>(std::min(tool.rate * dt_s / volume, most_sucked_mm)), 0.0F};
}

double DropMeter::drop_volume(double volume_mm3, double drop_mm3) {
    return std::max(drop_mm3, volume_mm3 / most_drops_per_step);
}

DropMeter::Drops DropMeter::flow(double volume_mm3, double drop_mm3) {
    held_mm3_ += volume_mm3;
    const double volume = drop_volume(volume_mm3, drop_mm3);
    const int count = std::clamp(static_cast<int>(held_mm3_ / volume), 0, most_drops_per_step + 1);
    held_mm3_ -= count * volume;
    return {count, volume};
}

void ExpectedDrops::begin(double drop_aspect) {
    aspect_ = drop_aspect;
    by_wound_.clear();
    places_.clear();
}

double ExpectedDrops::reach_mm(double radius_mm, double drop_mm3) const {
    return radius_mm + std::cbrt(drop_mm3 * 2.0 / (std::numbers::pi * aspect_));
}

void ExpectedDrops::add(std::size_t wound, const glm::vec2& uv, double radius_mm, double drop_mm3) {
    by_wound_.resize(std::max(by_wound_.size(), wound + 1));
    const double reach = reach_mm(radius_mm, drop_mm3);
    by_wound_[wound] = {uv, reach};
    places_.emplace_back(uv, static_cast<float>(0.5 * std::numbers::pi * aspect_ * reach * reach * reach),
                         static_cast<float>(radius_mm));
}

bool ExpectedDrops::covers(std::size_t wound, const glm::vec2& uv, double radius_mm, double drop_mm3) const {
    return wound < by_wound_.size() && by_wound_[wound].uv == uv &&
           by_wound_[wound].reach_mm >= reach_mm(radius_mm, drop_mm3);
}

}  // namespace viscera::tissue
