#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/params.h"
#include "engine/runtime/surface_mesh.h"

namespace viscera::organ {

enum class LightPlace { camera, world, infinity };
enum class Faces { front, back, both };
enum class Blending { opaque, blended };
enum class BurnCurve { corrected, thesis };
enum class SpotMetric { world, uv };
enum class NormalEncoding { unsigned_rgb, signed_xyz };
[[nodiscard]] std::span<const std::string_view> choice_names(LightPlace place);
[[nodiscard]] std::span<const std::string_view> choice_names(Faces faces);
[[nodiscard]] std::span<const std::string_view> choice_names(Blending blending);
[[nodiscard]] std::span<const std::string_view> choice_names(BurnCurve curve);
[[nodiscard]] std::span<const std::string_view> choice_names(SpotMetric metric);
[[nodiscard]] std::span<const std::string_view> choice_names(NormalEncoding encoding);

/// As many lights as one organ is lit by.
inline constexpr std::size_t most_lights = 8;

struct LightParams {
    LightPlace place = LightPlace::camera;
    glm::dvec3 position{0.0, 4.0, 0.0};
    glm::dvec3 colour{1.0};
    double falloff_mm = 0.0;
    double angular = 2.0;
    double glow_mm = 0.0;
    double glow_per_mm2 = 0.02;

    void visit(ParamVisitor& v);
};

struct ShadingParams {
    double ambient = 0.06;
    double diffuse = 0.8;
    double specular = 0.12;
    glm::dvec3 specular_colour{1.0, 0.97, 0.93};
    double shininess = 90.0;

    void visit(ParamVisitor& v);
};

struct BumpParams {
    AssetPath map;
    double strength = 1.0;
    double repeat = 1.0;
    NormalEncoding encoding = NormalEncoding::unsigned_rgb;
    bool green_down = false;

    void visit(ParamVisitor& v);
};

struct CoagulationParams {
    glm::dvec3 colour{0.78, 0.7, 0.56};
    double saturation = 0.85;
    double brightness = 1.0;
    BurnCurve burn_curve = BurnCurve::corrected;
    double bump_gain = 10.0;

    void visit(ParamVisitor& v);
};

struct BloodParams {
    double bump = 1.0;

    void visit(ParamVisitor& v);
};

struct CutParams {
    AssetPath map;
    std::string vertex_scalar;

    void visit(ParamVisitor& v);
};

struct HintParams {
    AssetPath map;
    double strength = 0.6;
    double period_s = 1.5;

    void visit(ParamVisitor& v);
};

struct SpotParams {
    glm::dvec3 centre{0.0};
    double radius = 5.0;

    void visit(ParamVisitor& v);
};

struct HematomaParams {
    std::vector<SpotParams> spots;
    std::string host_spots;
    SpotMetric metric = SpotMetric::world;
    glm::dvec3 colour{0.16, 0.03, 0.07};
    double strength = 0.9;

    [[nodiscard]] bool used() const { return !spots.empty() || !host_spots.empty(); }
    void visit(ParamVisitor& v);
};

/// Where the picture is sharp. Depths along the view axis.
struct FocusParams {
    double near_mm = 40.0;
    double focus_mm = 120.0;
    double far_mm = 400.0;
    double clamp_near = 1.0;
    double clamp_far = 1.0;

    void visit(ParamVisitor& v);
};

struct OrganParams {
    SurfaceMeshParams mesh;
    std::optional<glm::dvec3> colour;
    AssetPath diffuse_map;
    double diffuse_repeat = 1.0;
    BumpParams normal_map;
    CoagulationParams coagulation;
    BloodParams blood;
    CutParams cut;
    HintParams hint;
    HematomaParams hematoma;
    ShadingParams shading;
    std::vector<LightParams> lights{LightParams()};
    std::optional<FocusParams> focus;
    Faces faces = Faces::both;
    Blending blending = Blending::opaque;
    double opacity = 1.0;
    bool into_picture = false;

    void visit(ParamVisitor& v);
    /// Throws Error(scene) for what no range can express.
    void validate() const;
};

/// Signed blurriness b of a view depth [mm]: < 0 before the focal plane, > 0 behind it.
/// Source: thesis appendix 2.m; spec/tissue.md, 'Organ'.
[[nodiscard]] double blurriness(const FocusParams& focus, double depth_mm);
/// As it is stored in alpha.
[[nodiscard]] constexpr double stored_blurriness(double b) {
    return 0.5 * b + 0.5;
}

}  // namespace viscera::organ
