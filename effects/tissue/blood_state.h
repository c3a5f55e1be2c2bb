#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "effects/tissue/blood_gpu.h"
#include "effects/tissue/blood_sources.h"
#include "effects/tissue/jets.h"
#include "engine/runtime/assets.h"

namespace viscera::tissue {

/// Which places of the ring of drops may hold one that lives. Drops die at a known age, so this needs no
/// answer from the GPU.
class DropRing {
  public:
    /// `longest_steps`: the age at which no drop is left; drops before are forgotten.
    void begin(std::int64_t step, std::int64_t longest_steps);
    /// Time has come to a step.
    void pass_to(std::int64_t step);
    /// Makes room for new drops; returns the oldest ones that must leave for them.
    DropRange add(std::int64_t count, std::int64_t capacity);
    /// The GPU has told that none is left.
    void forget() { first_ = head_; }
    [[nodiscard]] DropRange alive() const { return {first_, head_ - first_}; }
    [[nodiscard]] std::int64_t head() const { return head_; }

  private:
    static constexpr std::int64_t bins = 512;
    std::array<std::int64_t, bins> head_at_bin_{};  ///< when each bin of time began
    std::int64_t bin_ = 0;
    std::int64_t first_bin_ = 0;
    std::int64_t bin_steps_ = 1;
    std::int64_t head_ = 0;
    std::int64_t first_ = 0;
};

/// Blood that goes on from frame to frame, known by its name.
struct BloodState {
    std::unique_ptr<BloodGpu> gpu;
    bool begun = false;
    bool bled = false;           ///< blood is or was somewhere
    bool moving = false;         ///< something may change without a source
    std::int64_t step = 0;       ///< the next one, on the grid of times
    std::int64_t steps_run = 0;  ///< drops age by these: gaps between frames do not count
    double steps_per_s = 0.0;
    std::uint64_t version = 0;  ///< of what it shows
    std::uint64_t shown_version =
        0;                        ///< of what was shown last: changes count from there; 0: unlike all before
    std::uint64_t shape_key = 0;  ///< of the mesh, the size and the number of drops
    bool surface_ends = false;    ///< the mesh has edges with nothing beyond
    std::uint64_t gpu_shape_key = 0;  ///< the same, of what `gpu` was made for
    std::uint64_t surface_key = 0;
    std::uint64_t seam_key = 0;
    std::uint64_t looks = 0;         ///< at the tiles
    std::uint64_t disturbed_at = 0;  ///< the look before which answers are too old
    std::int64_t looked_at = 0;      ///< step of the last look
    std::int64_t looked_run = 0;     ///< the same, counted as `steps_run`
    std::size_t tool_count = 0;
    DropRing ring;
    std::vector<DropMeter> meters;
    ExpectedDrops expected;  ///< at the last look
    std::uint32_t seed = 0;
    Jets jets;
    bool jets_bleed = false;  ///< a wound sends out a jet in this frame

    /// The state of a name, made when it is first asked for.
    [[nodiscard]] static std::shared_ptr<BloodState> find(Assets& assets, std::string_view name);
    /// Empty, at a step.
    void begin_anew(std::int64_t at, double rate, double drop_life_s);
};

}  // namespace viscera::tissue
