#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/gpu_volume.h"
#include "effects/volume/reconstruction.h"
#include "engine/context/context.h"
#include "engine/gl/buffer.h"
#include "engine/runtime/assets.h"

namespace viscera::test {

/// Samples volumes at given places with the shader functions of glsl/volume/sample.glsl, in a context of its
/// own.
class VolumeSampler {
  public:
    /// How the texture unit weighs: as it does here, in full precision, or in 8 bits as on most GPUs.
    enum class Weights { own, eight_bits };

    explicit VolumeSampler(Weights weights = Weights::own);

    struct Sample {
        glm::dvec3 gradient{0.0};  ///< per texture coordinate
        double value = 0.0;        ///< rescaled
    };
    /// `places` in texture coordinates.
    [[nodiscard]] std::vector<Sample> sample(const volume::Source& source,
                                             const volume::ReconstructionParams& reconstruction,
                                             volume::Storage storage, std::span<const glm::vec3> places);
    [[nodiscard]] std::vector<Sample> sample(volume::GpuVolume& gpu, const volume::Source& source,
                                             const volume::ReconstructionParams& reconstruction,
                                             std::span<const glm::vec3> places);
    [[nodiscard]] const gl::Functions& gl() const { return *gl_; }
    [[nodiscard]] Assets& assets() { return *assets_; }

  private:
    Weights weights_;
    std::unique_ptr<Context> context_;
    std::unique_ptr<const gl::Functions> gl_;
    Log log_;
    std::unique_ptr<Assets> assets_;
    std::optional<gl::VertexArray> no_vertices_;
};

/// A source that owns its volume.
[[nodiscard]] volume::Source make_source(Volume volume);

}  // namespace viscera::test
