#pragma once

#include <vector>

#include "engine/core/log.h"
#include "engine/core/timeline.h"
#include "engine/runtime/frame.h"

namespace viscera {

/// Plays the timeline of a scene into host values. Mesh files are read when their track is first played.
class TimelineValues {
  public:
    TimelineValues() = default;
    explicit TimelineValues(std::vector<TimelineTrack> tracks) : tracks_(std::move(tracks)) {}

    [[nodiscard]] bool empty() const { return tracks_.empty(); }
    /// What all tracks are at a time. Valid until the next call. Throws Error(file) for a mesh that cannot be
    /// read. Once every length has occurred, allocates nothing.
    [[nodiscard]] const HostValues& at(double time_s, Log& log);

  private:
    void read(std::size_t track, Log& log);

    std::vector<TimelineTrack> tracks_;
    std::vector<std::vector<std::vector<float>>> numbers_;  ///< by track and key; empty until it is played
    std::vector<float> mixed_;
    HostValues values_;
};

}  // namespace viscera
