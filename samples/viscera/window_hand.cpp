#include "samples/viscera/window_hand.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "effects/volume/transfer_params.h"
#include "engine/core/params_json.h"
#include "engine/io/transfer_function.h"

namespace viscera::app {
namespace {

/// Values of the first and last knot of a pass's transfer function; none when it has none.
std::optional<glm::dvec2> knots_of(const ScenePass& pass, const std::filesystem::path& base, Log& log) {
    const auto found = pass.parameters.find("transfer_function");
    if (!pass.effect.starts_with("volume.") || found == pass.parameters.end()) {
        return std::nullopt;
    }
    volume::TransferParams params;
    std::vector<JsonFault> faults;  // none: the renderer has taken the scene
    read_params(
        *found, "", base, [&](ParamVisitor& v) { params.visit(v); }, faults);
    if (params.range) {
        return params.range;
    }
    const std::vector<TransferFunction> presets = params.file.empty()
                                                      ? std::vector<TransferFunction>{}
                                                      : io::load_transfer_functions(params.file.path, log);
    const TransferFunction function = volume::chosen_function(params, presets);
    if (function.points.empty()) {
        return std::nullopt;
    }
    const auto [least, most] = std::ranges::minmax(function.points, {}, &TransferPoint::value);
    return glm::dvec2(least.value, most.value);
}

}  // namespace

WindowHand::WindowHand(Renderer& renderer) : renderer_(renderer) {
    const Scene& scene = renderer.scene();
    for (const ScenePass& pass : scene.passes) {
        const auto knots = knots_of(pass, scene.file.parent_path(), renderer.log());
        if (knots && knots->x != knots->y) {
            windows_.push_back({pass.name, *knots, *knots});
        }
    }
}

void WindowHand::drag(double x, double y) {
    for (Window& window : windows_) {
        const double width = window.range.y - window.range.x;
        const double level = 0.5 * (window.range.x + window.range.y) + y * width;
        // Neither nothing nor beyond what a number holds, however far the hand goes.
        const double given = std::abs(window.given.y - window.given.x);
        const double size = std::clamp(std::abs(width) * std::exp(2.0 * x), 1e-3 * given, 1e3 * given);
        const double half = std::copysign(0.5 * size, width);
        set(window, {level - half, level + half});
    }
}

void WindowHand::reset() {
    for (Window& window : windows_) {
        if (window.range != window.given) {
            set(window, window.given);
        }
    }
}

void WindowHand::set(Window& window, const glm::dvec2& range) {
    window.range = range;
    renderer_.set_parameter(window.pass, "/transfer_function/range", nlohmann::json{range.x, range.y});
    ++revision_;
}

}  // namespace viscera::app
