#pragma once

#include <vector>

#include <glm/glm.hpp>

namespace viscera::tissue {

/// What the steps of one frame have in common, as the shaders want it.
struct BloodMedium {
    glm::vec4 flow{0.0F};  ///< mobility [1/(mm s)], residual [mm], time step [s], drying [mm/s]
    glm::vec4 drop{0.0F};  ///< aspect, trail [mm], life [s], smallest volume [mm^3]
    glm::vec3 down{0.0F};
    float strength = 0.0F;     ///< of gravity, in units of the standard one
    float spreading = 0.0F;    ///< see GravityParams
    float relief_pull = 0.0F;  ///< the same; 0 without a relief
    float pinning = 0.0F;      ///< see LiquidParams [mm]
    float sealed_energy = 1.0F;
    bool open_edges = true;
    std::vector<glm::vec4> tools;        ///< place [mm], radius [mm]
    std::vector<glm::vec2> tool_powers;  ///< see tool_power()
};

/// A drop to be, as the shader reads it: two texels.
struct DropSpawn {
    glm::vec2 uv{0.0F};
    float volume_mm3 = 0.0F;
    float radius_mm = 0.0F;  ///< of the place around `uv` in which it appears
    float slot = 0.0F;       ///< in the ring
    float seed = 0.0F;
    /// UV of the tissue that decides whether it comes; negative: the place in which it appears does.
    glm::vec2 sealed_at{-1.0F};
    bool expected = false;  ///< the blocks there are known to be stepped: BloodBlocks::expect()
    bool foreseen = false;  ///< the wound that it is from was expected to bleed at the last look
};

}  // namespace viscera::tissue
