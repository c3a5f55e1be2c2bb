#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "effects/tissue/bleeding.h"
#include "effects/tissue/blood_params.h"
#include "effects/tissue/blood_state.h"
#include "effects/tissue/gravity.h"
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
    void check_sizes(const Prepare& prepare) const;
    void check_inputs(Prepare& prepare);
    void spawn(const Pass& pass);
    void take_liquid();
    void let_time_pass(bool sealed, Log& log);
    /// After steps. `seals`: energy may close wounds.
    void see_whether_it_rests(bool seals);
    /// Steps that a gap between frames may have.
    [[nodiscard]] std::int64_t longest_gap() const;
    /// Whether a tool works between two times [s].
    [[nodiscard]] bool tools_work(double from_s, double to_s) const;
    void set_medium();
    void set_tools(std::int64_t step);
    void update_surface(const Pass& pass);
    /// Whatever shows blood is stepped again.
    void wake(const Pass& pass);
    void look(const Pass& pass, bool wake);
    void run_step(const Pass& pass);
    void show(const Pass& pass);
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
    std::uint64_t liquid_key_ = 0;
    std::uint64_t source_key_ = 0;  ///< of the wounds that bleed in this frame, and of the energy
    Bleeding bleeding_;
    std::vector<CleanerParams> tools_;
    std::vector<DropSpawn> spawns_;
    BloodMedium medium_;
};

}  // namespace viscera::tissue
