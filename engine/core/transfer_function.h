#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/params.h"

namespace viscera {

/// A knot of a piecewise linear transfer function. Two knots at one value make a step there.
struct TransferPoint {
    double value = 0.0;      ///< in the volume's own unit (HU for CT)
    glm::dvec3 colour{1.0};  ///< linear, [0, 1]
    double opacity = 0.0;    ///< [0, 1] per reference length

    void visit(ParamVisitor& v);
    bool operator==(const TransferPoint&) const = default;
};

/// A knot of the second axis: factor on the opacity by gradient magnitude.
struct GradientPoint {
    double gradient = 0.0;  ///< value unit per mm, >= 0
    double factor = 1.0;    ///< [0, 1]

    void visit(ParamVisitor& v);
    bool operator==(const GradientPoint&) const = default;
};

/// Blinn-Phong coefficients.
struct Lighting {
    double ambient = 0.2;
    double diffuse = 0.7;
    double specular = 0.3;
    double shininess = 20.0;

    void visit(ParamVisitor& v);
    bool operator==(const Lighting&) const = default;
};

/// How a preset wants its volume shown.
enum class Technique { composite, mip, minip, average, isosurface, xray };
[[nodiscard]] std::span<const std::string_view> choice_names(Technique technique);

/// Colour and opacity over value. Opacity A0 is per `reference_length_mm`; over a length ds it is
/// 1 - (1 - A0)^(ds / reference_length). Constant beyond the first and last knot. Linear between knots.
struct TransferFunction {
    std::vector<TransferPoint> points;    ///< ascending by value
    std::vector<GradientPoint> gradient;  ///< ascending; empty: no second axis
    double reference_length_mm = 1.0;     ///< > 0
    bool shaded = false;
    Lighting lighting;
    Technique technique = Technique::composite;
    bool nearest = false;  ///< the preset asks for no interpolation between voxels
    std::string name;

    bool operator==(const TransferFunction&) const = default;
};

/// Points sorted (stable), values outside ranges cut, entries that are not finite dropped; an empty function
/// is one transparent point. `faults` counts what was dropped or cut.
[[nodiscard]] TransferFunction normalised(TransferFunction function, std::size_t& faults);

/// Colour and opacity at a value; at a step, the right side's. NaN: transparent.
[[nodiscard]] glm::dvec4 evaluate(const TransferFunction& function, double value);
/// Extinction [1/mm] of an opacity per reference length: -log1p(-A0) / reference_length. Opacity 1 is taken
/// as 1 - 2^-24, so that it stays finite; at most 1e30.
[[nodiscard]] double extinction(double opacity, double reference_length_mm);

/// Window/level: grey ramp from level - width / 2 (black) to level + width / 2 (white), opacity the same
/// ramp. width > 0.
struct WindowLevel {
    double width = 400.0;
    double level = 40.0;

    void visit(ParamVisitor& v);
    bool operator==(const WindowLevel&) const = default;
};
struct WindowPreset {
    std::string_view name;  ///< "ct-bone"
    WindowLevel window;
    std::string_view doc;
};
/// The usual windows of CT reading [HU]: brain, subdural, stroke, bone, temporal bone, soft tissue, lung,
/// mediastinum, abdomen, liver, spine, angiography.
[[nodiscard]] std::span<const WindowPreset> window_presets();
[[nodiscard]] TransferFunction make_window(const WindowLevel& window);

/// Ranges of values in which the function is not transparent, ascending and disjoint, ends included; infinite
/// at the sides where the outer knot is opaque. Exact: opacity is piecewise linear.
struct ValueRange {
    double low = 0.0;
    double high = 0.0;
};
[[nodiscard]] std::vector<ValueRange> visible_ranges(const TransferFunction& function);

}  // namespace viscera
