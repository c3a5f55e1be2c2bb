#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"
#include "tests/reference/tissue_film.h"

namespace viscera::test {

/// A piece of a surface in texture space: a rectangle of the parameters (a, b), laid into the texture by an
/// affine map from parameters to texels.
struct SurfaceChart {
    glm::dvec2 low{0.0};
    glm::dvec2 high{1.0};
    glm::dvec2 origin_px{8.0};  ///< texel coordinates of (0, 0)
    glm::dvec2 a_px{1.0, 0.0};  ///< per unit of a
    glm::dvec2 b_px{0.0, 1.0};  ///< per unit of b
    glm::ivec2 cells{1};        ///< of the mesh
};

/// Lies askew in a texture of 128 texels a side, and is stretched.
inline constexpr SurfaceChart askew_chart{.high = {40.0, 30.0},
                                          .origin_px = {12.0, 14.0},
                                          .a_px = {1.9, 0.4},
                                          .b_px = {-0.1, 2.6},
                                          .cells = {3, 2}};

/// A parametric surface as an OBJ file, its charts joined where their corners meet.
[[nodiscard]] std::string surface_obj(std::span<const SurfaceChart> charts, int size,
                                      const std::function<glm::dvec3(glm::dvec2)>& place);

/// Volumes [mm^3].
struct BloodAccount {
    double given = 0.0;
    double film = 0.0;
    double drops = 0.0;
    double gone = 0.0;
    [[nodiscard]] double kept() const { return film + drops + gone; }
};

/// Of what tissue.blood_account has drawn.
[[nodiscard]] BloodAccount account_of(const Image& picture);

/// Bake, gravity and blood on one surface.
class BloodStage {
  public:
    explicit BloodStage(int size, Backend backend = Backend::osmesa);

    TempFolder folder;
    int size;
    nlohmann::json mesh;     ///< parameters of the mesh; "file" is filled in by surface()
    nlohmann::json gravity;  ///< parameters of tissue.gravity that it has in common with tissue.blood
    nlohmann::json blood = nlohmann::json::object();  ///< further parameters of tissue.blood
    nlohmann::json more = nlohmann::json::array();    ///< passes before the blood's

    void surface(std::span<const SurfaceChart> charts, const std::function<glm::dvec3(glm::dvec2)>& place);
    /// Height of a relief over the surface [mm] at a place in the world.
    void relief(const std::function<double(const glm::dvec3&)>& height_mm);
    /// Blood that lies there at the start [mm], at each cell's centre in the world.
    void spill(const std::function<double(const glm::dvec3&)>& height_mm);
    [[nodiscard]] nlohmann::json scene() const;
    void load();

    /// Frames from `from` to `to`, both included, each `step_s` later; the last one's report.
    const FrameReport& run(double from_s, double to_s, double step_s, const HostValues* values = nullptr);
    const FrameReport& frame(double time_s, const HostValues* values = nullptr);
    [[nodiscard]] Image read(std::string_view target) { return stage_.renderer().read(target); }
    [[nodiscard]] double time_s() const { return time_s_; }  ///< of the last frame
    [[nodiscard]] BloodAccount account() { return account_of(read("tissue.blood_account")); }
    /// The bake as it was drawn, for the reference.
    [[nodiscard]] reference::TissueSurface baked();
    [[nodiscard]] Stage& stage() { return stage_; }

  private:
    /// A picture with a value for each texel of the charts, and with `gutters` around them; its file.
    std::string picture(const char* name, bool gutters,
                        const std::function<double(const glm::dvec3&)>& value);

    Stage stage_;
    std::string spill_file_;
    std::string relief_file_;
    double time_s_ = 0.0;
};

/// Fails the test where a picture, or one of those that blood gives, holds what is no number.
void expect_finite(const Image& image);
void expect_finite(BloodStage& stage);

}  // namespace viscera::test
