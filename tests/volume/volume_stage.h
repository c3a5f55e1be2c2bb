#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/effects/stage.h"
#include "tests/reference/volume_field.h"
#include "tests/reference/volume_ray.h"

// What tests of the ray caster's accuracy share: host volumes, scenes about one, fields that stand in the
// shader instead of voxels, and pictures beside double precision.

namespace viscera::test {

/// Shader files whose text is another than the engine's: name relative to glsl/ -> text.
using ShaderTexts = std::map<std::string, std::string, std::less<>>;
[[nodiscard]] ShaderReader with_texts(ShaderTexts texts);

/// volume/sample.glsl of an analytic field instead of voxels: `body` defines `float field(vec3 p)`, p in mm
/// from the centre of a box `box_mm` large, before placement. It has no gradient. Skipping must be off.
[[nodiscard]] std::string field_text(std::string_view body, const glm::dvec3& box_mm);
/// volume/classify.glsl with a law instead of a table: `body` defines `vec4 classify(float value)`, colour
/// and extinction [1/mm].
[[nodiscard]] std::string classify_text(std::string_view body);
/// An engine's file in which each of `functions` is called plain_<name>, and after it `text`, which defines
/// them anew.
[[nodiscard]] std::string wrapped(std::string_view name, std::span<const std::string_view> functions,
                                  std::string_view text);
/// Composition that shows how many slabs were taken (red) and how many of those changed the picture (green).
[[nodiscard]] ShaderTexts slab_counting();
/// The ray caster as it is compiled for hardware, whose branches leave out what no pixel of a group needs.
[[nodiscard]] ShaderTexts as_on_hardware();
/// A number as GLSL reads it.
[[nodiscard]] std::string glsl(double value);
[[nodiscard]] std::string glsl(const glm::dvec3& value);

/// Volume of one f32 channel about the world's origin; value(p) at the centres of its voxels [mm].
[[nodiscard]] Volume float_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                                  const std::function<double(const glm::dvec3& p)>& value);
/// The same from numbers, x fastest.
[[nodiscard]] Volume float_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                                  std::span<const float> values);
/// Values uniform in [0, 1), the same for one seed.
[[nodiscard]] Volume noise_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm, unsigned seed);
/// Dark but for a few winding vessels about one voxel thick, 0 to 200; u8.
[[nodiscard]] Volume vessel_volume(int n, double spacing_mm, unsigned seed);
/// Nested ellipsoids with CT numbers of a head: air -1000, skin 60, bone 1100, brain 35, some noise; i16.
[[nodiscard]] Volume head_volume(int n, double side_mm);

struct Look {
    glm::dvec3 eye_mm{0.0, -400.0, 0.0};
    glm::dvec3 target_mm{0.0};
    glm::dvec3 up{0.0, 0.0, 1.0};
    double orthographic_mm = 0.0;  ///< height seen; 0: perspective
    double fov_deg = 30.0;
    double near_mm = 1.0;
    double far_mm = 4000.0;
};
[[nodiscard]] nlohmann::json to_json(const Look& look);

/// A picture with the view it was made with.
struct Shot {
    Image image;
    View view;

    [[nodiscard]] glm::dvec4 at(int x, int y) const;
    [[nodiscard]] reference::Ray ray(int x, int y) const;
    /// Where a ray passes a plane `depth_mm` in front of the eye, such as the near plane [mm].
    [[nodiscard]] double along(const reference::Ray& ray, double depth_mm) const;
};
[[nodiscard]] bool same_bits(const Shot& a, const Shot& b);

/// Renders "volume.ray_cast" about one host's volume into floats.
class VolumeStage {
  public:
    explicit VolumeStage(ShaderTexts texts = {});

    /// `parameters` of the effect, without its volume's name.
    [[nodiscard]] Shot cast(const LiveVolume& volume, nlohmann::json parameters, const Look& look,
                            const glm::ivec2& size = glm::ivec2(64));
    /// The loaded scene once more, with another view.
    [[nodiscard]] Shot cast_again(const LiveVolume& volume, const View& view, const glm::ivec2& size);
    [[nodiscard]] Stage& stage() { return stage_; }

  private:
    Stage stage_;
};

/// Greatest difference of a picture from what `wanted` says of each pixel's ray, over all channels; NaN
/// counts as 1e30. Pixels for which it gives nothing are left out.
struct Miss {
    double worst = 0.0;
    int x = 0;  ///< where it is
    int y = 0;
    double rms = 0.0;
    int pixels = 0;
    double most = 0.0;  ///< greatest value wanted
};
using WantedColour = std::function<std::optional<glm::dvec4>(const reference::Ray&)>;
[[nodiscard]] Miss miss(const Shot& shot, const WantedColour& wanted);

/// Slope of log(error) over -log(n), by least squares.
[[nodiscard]] double order_of(std::span<const double> n, std::span<const double> error);

/// A transfer function that shows the brighter parts of volumes of vessels, 0 to 200, and nothing below 60.
[[nodiscard]] nlohmann::json vessels_shown();

}  // namespace viscera::test
