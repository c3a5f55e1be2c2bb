#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/camera.h"
#include "engine/core/params.h"
#include "engine/core/pixel_format.h"
#include "engine/core/timeline.h"

namespace viscera {

[[nodiscard]] std::span<const std::string_view> choice_names(PixelFormat format);

constexpr int largest_side = 16384;  ///< of a frame or a target [pixels]

/// What stands at the top of a scene file, but for the keys in `others`.
struct SceneFields {
    std::string schema;
    int version = 1;
    std::string name;
    std::string description;
    std::vector<int> resolution{1024, 1024};
    double time_s = 0.0;
    double frames_per_second = 30.0;
    CameraParams camera;
    std::vector<std::string> outputs;
    std::vector<TimelineTrack> timeline;

    static constexpr std::array<std::string_view, 3> others{"shared", "targets", "passes"};
    void visit(ParamVisitor& v);
};

struct SceneTargetFields {
    std::optional<PixelFormat> format;
    std::optional<double> scale;
    std::optional<std::vector<int>> size;
    std::optional<std::vector<double>> clear;

    void visit(ParamVisitor& v);
};

struct ScenePassFields {
    std::string name;
    std::string effect;
    bool enabled = true;

    static constexpr std::array<std::string_view, 2> others{"parameters", "targets"};
    void visit(ParamVisitor& v);
};

}  // namespace viscera
