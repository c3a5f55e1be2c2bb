#include "effects/tissue/energy_queries.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/pixel_index.h"
#include "engine/runtime/renderer.h"

namespace viscera::tissue {
namespace {

float distance2_to_box(const glm::vec3& p, const glm::vec3& low, const glm::vec3& high) {
    const glm::vec3 outside = glm::max(glm::max(low - p, p - high), 0.0F);
    return glm::dot(outside, outside);
}

}  // namespace

EnergyQueries::EnergyQueries(EnergyTargets names)
    : names_{std::move(names.energy), std::move(names.position), std::move(names.metric)} {}

std::vector<std::string> EnergyQueries::targets(const EnergyTargets& names) {
    return {names.energy, names.position, names.metric};
}

bool EnergyQueries::update(Renderer& renderer, std::optional<std::uint64_t> most_frames_behind) {
    if (most_frames_behind) {
        renderer.wait_for_watched(*most_frames_behind);
    }
    std::array<const WatchedTarget*, 3> copies{};
    for (std::size_t i = 0; i < names_.size(); ++i) {
        copies[i] = renderer.watched(names_[i]);
        if (copies[i] == nullptr) {
            forget();
            return false;
        }
    }
    try {
        take(copies);
    } catch (...) {
        forget();
        throw;
    }
    return true;
}

void EnergyQueries::take(const std::array<const WatchedTarget*, 3>& copies) {
    const auto [energy, position, metric] = copies;
    if (versions_[1] != position->version || versions_[2] != metric->version) {
        take_surface(position->image, metric->image);
    }
    if (versions_[0] != energy->version || energies_.empty()) {
        take_energy(energy->image);
    }
    versions_ = {energy->version, position->version, metric->version};
    const WatchedTarget& oldest = **std::ranges::max_element(copies, {}, &WatchedTarget::frames_behind);
    frames_behind_ = oldest.frames_behind;
    time_s_ = oldest.time_s;
}

void EnergyQueries::forget() {
    energies_.clear();
    versions_ = {};
    frames_behind_ = 0;
    time_s_ = 0.0;
}

void EnergyQueries::take_surface(const Image& position, const Image& metric) {
    if (position.width != metric.width || position.height != metric.height || position.channels() != 4 ||
        metric.channels() != 4) {
        throw Error(ErrorCode::usage, "energy queries",
                    "position and metric must have 4 channels and one size");
    }
    width_ = position.width;
    height_ = position.height;
    tiles_x_ = (width_ + tile_texels - 1) / tile_texels;
    const int tiles_y = (height_ + tile_texels - 1) / tile_texels;
    places_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    areas_.resize(places_.size());
    boxes_.assign(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y), Box{});
    if (energies_.size() != places_.size()) {
        energies_.clear();
    }
    for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
            const glm::vec4 place(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2),
                                  position.at(x, y, 3));
            places_[index(x, y)] = place;
            areas_[index(x, y)] = place.w == 1.0F ? metric.at(x, y, 3) : 0.0F;
            if (place.w == 1.0F) {
                Box& box = boxes_[pixel_index(x / tile_texels, y / tile_texels, tiles_x_)];
                box.low = glm::min(box.low, glm::vec3(place));
                box.high = glm::max(box.high, glm::vec3(place));
            }
        }
    }
}

void EnergyQueries::take_energy(const Image& energy) {
    if (energy.width != width_ || energy.height != height_ || energy.channels() != 1) {
        throw Error(ErrorCode::usage, "energy queries",
                    "the energy must have 1 channel and the surface's size");
    }
    energies_.resize(places_.size());
    for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
            energies_[index(x, y)] = energy.at(x, y, 0);
        }
    }
}

std::optional<double> EnergyQueries::energy_at(const glm::dvec2& uv) const {
    // Written so that NaN is refused.
    if (energies_.empty() || !(uv.x >= 0.0 && uv.x <= 1.0 && uv.y >= 0.0 && uv.y <= 1.0)) {
        return std::nullopt;
    }
    const glm::dvec2 at = uv * glm::dvec2(width_, height_);
    const auto clamped = [](double value, int count) {
        return std::clamp(static_cast<int>(value), 0, count - 1);
    };
    if (places_[index(clamped(at.x, width_), clamped(at.y, height_))].w != 1.0F) {
        return std::nullopt;
    }
    const glm::dvec2 corner = glm::floor(at - 0.5);
    const glm::dvec2 weight = at - 0.5 - corner;
    const auto texel = [&](int x, int y) {
        return static_cast<double>(
            energies_[index(std::clamp(x, 0, width_ - 1), std::clamp(y, 0, height_ - 1))]);
    };
    const int x = static_cast<int>(corner.x);
    const int y = static_cast<int>(corner.y);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), weight.x),
                    glm::mix(texel(x, y + 1), texel(x + 1, y + 1), weight.x), weight.y);
}

void EnergyQueries::nearest_in_tile(std::size_t tile, const glm::vec3& point, float& least,
                                    std::size_t& texel) const {
    const int x0 = static_cast<int>(tile) % tiles_x_ * tile_texels;
    const int y0 = static_cast<int>(tile) / tiles_x_ * tile_texels;
    for (int y = y0; y < std::min(y0 + tile_texels, height_); ++y) {
        for (int x = x0; x < std::min(x0 + tile_texels, width_); ++x) {
            const glm::vec4& place = places_[index(x, y)];
            const glm::vec3 way = glm::vec3(place) - point;
            const float d2 = glm::dot(way, way);
            if (place.w == 1.0F && d2 <= least) {
                least = d2;
                texel = index(x, y);
            }
        }
    }
}

std::optional<double> EnergyQueries::energy_at(const glm::dvec3& point_mm, double within_mm) const {
    if (energies_.empty() || !(within_mm >= 0.0)) {
        return std::nullopt;
    }
    const glm::vec3 point(point_mm);
    const auto none = places_.size();
    std::size_t texel = none;
    auto least = static_cast<float>(within_mm * within_mm);
    // The tile whose box is nearest first: it rules out most of the others.
    std::size_t first = 0;
    float nearest = std::numeric_limits<float>::max();
    for (std::size_t t = 0; t < boxes_.size(); ++t) {
        const float d2 = distance2_to_box(point, boxes_[t].low, boxes_[t].high);
        if (d2 < nearest) {
            nearest = d2;
            first = t;
        }
    }
    nearest_in_tile(first, point, least, texel);
    for (std::size_t t = 0; t < boxes_.size(); ++t) {
        if (t != first && distance2_to_box(point, boxes_[t].low, boxes_[t].high) <= least) {
            nearest_in_tile(t, point, least, texel);
        }
    }
    return texel == none ? std::nullopt : std::optional(static_cast<double>(energies_[texel]));
}

template <class Counts>
double EnergyQueries::area(Counts counts) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < energies_.size(); ++i) {
        sum += counts(energies_[i]) ? static_cast<double>(areas_[i]) : 0.0;
    }
    return sum;
}

double EnergyQueries::coagulated_area(double threshold) const {
    return area([&](float e) { return e > 0.0F && static_cast<double>(e) >= threshold; });
}

double EnergyQueries::dissected_area() const {
    return area([](float e) { return e < 0.0F; });
}

}  // namespace viscera::tissue
