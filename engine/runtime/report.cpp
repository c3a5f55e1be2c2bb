#include "engine/runtime/report.h"

#include <nlohmann/json.hpp>

#include "engine/core/eyes.h"

namespace viscera {

std::string_view to_string(DrawPath path) {
    return path == DrawPath::compute ? "compute" : "fragment";
}

nlohmann::json to_json(const FrameReport& report) {
    nlohmann::json passes = nlohmann::json::array();
    for (const PassReport& pass : report.passes) {
        passes.push_back({{"name", pass.name},
                          {"effect", pass.effect},
                          {"eye", pass.eye < 0 ? nlohmann::json() : nlohmann::json(eye_word(pass.eye))},
                          {"status", to_string(pass.status)},
                          {"reason", pass.reason},
                          {"path", pass.path ? nlohmann::json(to_string(*pass.path)) : nlohmann::json()},
                          {"cpu_ms", pass.cpu_ms},
                          {"gpu_ms", pass.gpu_ms ? nlohmann::json(*pass.gpu_ms) : nlohmann::json()}});
    }
    nlohmann::json targets = nlohmann::json::array();
    for (const TargetReport& target : report.targets) {
        targets.push_back({{"name", target.name},
                           {"format", info(target.format).name},
                           {"width", target.width},
                           {"height", target.height},
                           {"file", target.file},
                           {"min", target.min},
                           {"max", target.max},
                           {"nan", target.nan},
                           {"inf", target.inf}});
    }
    return {{"frame", report.index},
            {"time_s", report.time_s},
            {"cpu_ms", report.cpu_ms},
            {"passes", std::move(passes)},
            {"targets", std::move(targets)}};
}

}  // namespace viscera
