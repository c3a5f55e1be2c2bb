#pragma once

#include <glm/glm.hpp>

#include "engine/runtime/effect.h"

namespace viscera::filter {

enum class Axis { x, y };
[[nodiscard]] std::span<const std::string_view> choice_names(Axis axis);

struct GaussianParams {
    Axis axis = Axis::x;
    double sigma = 0.01;
    double gain = 1.0;

    void visit(ParamVisitor& v);
};

/// Half of a symmetric kernel for linear fetches: weight of the centre, then pairs of neighbouring pixels
/// merged into one fetch each (offset [pixels], weight). All weights, the pairs counted twice, sum to 1.
struct GaussianTaps {
    double centre = 1.0;
    std::vector<glm::dvec2> pairs;
};

/// Taps of exp(-i^2 / 2 sigma^2), |i| <= ceil(3 sigma), normalised. sigma [pixels]; <= 0: the centre alone.
/// At most gaussian_taps pairs, which cuts sigmas above 21 pixels short of 3 sigma.
inline constexpr std::size_t gaussian_taps = 32;
[[nodiscard]] GaussianTaps make_gaussian(double sigma_pixels);

/// One direction of a Gaussian blur: two passes make the whole.
class GaussianEffect final : public Effect {
  public:
    GaussianEffect();
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    GaussianParams params_;
    std::vector<ProgramDesc> programs_;
    double sigma_pixels_ = -1.0;
    GaussianTaps taps_;
    std::array<glm::vec2, gaussian_taps> uniform_{};
};

}  // namespace viscera::filter
