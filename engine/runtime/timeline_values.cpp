#include "engine/runtime/timeline_values.h"

#include <algorithm>
#include <cmath>

#include "engine/io/mesh.h"

namespace viscera {
namespace {

std::vector<float> numbers_of(const TimelineKey& key, Log& log) {
    std::vector<float> numbers;
    if (key.mesh.empty()) {
        numbers.reserve(key.values.size());
        std::ranges::transform(key.values, std::back_inserter(numbers),
                               [](double x) { return static_cast<float>(x); });
        return numbers;
    }
    const MeshData mesh = io::merge(io::load_meshes(key.mesh.path, {}, log));
    numbers.reserve(3 * mesh.positions.size());
    for (const glm::vec3& position : mesh.positions) {
        const glm::vec3 p(glm::dvec3(position) + key.move_mm);
        numbers.insert(numbers.end(), {p.x, p.y, p.z});
    }
    return numbers;
}

}  // namespace

void TimelineValues::read(std::size_t track, Log& log) {
    if (!numbers_[track].empty()) {
        return;
    }
    std::vector<std::vector<float>> numbers;
    for (const TimelineKey& key : tracks_[track].keys) {
        numbers.push_back(numbers_of(key, log));
    }
    numbers_[track] = std::move(numbers);
}

const HostValues& TimelineValues::at(double time_s, Log& log) {
    numbers_.resize(tracks_.size());
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        const TimelineTrack& track = tracks_[i];
        const std::optional<TimelinePlace> place = place_at(track, time_s);
        if (!place) {
            values_.erase(track.value);
            continue;
        }
        read(i, log);
        const std::vector<float>& before = numbers_[i][place->before];
        const std::vector<float>& after = numbers_[i][place->after];
        if (before.empty()) {
            values_.erase(track.value);
        } else if (place->share == 0.0 || before.size() != after.size()) {
            values_.set(track.value, before);
        } else {
            mixed_.resize(before.size());
            std::ranges::transform(before, after, mixed_.begin(), [&](float a, float b) {
                return static_cast<float>(std::lerp(double{a}, double{b}, place->share));
            });
            values_.set(track.value, mixed_);
        }
    }
    return values_;
}

}  // namespace viscera
