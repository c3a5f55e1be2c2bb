#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/buffer.h"

namespace viscera::reference {

/// spec/tissue.md, 'Organ', in double precision: formulas as they are published, no rearrangement.

struct Burn {
    double coagulated = 0.0;
    double charred = 0.0;
};
[[nodiscard]] Burn burn_of(double energy, bool thesis_curve);

/// Normal of a surface whose height rises by `rise` over the steps px and py (Mikkelsen).
[[nodiscard]] glm::dvec3 bumped(const glm::dvec3& normal, const glm::dvec3& px, const glm::dvec3& py,
                                const glm::dvec2& rise);

struct Focus {
    double near_mm = 0.0;
    double focus_mm = 1.0;
    double far_mm = 2.0;
    double clamp_near = 1.0;
    double clamp_far = 1.0;
};
[[nodiscard]] double stored_blurriness(const Focus& focus, double depth_mm);

struct OrganLight {
    glm::dvec3 place{0.0};  ///< in the eye's frame [mm], or a direction there
    bool infinite = false;
    glm::dvec3 colour{1.0};
    double falloff_mm = 0.0;  ///< 0: none
    double angular = 0.0;
    double glow_mm = 0.0;
    double glow_per_mm2 = 2.0;
};

/// A picture on the organ and how it is read.
struct OrganMap {
    Buffer picture;
    bool repeats = false;
    double repeat = 1.0;
    [[nodiscard]] bool empty() const { return picture.empty(); }
    /// Of files: each the mean of 2 x 2 texels of the one before, whose sides are powers of two. None: the
    /// picture at any distance.
    std::vector<Buffer> smaller;
    void make_smaller();
    [[nodiscard]] double at(const glm::dvec2& uv, int channel) const;
    /// Between the two levels around the one whose texels are as large as a pixel's longer side, weighted by
    /// how far it is from each. ux, uy: steps of uv from pixel to pixel. `nearer`: what is added to the
    /// smaller one's weight.
    [[nodiscard]] double at(const glm::dvec2& uv, int channel, const glm::dvec2& ux, const glm::dvec2& uy,
                            double nearer) const;
};

struct Organ {
    // in the world [mm]
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;
    std::vector<glm::dvec2> uvs;
    std::vector<double> cut;  ///< per vertex; empty: the cut map's alpha says it
    std::vector<std::uint32_t> indices;
    glm::dmat4 view{1.0};
    glm::dmat4 projection{1.0};
    bool orthographic = false;
    double slant = 0.0;  ///< of parallel rays along x, for an eye of two

    glm::dvec3 colour{1.0};
    OrganMap diffuse;
    OrganMap slopes;  ///< [mm/mm] along dP/du and dP/dv
    OrganMap energy;
    OrganMap blood;
    OrganMap blood_normal;
    OrganMap blood_height;
    OrganMap cut_map;
    OrganMap hint;

    double bump = 1.0;        ///< factor on slopes
    double blood_bump = 1.0;  ///< of blood_normal or blood_height
    double bump_gain = 10.0;
    glm::dvec3 coagulation_colour{1.0};
    double saturation = 1.0;
    double brightness = 1.0;
    bool thesis_burn = false;
    double hint_share = 0.0;
    std::vector<glm::dvec4> spots;  ///< centre in the world or (u, v, 0), radius
    bool spots_in_uv = false;
    glm::dvec3 hematoma_colour{0.0};
    double hematoma_strength = 0.0;

    double ambient = 0.0;
    double diffuse_share = 1.0;
    double specular = 0.0;
    glm::dvec3 specular_colour{1.0};
    double shininess = 10.0;
    std::vector<OrganLight> lights;
    std::optional<Focus> focus;
    bool blended = false;
    double opacity = 1.0;
    double nearer = 0.0;  ///< see OrganMap: GPUs round these weights
    bool front = true;    ///< faces that are drawn
    bool back = true;
};

/// The picture, 4 channels, over `background` (its alpha is the stored blurriness of nothing).
/// Fragments are 2 x 2 differences apart, as GPUs take derivatives.
[[nodiscard]] Buffer organ_picture(const Organ& organ, int width, int height, const glm::dvec4& background);

/// How many of `taps` places a disc of this radius [pixels] is read at: as few as leave the mean of white
/// noise no further off than all of them leave that of a wide disc; 0 for discs within their pixel.
[[nodiscard]] int taps_within(double radius_pixels, int taps);

/// Gather of a picture with stored blurriness in alpha. radius_pixels: at blurriness 1; spiral: places of
/// which the first n fill a disc of radius sqrt(n). `undecided`: pixels that a float may find other texels
/// for, row by row.
[[nodiscard]] Buffer depth_of_field(const Buffer& picture, double radius_pixels,
                                    const std::vector<glm::dvec2>& spiral, std::vector<char>& undecided);

}  // namespace viscera::reference
