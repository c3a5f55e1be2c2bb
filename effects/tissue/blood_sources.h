#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

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

/// Where wounds may let drops appear, so that the blocks there are stepped before they come.
class ExpectedDrops {
  public:
    void begin(double drop_aspect);
    void clear() { begin(aspect_); }
    /// `radius_mm`: of the wound, around `uv`; `drop_mm3`: of its largest drop.
    void add(std::size_t wound, const glm::vec2& uv, double radius_mm, double drop_mm3);
    [[nodiscard]] bool covers(std::size_t wound, const glm::vec2& uv, double radius_mm,
                              double drop_mm3) const;
    /// As the shaders read them: drops as large as the places, u, v, volume [mm^3], and radius of
    /// the wound [mm].
    [[nodiscard]] std::span<const glm::vec4> places() const { return places_; }

  private:
    struct Place {
        glm::vec2 uv{0.0F};
        double reach_mm = -1.0;  ///< negative: none is expected
    };
    [[nodiscard]] double reach_mm(double radius_mm, double drop_mm3) const;

    double aspect_ = 1.0;
    std::vector<Place> by_wound_;
    std::vector<glm::vec4> places_;
};

}  // namespace viscera::tissue
