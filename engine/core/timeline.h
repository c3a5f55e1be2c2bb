#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/params.h"

namespace viscera {

/// What a track is between two of its keys. `linear`: straight between keys of one length, otherwise as
/// `hold`.
enum class Interpolation { hold, linear };
[[nodiscard]] std::span<const std::string_view> choice_names(Interpolation interpolation);

/// What a host value is from a time on: numbers, or the vertices of a mesh file.
struct TimelineKey {
    double time_s = 0.0;
    std::vector<double> values;  ///< none, and no mesh: there is no such value from here on
    AssetPath mesh;              ///< its positions [mm], three numbers a vertex, stand for `values`
    glm::dvec3 move_mm{0.0};     ///< added to the mesh's positions

    void visit(ParamVisitor& v);
};

/// One host value of a scene as time passes, for whoever has no host: before the first key there is no such
/// value, after the last it stays.
struct TimelineTrack {
    std::string value;  ///< name of the host value: "tissue.contacts"
    Interpolation interpolation = Interpolation::linear;
    double period_s = 0.0;          ///< > 0: repeats the time from 0 to here for ever
    std::vector<TimelineKey> keys;  ///< in the order of their times

    void visit(ParamVisitor& v);
    /// What single ranges cannot say, as a message; empty: nothing is wrong.
    [[nodiscard]] std::string fault() const;
};

/// Which keys make up a track at a time: (1 - share) of `before` and `share` of `after`.
struct TimelinePlace {
    std::size_t before = 0;
    std::size_t after = 0;
    double share = 0.0;  ///< [0, 1)
    bool operator==(const TimelinePlace&) const = default;
};
/// None before the first key. time_s: finite.
[[nodiscard]] std::optional<TimelinePlace> place_at(const TimelineTrack& track, double time_s);

}  // namespace viscera
