#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "effects/tissue/blood_params.h"
#include "engine/runtime/frame.h"

namespace viscera {
class Log;
}

namespace viscera::tissue {

inline constexpr std::size_t most_wounds = 65536;
inline constexpr std::size_t most_tools = 16;

/// Floats per wound in the host's array: place [mm] x y z, radius [mm], rate [mm^3/s], kind (0 ooze, 1 jet),
/// direction x y z, speed [mm/s], pulse [Hz], pulse depth.
inline constexpr std::size_t floats_per_wound = 12;
/// Floats per tool in the host's arrays: place [mm] x y z, radius [mm], rate (suction [mm^3/s], rinse [1/s]).
inline constexpr std::size_t floats_per_tool = 5;

/// The scene's wounds and tools and the host's, without those that are not finite, which are faults.
void collect_wounds(const BloodParams& params, const HostValues* values, Log& log,
                    std::vector<WoundParams>& wounds);
void collect_tools(const BloodParams& params, const HostValues* values, Log& log,
                   std::vector<CleanerParams>& tools);

/// Share of the mean flow of a wound at a time [s].
[[nodiscard]] double pulse_of(const WoundParams& wound, double time_s);

/// What a tool does in one step, as the shaders want it: taken [mm], share rinsed away.
[[nodiscard]] glm::vec2 tool_power(const CleanerParams& tool, double dt_s);

/// Portions blood into drops: what has flowed but does not yet fill a drop is kept for later.
class DropMeter {
  public:
    /// Volume of each of the drops that fall in a step, and how many.
    struct Drops {
        int count = 0;
        double volume_mm3 = 0.0;
    };
    /// Of each drop, where as much flows in each step.
    [[nodiscard]] static double drop_volume(double volume_mm3, double drop_mm3);
    [[nodiscard]] Drops flow(double volume_mm3, double drop_mm3);
    void clear() { held_mm3_ = 0.0; }

  private:
    double held_mm3_ = 0.0;
};

}  // namespace viscera::tissue
