#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "effects/volume/gpu_volume.h"
#include "effects/volume/ray_cast_params.h"
#include "effects/volume/skip_map.h"
#include "engine/runtime/effect.h"

namespace viscera::volume {

/// Shows a volume by casting a ray per pixel.
class RayCastEffect final : public Effect {
  public:
    void visit(ParamVisitor& visitor) override;
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override;
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    struct Table;
    void find_function(Prepare& prepare);
    void find_crop();

    RayCastParams params_;
    mutable std::vector<ProgramDesc> programs_;
    std::uint64_t parameters_key_ = 0;
    std::shared_ptr<const Source> source_;
    TransferFunction function_;
    std::shared_ptr<Bricks> bricks_;
    SkipMap skip_map_;
    bool skips_ = false;
    glm::dmat4 texture_to_world_{1.0};
    glm::dvec3 box_min_{0.0};
    glm::dvec3 box_max_{1.0};
    VoxelBox crop_;
    double slab_mm_ = 1.0;
    std::optional<gl::Texture> table_;
    std::uint64_t table_key_ = 0;
};

}  // namespace viscera::volume
