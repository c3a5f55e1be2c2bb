#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "effects/tissue/blood_params.h"
#include "effects/tissue/blood_state.h"
#include "effects/tissue/gravity.h"
#include "effects/tissue/surface_search.h"
#include "engine/runtime/effect.h"

namespace viscera::tissue {

/// Blood on a surface: drops that run down it, the film that they leave, and how both look.
class BloodEffect final : public Effect {
  public:
    BloodEffect();
    ~BloodEffect() override;
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] bool keeps_state() const override { return true; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    /// Where a wound lies on the surface.
    struct Place {
        glm::dvec3 position_mm{0.0};
        std::uint64_t surface_key = 0;
        bool found = false;
        glm::vec2 uv{0.0F};
    };
    void check_sizes(const Prepare& prepare) const;
    void check_inputs(Prepare& prepare);
    void find_places();
    void update_tree();
    void spawn(const Pass& pass);
    [[nodiscard]] bool bleeds(std::int64_t first, std::int64_t last) const;
    [[nodiscard]] std::size_t working_tools(std::int64_t step) const;
    void set_medium();
    void set_tools(std::int64_t step);
    void update_surface(const Pass& pass);
    void run_step(const Pass& pass);
    void show(const Pass& pass);
    /// Says where drops may appear until the next look.
    void expect_drops();
    void collect_drops(std::int64_t step);
    void fly(double dt);
    [[nodiscard]] glm::dvec3 gravity_mm_s2() const;

    BloodParams params_;
    std::vector<ProgramDesc> programs_;
    std::uint64_t parameters_key_ = 0;
    std::shared_ptr<BloodState> state_;
    std::shared_ptr<SurfaceMesh> mesh_;
    glm::dmat4 to_world_{1.0};
    Flow flow_;
    std::uint64_t surface_key_ = 0;  ///< of the mesh as it lies now
    std::int64_t target_step_ = 0;
    std::uint64_t shown_version_ = 0;  ///< of the blood that this pass drew last
    std::vector<WoundParams> wounds_;
    std::vector<Place> places_;
    std::vector<CleanerParams> tools_;
    std::vector<DropSpawn> spawns_;
    TriangleTree tree_;  ///< for jets
    std::uint64_t tree_key_ = 0;
    BloodMedium medium_;
};

}  // namespace viscera::tissue
