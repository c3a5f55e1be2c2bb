#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/blood_medium.h"
#include "effects/tissue/blood_params.h"
#include "effects/tissue/blood_state.h"
#include "effects/tissue/surface_search.h"
#include "engine/runtime/frame.h"
#include "engine/runtime/surface_mesh.h"

namespace viscera {
class Log;
}

namespace viscera::tissue {

/// The wounds of a frame: where they lie on the surface, and the drops and jets that they let go.
class Bleeding {
  public:
    /// The scene's wounds and the host's.
    void collect(const BloodParams& params, const HostValues* values, Log& log);
    /// The surface as it lies now. `key`: another one for each that is not the same.
    void lie_on(std::shared_ptr<const SurfaceMesh> mesh, const glm::dmat4& to_world, std::uint64_t key);

    /// Whether a wound bleeds between two times [s].
    [[nodiscard]] bool bleeds(double from_s, double to_s) const;
    /// Whether one sends out a jet then.
    [[nodiscard]] bool sends_jets(double from_s, double to_s) const;

    /// Another one whenever other wounds bleed then, or bleed elsewhere.
    [[nodiscard]] std::uint64_t key(double from_s, double to_s) const;
    /// Whether all that is in the air is from jets that bleed then.
    [[nodiscard]] bool jets_explain(const BloodState& state, double from_s, double to_s) const;

    /// Before steps: finds where wounds lie, of those that are new or whose surface has moved.
    void find_places(BloodState& state, Log& log);
    /// Where drops may appear in so many steps from the state's own on. `seals`: energy may close wounds,
    /// those of jets, too, whose drops appear anywhere.
    void expect_drops(BloodState& state, int steps, bool seals) const;
    /// What falls from wounds in a step, and what comes down of jets, which fly on under a gravity [mm/s^2].
    void step(BloodState& state, const glm::dvec3& gravity_mm_s2, Log& log, std::vector<DropSpawn>& drops);

  private:
    [[nodiscard]] static bool bleeds(const WoundParams& wound, double from_s, double to_s);
    /// Where a wound lies on the surface.
    struct Place {
        glm::dvec3 wound_mm{0.0};  ///< as it was given
        std::uint64_t surface_key = 0;
        bool found = false;
        glm::dvec3 start_mm{0.0};  ///< of a jet
        glm::vec2 uv{0.0F};
    };
    /// The jet that bleeds then and whose wound has this UV; none: places_.size().
    [[nodiscard]] std::size_t jet_at(const glm::vec2& uv, double from_s, double to_s) const;
    void update_tree();
    void fly(BloodState& state, const glm::dvec3& gravity_mm_s2);

    std::vector<WoundParams> wounds_;
    LiquidParams liquid_;
    std::shared_ptr<const SurfaceMesh> mesh_;
    glm::dmat4 to_world_{1.0};
    std::uint64_t surface_key_ = 0;
    std::vector<Place> places_;
    TriangleTree tree_;  ///< for jets, and for many wounds
    std::uint64_t tree_key_ = 0;
};

}  // namespace viscera::tissue
