#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "effects/volume/gpu_volume.h"
#include "effects/volume/ray_cast_params.h"
#include "effects/volume/ray_frame.h"
#include "effects/volume/skip_map.h"
#include "effects/volume/slab_texture.h"
#include "effects/volume/transfer_texture.h"
#include "engine/core/mesh_data.h"
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
    /// `adaptive`: also takes long slabs where the transfer function hardly changes.
    enum class Skipping { none, empty, adaptive };
    /// What the programs differ in besides the parameters.
    struct Variant {
        VolumeKind kind = VolumeKind::cartesian;
        RayFunction function = RayFunction::composite;
        Skipping skipping = Skipping::none;
        Look::Variant look;
        bool surface = false;     ///< rays end at opaque surfaces
        bool background = false;  ///< the picture goes over another
        bool inner = false;       ///< the mesh that limits rays may be passed twice
        bool fills = false;       ///< pixels come from a coarse picture where it is smooth
        bool atlas = false;       ///< the volume is stored as slices
        bool compute = false;
        bool operator==(const Variant&) const = default;
    };
    void find_function(Prepare& prepare);
    [[nodiscard]] ExtinctionKnots knots_of_texel(const TransferFunction& function,
                                                 const TexelMap& stored_of_texel) const;
    void make_slabs(const gl::Functions& gl, const TexelMap& stored_of_texel);
    [[nodiscard]] ClassificationTable table_of_texel(const TexelMap& stored_of_texel) const;
    void make_table(const gl::Functions& gl, const TexelMap& stored_of_texel);
    [[nodiscard]] TexelRange texel_range(const TexelMap& stored_of_texel) const;
    [[nodiscard]] bool shows_colours() const {
        return params_.function == RayFunction::accumulate && params_.accumulate.colours();
    }
    [[nodiscard]] bool needs_kept_gradients() const;
    void bind_gradients(const Pass& pass, const gl::Program& program, const TexelMap& map) const;
    void check_colours() const;
    void set_colours(const gl::Program& program, double share_per_texel) const;
    [[nodiscard]] bool projects() const { return variant_.function != RayFunction::composite; }
    [[nodiscard]] std::vector<StoredRange> visible() const;
    [[nodiscard]] std::vector<StoredRange> visible_colours() const;
    [[nodiscard]] SmoothRule smooth_rule() const;
    [[nodiscard]] bool find_bricks(Prepare& prepare);
    [[nodiscard]] Bounds seen_bounds(Bounds bounds) const;
    [[nodiscard]] std::vector<VolumeKind> kinds() const;
    void check_kind() const;

    [[nodiscard]] bool is_coarse() const { return params_.mixed && params_.mixed->pass == MixedPass::coarse; }
    [[nodiscard]] static glm::ivec2 lattice_of(const Frame& frame, glm::ivec2 depth);
    void set_picture(const Pass& pass, const RayFrame& frame, const gl::Program& program) const;
    void fill_in(const Pass& pass, const RayFrame& frame);
    void cover(const Pass& pass, const gl::Program& program) const;
    void find_crop();
    void check_limits(Prepare& prepare) const;
    void bind_blue_noise(const Pass& pass, const gl::Program& program);

    RayCastParams params_;
    mutable std::vector<ProgramDesc> programs_;
    mutable std::vector<Variant> variants_;  ///< of each program
    Variant variant_;                        ///< of this frame
    std::uint64_t parameters_key_ = 0;
    std::uint64_t source_version_ = 0;
    std::shared_ptr<const Source> source_;
    std::shared_ptr<const Source> voxels_;     ///< the source, or the colours made of it
    std::shared_ptr<const Source> gradients_;  ///< where they are kept and needed
    std::shared_ptr<const Source> sampled_;    ///< what the texture holds: the voxels or their coefficients
    int sampled_channel_ = 0;
    TransferFunction function_;
    std::array<std::shared_ptr<Bricks>, 4> bricks_;  ///< of the channel, or of each colour
    int brick_size_ = 1;                             ///< [voxels]
    SkipMap skip_map_;
    std::vector<StoredRange> visible_;  ///< what visible() and smooth_rule() gave; of colours, one a channel
    SmoothRule smooth_;
    std::uint64_t visible_key_ = 0;
    Space space_;
    glm::dvec3 box_min_{0.0};  ///< crop, in texture coordinates
    glm::dvec3 box_max_{1.0};
    VoxelBox crop_;
    Lattice lattice_;
    glm::dvec2 fovea_centre_{0.0};  ///< UV
    glm::ivec2 depth_size_{0};      ///< [pixels]; 0: there is no depth
    Look look_;
    std::shared_ptr<const gl::Texture> blue_noise_;
    MixedPlan plan_;
    std::optional<SlabTexture> slabs_;  ///< preintegrated only
    TransferTexture table_{EntriesShown::with_extinction};
};

}  // namespace viscera::volume
