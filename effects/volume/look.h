#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "effects/volume/classic.h"
#include "effects/volume/clip.h"
#include "effects/volume/gpu_volume.h"
#include "effects/volume/labels.h"
#include "effects/volume/light_volume.h"
#include "effects/volume/overlay.h"
#include "effects/volume/shading.h"
#include "effects/volume/space.h"
#include "effects/volume/transfer_params.h"
#include "engine/runtime/pass.h"

namespace viscera::volume {

/// What depends on the ray function and on the transfer function's file, which programs must be made for all
/// ways.
struct LookVariant {
    /// Whether colours are; else segments alone count, without transfer functions of their own.
    bool composed = false;
    bool shaded = false;
    bool by_gradient = false;
    bool operator==(const LookVariant&) const = default;
};

/// What places look like besides colour and opacity over value, and which are cut away.
struct LookParams {
    ShadingParams shading;
    LabelParams labels;
    OverlayParams overlay;
    std::vector<ClipPlane> clip_planes;

    void visit(ParamVisitor& v);
    void validate() const;
    /// Whether places look other than the transfer function says.
    [[nodiscard]] bool used(const LookVariant& variant) const {
        return variant.shaded || variant.by_gradient || labels.used() || overlay.used() ||
               shading.light_volume.used();
    }
};

/// What the look is applied to.
struct LookScene {
    const Source& source;
    int channel;
    const TransferFunction& function;
    const Space& space;  ///< with the placement, which labels and overlay follow
    TexelMap value_of_texel;
    TexelRange range;                 ///< [texel]
    int entries;                      ///< of tables over the range
    bool atlas = false;               ///< whether volumes are stored as slices, all alike
    const Volume* colours = nullptr;  ///< accumulated as they are; none: the function says what is seen
    const AccumulateParams* accumulate = nullptr;  ///< of colours
};

/// For glsl/volume/material.glsl: shading, gradient opacity, labels, overlay and coarse light.
class Look {
  public:
    using Variant = LookVariant;
    [[nodiscard]] static std::vector<Variant> variants(const LookParams& params,
                                                       const TransferParams& transfer);
    [[nodiscard]] static Variant variant(const LookParams& params, const TransferFunction& function) {
        return {true, params.shading.wanted(function), !function.gradient.empty()};
    }
    [[nodiscard]] static std::vector<std::string> defines(const LookParams& params, const Variant& variant);

    /// Loads what the parameters name and the variant reads. Reason to draw nothing: a volume that the host
    /// does not give; else empty. Throws Error(scene) for a curvilinear one whose shape is not that of the
    /// volume that is shown.
    [[nodiscard]] std::string_view load(const LookParams& params, const Variant& variant,
                                        const VolumeGrid& shown, Prepare& prepare);
    /// Whether labels and overlay both fit 3-D textures.
    [[nodiscard]] bool fits_3d(const gl::Functions& gl) const;
    /// Of labels and overlay, for Work.
    [[nodiscard]] std::uint64_t key() const;
    /// Adds what labels with transfer functions of their own show.
    void widen(const LookParams& params, const TransferFunction& function, const TexelMap& value_of_stored,
               const TexelRange& stored, int entries, std::vector<StoredRange>& visible) const;
    /// Binds everything that `defines` asks for.
    void bind(const LookParams& params, const Variant& variant, const LookScene& scene, const Pass& pass,
              const gl::Program& program);

  private:
    void bind_labels(const LookParams& params, const LookScene& scene, const Pass& pass,
                     const gl::Program& program);
    void bind_ramps(const LookParams& params, const LookScene& scene, const Pass& pass,
                    const gl::Program& program);
    void bind_overlay(const LookParams& params, const LookScene& scene, const Pass& pass,
                      const gl::Program& program);
    void bind_gradient(const LookScene& scene, const Pass& pass, const gl::Program& program);
    void bind_light(const LookParams& params, const LookScene& scene, const Pass& pass,
                    const gl::Program& program);

    [[nodiscard]] VoxelExtinction extinction_of(const LookParams& params, const LookScene& scene) const;

    /// A texture with the key of what it was made from.
    struct Made {
        std::optional<gl::Texture> texture;
        std::uint64_t key = 0;
        std::optional<AtlasLayout> atlas{};  ///< of what is stored as slices
    };
    std::uint64_t parameters_key_ = 0;
    SourceParams label_source_;
    SourceParams overlay_source_;
    std::shared_ptr<const Source> labels_;
    std::shared_ptr<const Source> overlay_;
    std::shared_ptr<Made> label_voxels_;  ///< shared by all passes with the same labels and ids
    Made label_looks_;
    Made label_ramps_;
    Made overlay_map_;
    glm::dvec2 overlay_place_{0.0};
    Made gradient_factor_;
    std::shared_ptr<Made> light_;  ///< shared by all passes that light the volume alike
};

}  // namespace viscera::volume
