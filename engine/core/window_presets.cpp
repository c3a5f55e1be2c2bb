#include <array>

#include "engine/core/transfer_function.h"

namespace viscera {

std::span<const WindowPreset> window_presets() {
    static constexpr std::array<WindowPreset, 12> presets{{
        {"ct-brain", {80.0, 40.0}, "grey and white matter, bleeding"},
        {"ct-subdural", {215.0, 75.0}, "blood beside the skull"},
        {"ct-stroke", {40.0, 40.0}, "early loss of the border between grey and white matter"},
        {"ct-bone", {1800.0, 400.0}, "fractures, cortical and cancellous bone"},
        {"ct-temporal-bone", {2800.0, 600.0}, "middle and inner ear"},
        {"ct-soft-tissue", {400.0, 40.0}, "muscle, fat and organs"},
        {"ct-lung", {1500.0, -600.0}, "airways and parenchyma"},
        {"ct-mediastinum", {350.0, 50.0}, "heart, great vessels and lymph nodes"},
        {"ct-abdomen", {400.0, 50.0}, "organs of the abdomen"},
        {"ct-liver", {150.0, 30.0}, "lesions in the liver"},
        {"ct-spine", {250.0, 50.0}, "discs, cord and soft tissue of the spine"},
        {"ct-angiography", {600.0, 300.0}, "vessels filled with contrast agent"},
    }};
    return presets;
}

}  // namespace viscera
