#pragma once

#include <functional>

#include <nlohmann/json.hpp>

#include "effects/contrast/geometry_effect.h"
#include "engine/core/camera.h"
#include "engine/core/image.h"
#include "tests/effects/deviation.h"
#include "tests/reference/contrast.h"

namespace viscera::test {

/// The three pictures of a vessel, in double precision, for a scene's own parameters.
class VesselPicture {
  public:
    /// `parameters`: of a geometry pass, paths against assets/scenes. `sizes` [pixels].
    VesselPicture(const nlohmann::json& parameters, const View& view, int width, int height);

    /// Moves all that is drawn from now on by a part of a pixel.
    void shift(const glm::dvec2& pixels);

    /// Density by vertex scalar (arrival time or density), evaluated per fragment.
    using Density = std::function<double(double scalar)>;
    [[nodiscard]] reference::Buffer main(const Density& density, double tone = 1.0) const;
    /// The same where walls add up.
    [[nodiscard]] reference::Buffer thickness(const Density& density, double tone = 1.0) const;
    /// The same with densities of the host instead of the mesh's own scalar.
    [[nodiscard]] reference::Buffer main_of(std::span<const float> vertex_density, double tone = 1.0) const;
    /// Both with the cloud's brightness at that time.
    [[nodiscard]] reference::Buffer cloud(double brightness) const;
    [[nodiscard]] reference::Buffer distance() const;
    /// Pixels that target and reference agree to be covered, or beside the vessel, by a distance target.
    [[nodiscard]] IsCompared agreed(const Image& distance) const;

    [[nodiscard]] const contrast::Vessel& vessel() const { return *vessel_; }
    [[nodiscard]] const contrast::GeometryParams& parameters() const { return params_; }

  private:
    [[nodiscard]] reference::Injection injection(double brightness) const;

    contrast::GeometryParams params_;
    std::shared_ptr<const contrast::Vessel> vessel_;
    reference::ContrastMesh mesh_;
    View eye_;
    glm::dmat4 view_projection_{1.0};
    reference::ContrastView view_;
    reference::Buffer coverage_;
};

/// The bolus as the scene's parameters define it, written down anew: rise, plateau, decay cut at 1/4096 of
/// it; or straight lines between the points of a table.
[[nodiscard]] double bolus_density(const contrast::BolusParams& bolus, double since_arrival_s);

}  // namespace viscera::test
