#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "effects/tissue/blood_gpu.h"
#include "effects/tissue/blood_sources.h"
#include "effects/tissue/drop_ring.h"
#include "effects/tissue/jets.h"
#include "engine/runtime/assets.h"

namespace viscera::tissue {

/// Blood that goes on from frame to frame, known by its name.
struct BloodState {
    std::unique_ptr<BloodGpu> gpu;
    bool begun = false;
    bool bled = false;    ///< blood is or was somewhere
    bool moving = false;  ///< something may change without a source
    bool woken = false;   ///< what rests is to be stepped again
    bool there = false;   ///< there is blood to show or to account for
    bool sealed = false;  ///< wounds would bleed if energy had not closed them all, and all else rests
    std::uint64_t source_key = 0;  ///< of the wounds that bled in the last steps, and of the energy
    std::uint64_t sealed_key = 0;  ///< the same, of which it is known that nothing comes
    std::uint64_t asked_look = 0;  ///< the last one about which the GPU was asked
    std::int64_t step = 0;         ///< the next one, on the grid of times
    double steps_per_s = 0.0;
    std::uint64_t version = 0;  ///< of what it shows
    std::uint64_t shown_version =
        0;                        ///< of what was shown last: changes count from there; 0: unlike all before
    std::uint64_t shape_key = 0;  ///< of the mesh, the size and the number of drops
    bool surface_ends = false;    ///< the mesh has edges with nothing beyond
    std::uint64_t gpu_shape_key = 0;  ///< the same, of what `gpu` was made for
    std::uint64_t surface_key = 0;
    std::uint64_t liquid_key = 0;
    std::uint64_t seam_key = 0;
    std::uint64_t looks = 0;         ///< at the tiles
    std::uint64_t disturbed_at = 0;  ///< the look before which answers are too old
    std::int64_t looked_at = 0;      ///< step of the last look
    std::int64_t steps_since_look = 0;
    std::size_t tool_count = 0;
    DropRing ring;
    std::vector<DropMeter> meters;
    ExpectedDrops expected;  ///< at the last look
    std::uint32_t seed = 0;
    Jets jets;
    std::vector<DropSpawn> landed;  ///< of jets: come in with the next plan
    bool jets_bleed = false;        ///< a wound sends out a jet in this frame

    /// The state of a name, made when it is first asked for.
    [[nodiscard]] static std::shared_ptr<BloodState> find(Assets& assets, std::string_view name);
    /// Blood of jets that has not come to the surface [mm^3].
    [[nodiscard]] double flying_mm3() const;
    /// Something has been disturbed: answers to what was asked until now say nothing about rest.
    void stir() {
        moving = true;
        disturbed_at = looks + 1;
    }
    /// Empty, at a step.
    void begin_anew(std::int64_t at, double rate);
};

}  // namespace viscera::tissue
