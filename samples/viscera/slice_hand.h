#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/runtime/renderer.h"

namespace viscera::app {

/// The user's hand on the slices of a scene: it moves their planes from voxel to voxel.
class SliceHand {
  public:
    explicit SliceHand(Renderer& renderer) : renderer_(renderer) {}

    /// Whether a target is the picture of a slice.
    [[nodiscard]] bool shows(std::string_view target) const { return pass_of(target) != nullptr; }
    /// Moves the plane of that picture by so many voxels towards the head, the back or the patient's left (an
    /// oblique one: towards the eye). The first time, the volume is read once more for its grid. Throws
    /// Error(file), Error(limit).
    void scroll(std::string_view target, double voxels);
    /// As the scene has them.
    void reset();
    /// Counts the changes.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

  private:
    struct Plane {
        bool oblique = false;
        int axis = 2;              ///< along which position_mm counts
        glm::dvec3 given_mm{0.0};  ///< a point on the plane
        glm::dvec3 step_mm{0.0};   ///< one voxel on
        double moved = 0.0;        ///< [voxels]
    };
    [[nodiscard]] const ScenePass* pass_of(std::string_view target) const;
    [[nodiscard]] Plane find(const ScenePass& pass);
    void set(const std::string& pass, Plane& plane, double moved);

    Renderer& renderer_;
    std::map<std::string, Plane> planes_;  ///< by pass, those that have been moved
    std::uint64_t revision_ = 0;
};

}  // namespace viscera::app
