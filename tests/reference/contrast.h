#pragma once

#include <functional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/buffer.h"
#include "tests/reference/raster.h"

namespace viscera::reference {

/// What the contrast chain draws, in double precision.
struct ContrastMesh {
    std::vector<glm::dvec3> positions_mm;
    std::vector<std::uint32_t> indices;
};

/// A camera and a target.
struct ContrastView {
    glm::dmat4 view_projection{1.0};
    RasterOptions raster;
};

/// Contrast density in [0, 1] at a fragment, for example
/// `[&](const Fragment& f) { return bolus.density(f.interpolate(since_arrival_s)); }`.
using DensityAt = std::function<double(const Fragment&)>;

/// S_N(a) by its own sum, term by term.
[[nodiscard]] double opacity_loop(double a, int n = 25);

/// Stage 1: tone * max over fragments of a S_25(a); 0 where nothing is drawn. One channel.
[[nodiscard]] Buffer main_object(const ContrastMesh& mesh, const ContrastView& view, const DensityAt& density,
                                 double tone = 1.0);

/// Stage 1 where walls add up: the sum over all fragments of tone * a * S_N(a) * |way| / calibre, with the
/// way [mm] that the ray goes from the vessel's axis to the wall.
[[nodiscard]] Buffer thick_object(const ContrastMesh& mesh, const ContrastView& view,
                                  const DensityAt& density, const DensityAt& way_mm, double calibre_mm,
                                  double tone);

struct Injection {
    glm::dvec3 position_mm{0.0};
    double radius_mm = 1.0;   ///< <= 0 or not finite: no injection
    double brightness = 1.0;  ///< B >= 0
    double threshold = 0.0;
};

/// clamp(3 (1 - |p - p_inj| / R), 0, 1); 0 without a radius.
[[nodiscard]] double injection_weight(const Injection& injection, const glm::dvec3& place_mm);

/// Stage 2: channel 0 brightness c = B q, channel 1 weight q, of the strongest fragment with c >= threshold.
[[nodiscard]] Buffer cloud(const ContrastMesh& mesh, const ContrastView& view, const Injection& injection);

/// Stage 3: channel 0 the largest q, channel 1 coverage (1 where the mesh is drawn).
[[nodiscard]] Buffer distance_map(const ContrastMesh& mesh, const ContrastView& view,
                                  const Injection& injection);

enum class Transition { smooth, thesis, densest };

/// Stage 4, with smooth transition, the thesis's jump, or the larger of main and r
/// (effects/contrast/summarize_curve.h has the text).
[[nodiscard]] Buffer summarize(const Buffer& main, const Buffer& cloud, const Buffer& distance,
                               Transition transition);

/// One picture of the smoke, seen at an angle between view direction and emitter axis: 90 is from the side.
struct SpriteView {
    double angle_deg = 90.0;
    Buffer texture;
};

struct Emitter {
    glm::dvec3 base_mm{0.0};
    glm::dvec3 tip_mm{0.0};
    glm::dvec3 edge_mm{0.0};
    double size = 1.0;
    double strength = 1.0;  ///< scale of the smoke's density, in [0, 1]
};

/// What all emitters of one pass share. Views are sorted by angle; between two of them the smoke is their
/// linear blend by angle, beyond the ends the nearest one.
struct Sprites {
    std::vector<SpriteView> views;
    Buffer front;
    Buffer mask_sharp;    ///< over the target's UV; empty: 1 everywhere
    Buffer mask_blurred;  ///< over the target's UV; empty: 1 everywhere
};

/// The view's eye, for the angle between view direction and emitter.
struct SpriteCamera {
    glm::dmat4 view_projection{1.0};
    glm::dvec3 eye_mm{0.0};
    glm::dvec3 forward{0.0, 0.0, -1.0};
    bool orthographic = false;
};

/// Largest summary at b and at 4 rings of 4 neighbours (+-x, +-y), 0.01, 0.02, 0.03, 0.04 UV away.
[[nodiscard]] double sprite_brightness(const Buffer& summary, glm::dvec2 base_uv);

/// Stage 5: all emitters of a pass, combined by max, into a target of the summary's size. Lengths (L, the
/// front view's size, the mask's reach) are measured in target heights: UV scaled by (width / height, 1), so
/// that sprites turn without shear on targets that are not square; on square ones this is UV. The sprite's
/// axis is its +v. View direction: from the eye to the base. An emitter with base on tip, or with a point
/// behind the eye or not finite, gives nothing; edge on tip gives no front sprite, and an axis that is seen
/// as a point (shorter than 1e-3 pixels) no side sprite.
[[nodiscard]] Buffer sprites(std::span<const Emitter> emitters, const Sprites& pictures,
                             const SpriteCamera& camera, const Buffer& summary);

/// Blush of the small vessels: main of an earlier time (t - delay), blurred by a separable Gaussian of
/// sigma [pixels], cut at ceil(3 sigma) and normalised, pixels beyond the border as the border; times gain,
/// clamped to [0, 1]. sigma <= 0: no blur.
[[nodiscard]] Buffer capillary(const Buffer& delayed_main, double sigma_pixels, double gain);

enum class Tone { beer_lambert, thesis };

/// mu of the Beer-Lambert tone with which ratio 1 darkens a background of 1 to `darkest`, in (0, 1).
[[nodiscard]] double extinction_for(double darkest);

/// Stage 6 at one pixel.
[[nodiscard]] double tone_contrast(double background, double ratio, Tone tone, double mu);

/// Stage 6: background (of any size, sampled linearly; one channel) darkened by the largest of the given
/// layers, which all have one size. No layers: the background at width x height.
[[nodiscard]] Buffer composite(const Buffer& background, std::span<const Buffer> layers, int width,
                               int height, Tone tone, double mu);

}  // namespace viscera::reference
