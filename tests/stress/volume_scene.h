#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/stress/stage.h"

// What the stress tests of volumes share: host volumes, a scene about one, and the closed form of a
// homogeneous one.

namespace viscera::test {

/// One channel of f32 about the world's origin; value(i, j, k).
[[nodiscard]] Volume make_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                                 const std::function<double(const glm::ivec3&)>& value);
/// The same number everywhere, as it is stored.
[[nodiscard]] Volume constant_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm, double stored,
                                     ScalarType type = ScalarType::f32);
/// A ball of 100 in 0, with a soft edge.
[[nodiscard]] Volume ball_volume(int n);

/// Ray casts of volumes that the host gives, 20 x 16 into floats.
class VolumeStress : public Stage {
  protected:
    /// Opacity 0.1 per mm at every value, colour (0.25, 0.5, 1).
    [[nodiscard]] static nlohmann::json homogeneous();
    /// Nothing at 0, opacity 0.5 per mm at 100.
    [[nodiscard]] static nlohmann::json ramp();
    [[nodiscard]] static nlohmann::json camera(const nlohmann::json& eye_mm, const nlohmann::json& target_mm,
                                               double near_mm = 0.01, double far_mm = 1000.0);
    [[nodiscard]] static nlohmann::json orthographic(const nlohmann::json& eye_mm,
                                                     const nlohmann::json& target_mm, double height_mm);
    /// One pass "cast" over the volume "host".
    [[nodiscard]] static nlohmann::json scene(nlohmann::json parameters, const nlohmann::json& camera);

    void give(std::string_view name, const LiveVolume* volume);
    /// The loaded scene once more; fails unless every target is finite.
    [[nodiscard]] Image picture() { return picture(volume_frame()); }
    [[nodiscard]] Image picture(const Frame& frame) { return render(frame).at("volume.colour"); }
    /// Of the volumes given.
    [[nodiscard]] Frame volume_frame();
    [[nodiscard]] Image cast(const LiveVolume& volume, const nlohmann::json& parameters,
                             const nlohmann::json& camera = front());
    [[nodiscard]] static nlohmann::json front();

    /// Homogeneous opacity 0.1 per mm in a box [0, 1]^3 of local coordinates, cut by the near and far plane.
    void expect_homogeneous(const Image& image, const glm::dmat4& local_to_world, double tolerance,
                            const std::string& what, const glm::dvec3& low = glm::dvec3(0.0),
                            const glm::dvec3& high = glm::dvec3(1.0));
    /// Loading or rendering throws Error of the code, naming `key`.
    void expect_refused(const nlohmann::json& scene, ErrorCode code, const std::string& key);

  private:
    std::vector<HostVolume> given_;
};

/// Greatest difference of any value.
[[nodiscard]] double difference(const Image& a, const Image& b);
void expect_near(const Image& a, const Image& b, double tolerance, const std::string& what);
[[nodiscard]] bool is_empty(const Image& image);

}  // namespace viscera::test
