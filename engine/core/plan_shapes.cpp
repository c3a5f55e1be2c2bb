#include "engine/core/plan_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace viscera {
namespace {

constexpr double max_scale = 4.0;

int scaled(int frame, double scale) {
    constexpr double largest = std::numeric_limits<int>::max();
    return static_cast<int>(std::clamp(std::round(frame * scale), 1.0, largest));
}

/// Message of the fault, empty when the rule holds; the size goes to `shape`.
std::string apply_size(const SizeRule& rule, int width, int height, TargetShape& shape) {
    if (rule.width != 0 || rule.height != 0) {
        if (rule.width < 1 || rule.height < 1) {
            return "an absolute size needs width and height of at least 1";
        }
        shape.width = rule.width;
        shape.height = rule.height;
    } else {
        if (!(rule.scale > 0.0 && rule.scale <= max_scale)) {
            return "the scale of a size must lie in (0, 4]";
        }
        shape.width = scaled(std::max(width, 1), rule.scale);
        shape.height = scaled(std::max(height, 1), rule.scale);
    }
    constexpr std::int64_t largest = std::numeric_limits<int>::max();
    shape.width = static_cast<int>(std::min(largest, std::int64_t{shape.width} * std::max(rule.columns, 1)));
    return {};
}

}  // namespace

TargetShapes resolve_shapes(const Graph& graph, int width, int height, int max_size,
                            std::vector<Fault>& faults) {
    TargetShapes shapes;
    const auto fault = [&](const std::string& target, std::string message) {
        faults.push_back({"", "", target, std::move(message)});
    };
    if (width < 1 || height < 1) {
        fault("", "the frame must be at least 1x1 pixels, not " + std::to_string(width) + "x" +
                      std::to_string(height));
    }
    for (std::size_t i = 0; i < graph.imported.size(); ++i) {
        const ImportedTarget& imported = graph.imported[i];
        if (!is_target_name(imported.name)) {
            fault(imported.name, "is not a valid target name");
        }
        if (imported.width < 1 || imported.height < 1) {
            fault(imported.name, "an imported target must be at least 1x1 pixels");
        }
        const TargetShape shape{imported.format, imported.width, imported.height, {}, i, imported.writable};
        if (!shapes.emplace(imported.name, shape).second) {
            fault(imported.name, "is imported twice");
        }
    }
    for (const TargetDesc& target : graph.targets) {
        if (!is_target_name(target.name)) {
            fault(target.name, "is not a valid target name");
        }
        TargetShape shape{target.format, 1, 1, target.clear, std::nullopt, true};
        if (std::string message = apply_size(target.size, width, height, shape); !message.empty()) {
            fault(target.name, std::move(message));
        }
        if (shape.width > max_size || shape.height > max_size) {
            fault(target.name, "size " + std::to_string(shape.width) + "x" + std::to_string(shape.height) +
                                   " is beyond the device's limit of " + std::to_string(max_size));
            faults.back().limit = true;
        }
        if (!std::ranges::all_of(target.clear, [](float value) { return std::isfinite(value); })) {
            fault(target.name, "the clear value must be finite");
        }
        const auto [entry, is_new] = shapes.emplace(target.name, shape);
        if (!is_new) {
            fault(target.name,
                  entry->second.imported ? "is imported and described too" : "is described twice");
        }
    }
    return shapes;
}

}  // namespace viscera
