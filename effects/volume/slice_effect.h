#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "effects/volume/gpu_volume.h"
#include "effects/volume/slice_params.h"
#include "effects/volume/space.h"
#include "effects/volume/transfer_texture.h"
#include "engine/core/mesh_data.h"
#include "engine/runtime/effect.h"

namespace viscera::volume {

/// Shows a volume's values on a plane or a mesh that cuts it.
class SliceEffect final : public Effect {
  public:
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override { params_.validate(); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return in_camera(); }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override;
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    [[nodiscard]] bool in_camera() const { return params_.view == SliceView::camera; }
    void find_surface(Prepare& prepare);
    void make_table(const gl::Functions& gl, const TexelMap& stored_of_texel);
    void set_plane(const Pass& pass, const gl::Program& program) const;

    SliceParams params_;
    mutable std::vector<ProgramDesc> programs_;
    mutable std::vector<std::pair<VolumeKind, bool>> variants_;  ///< of each program: kind, atlas
    std::uint64_t parameters_key_ = 0;
    VolumeGrid grid_;
    std::shared_ptr<const Source> source_;
    std::shared_ptr<const Source> sampled_;  ///< what the texture holds: the source or its coefficients
    int sampled_channel_ = 0;
    TransferFunction function_;
    Space space_;
    SlicePlane plane_;
    MeshData surface_;  ///< camera: in local coordinates
    Bounds bounds_;
    std::uint64_t surface_key_ = 0;
    TransferTexture table_{EntriesShown::all};
};

}  // namespace viscera::volume
