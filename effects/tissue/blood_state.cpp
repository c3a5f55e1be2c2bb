#include "effects/tissue/blood_state.h"

#include "engine/core/hash.h"

namespace viscera::tissue {

std::shared_ptr<BloodState> BloodState::find(Assets& assets, std::string_view name) {
    return assets.shared<BloodState>(Hash().add(name).value(), [] { return std::make_shared<BloodState>(); });
}

double BloodState::flying_mm3() const {
    double volume = jets.flying_mm3();
    for (const DropSpawn& drop : landed) {
        volume += static_cast<double>(drop.volume_mm3);
    }
    return volume;
}

void BloodState::begin_anew(std::int64_t at, double rate) {
    begun = true;
    bled = moving = woken = there = sealed = false;
    source_key = sealed_key = asked_look = 0;
    step = at;
    steps_per_s = rate;
    surface_key = 0;
    shown_version = 0;
    ++version;
    steps_since_look = 0;
    ring.clear();
    meters.clear();
    expected.clear();
    seed = 0;
    tool_count = 0;
    jets.clear();
    landed.clear();
}

}  // namespace viscera::tissue
