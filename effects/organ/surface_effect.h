#pragma once

#include <memory>
#include <string>
#include <vector>

#include "effects/organ/hematoma.h"
#include "effects/organ/organ_params.h"
#include "effects/organ/own_mesh.h"
#include "engine/runtime/effect.h"

namespace viscera::organ {

/// What blood brings besides its colour.
enum class BloodRelief { none, normal, height };

/// What of an organ shows in a frame; the rest is compiled out.
struct Variant {
    bool diffuse = false;
    bool energy = false;
    bool blood = false;
    BloodRelief relief = BloodRelief::none;
    bool cut = false;
    bool hint = false;
    bool hematoma = false;

    bool operator==(const Variant&) const = default;
};

/// Draws an organ with what tissue effects painted on it, or a membrane in front of one.
class SurfaceEffect final : public Effect {
  public:
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override { params_.validate(); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override;
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    void load(Prepare& prepare);
    void check_subjects(Prepare& prepare) const;
    [[nodiscard]] Variant variant_of(const Prepare& prepare) const;
    [[nodiscard]] bool has_relief() const;
    [[nodiscard]] bool shines() const;
    [[nodiscard]] bool needs_own_mesh() const;
    void name_features(const Variant& variant);
    [[nodiscard]] const gl::Mesh& mesh(const Pass& pass, const glm::dmat4& to_eye);
    void set_view(const Pass& pass, const gl::Program& program, const View& view, const glm::dmat4& to_eye);
    void set_material(const Pass& pass, const gl::Program& program);
    void set_raster(const Pass& pass, const View& view) const;

    OrganParams params_;
    mutable std::vector<ProgramDesc> programs_;
    mutable std::vector<Variant> variants_;  ///< of programs_
    std::uint64_t parameters_key_ = 0;
    std::shared_ptr<SurfaceMesh> surface_;
    glm::dmat4 to_world_{1.0};
    double hint_share_ = 0.0;
    Hematoma hematoma_;
    OwnMesh own_mesh_;
    Variant variant_;
    std::string reason_;
};

}  // namespace viscera::organ
