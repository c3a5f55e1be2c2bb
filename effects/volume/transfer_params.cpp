#include "effects/volume/transfer_params.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/io/transfer_function.h"

namespace viscera::volume {
namespace {

std::string listed(auto&& range, auto name) {
    std::string text;
    for (const auto& item : range) {
        text += (text.empty() ? "" : ", ") + std::string(name(item));
    }
    return text;
}

const TransferFunction& find_preset(std::span<const TransferFunction> presets, const TransferParams& params) {
    const auto names = [&] { return listed(presets, [](const TransferFunction& f) { return f.name; }); };
    const auto found = std::ranges::find(presets, params.preset, &TransferFunction::name);
    if (found != presets.end()) {
        return *found;
    }
    if (params.preset.empty() && presets.size() == 1) {
        return presets.front();
    }
    throw Error(ErrorCode::scene, "/transfer_function/preset",
                params.preset.empty()
                    ? params.file.path.string() + " has several presets; name one of: " + names()
                    : "no preset '" + params.preset + "' in " + params.file.path.string() +
                          "; there are: " + names());
}

TransferFunction find_window(const std::string& name) {
    const auto found = std::ranges::find(window_presets(), name, &WindowPreset::name);
    if (found == window_presets().end()) {
        throw Error(ErrorCode::scene, "/transfer_function/preset",
                    "no window '" + name + "'; there are: " +
                        listed(window_presets(), [](const WindowPreset& p) { return p.name; }));
    }
    return make_window(found->window);
}

}  // namespace

void TransferParams::visit(ParamVisitor& v) {
    v.field({.name = "points", .doc = "Knots by value; linear between them, constant beyond them."}, points);
    v.field({.name = "gradient", .doc = "Factor on the opacity by gradient magnitude."}, gradient);
    v.field({.name = "reference_length_mm",
             .doc = "Length that the opacities of points and windows are given for; files bring their own.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            reference_length_mm);
    v.field({.name = "file",
             .doc = "Transfer function of 3D Slicer (.vp, .vp.json), ParaView (.json) or viscera (.json), "
                    "instead of points."},
            file);
    v.field(
        {.name = "preset",
         .doc = "Name of one preset in the file, or a window for CT (ct-bone, ...) when there is no file."},
        preset);
    v.field({.name = "window", .doc = "Grey ramp instead of points."}, window);
    v.field({.name = "range", .doc = "Stretches the knots from their own range to these two values."}, range);
    v.field({.name = "entries", .doc = "Entries of the table on the GPU.", .min = 2, .max = 16384}, entries);
    v.field({.name = "interpolate",
             .doc = "Interpolates between the table's entries: exact for steep ramps, at a second fetch."},
            interpolate);
}

bool TransferParams::empty() const {
    return points.empty() && file.empty() && preset.empty() && !window;
}

void TransferParams::validate() const {
    const int sources = static_cast<int>(!points.empty()) + static_cast<int>(!file.empty()) +
                        static_cast<int>(file.empty() && !preset.empty()) +
                        static_cast<int>(window.has_value());
    if (sources > 1) {
        throw Error(ErrorCode::scene, "/transfer_function",
                    "give one of points, file, preset (without a file: a window's name) and window");
    }
    if (file.empty() && !preset.empty()) {
        (void)find_window(preset);
    }
}

TransferFunction stretched(TransferFunction function, const glm::dvec2& range) {
    if (function.points.empty()) {
        return function;
    }
    const auto [least, most] =
        std::ranges::minmax(function.points, {}, [](const TransferPoint& p) { return p.value; });
    const double low = least.value;
    const double width = most.value - low;
    for (TransferPoint& point : function.points) {
        const double share = width > 0.0 ? (point.value - low) / width : 0.0;
        point.value = range.x + share * (range.y - range.x);
    }
    if (range.x > range.y) {
        std::ranges::reverse(function.points);  // the sides of a step change places, too
    }
    return function;
}

TransferFunction chosen_function(const TransferParams& params, std::span<const TransferFunction> presets) {
    TransferFunction function;
    if (!params.file.empty()) {
        function = find_preset(presets, params);
    } else {
        if (params.window) {
            function = make_window(*params.window);
        } else if (!params.preset.empty()) {
            function = find_window(params.preset);
        } else {
            function.points = params.points;
        }
        function.reference_length_mm = params.reference_length_mm;
    }
    if (!params.gradient.empty()) {
        function.gradient = params.gradient;
    }
    return params.range ? stretched(std::move(function), *params.range) : function;
}

TransferFunction load_function(const TransferParams& params, Assets& assets) {
    using Presets = std::vector<TransferFunction>;
    std::shared_ptr<Presets> presets;
    if (!params.file.empty()) {
        presets = assets.shared<Presets>(assets.file_key(params.file.path), [&] {
            return std::make_shared<Presets>(io::load_transfer_functions(params.file.path, assets.log()));
        });
    }
    std::size_t faults = 0;
    TransferFunction function = normalised(chosen_function(params, presets ? *presets : Presets{}), faults);
    if (faults > 0) {
        assets.log().fault("volume.transfer_function", "knots of the transfer function were out of range",
                           faults);
    }
    return function;
}

}  // namespace viscera::volume
