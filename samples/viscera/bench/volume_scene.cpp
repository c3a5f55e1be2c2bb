#include "samples/viscera/bench/volume_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <glm/gtc/matrix_transform.hpp>

#include "engine/core/error.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {

VolumeScene::VolumeScene(const Lab& lab, std::string_view name)
    : width_(lab.options().width), height_(lab.options().height) {
    const std::filesystem::path file = lab.options().assets / "scenes" / (std::string(name) + ".json");
    std::ifstream stream(file);
    if (!stream) {
        throw Error(ErrorCode::file, file.string(), "cannot be opened; --assets names the folder");
    }
    scene_ = nlohmann::json::parse(stream);
    parameters_ = scene_["passes"][0]["parameters"];
    scene_["passes"] = nlohmann::json::array();
    scene_["targets"] = nlohmann::json::object();
    scene_["outputs"] = nlohmann::json::array();
}

std::string key(std::size_t i) {
    return "variant." + std::to_string(i);
}

nlohmann::json VolumeScene::json(std::span<const Variant> variants, std::string_view format,
                                 double scale) const {
    SceneText text(scene_);
    for (std::size_t i = 0; i < variants.size(); ++i) {
        nlohmann::json parameters = parameters_;
        parameters.merge_patch(variants[i].changes);
        text.target(key(i), format).output(key(i));
        text.pass(key(i), variants[i].effect, parameters, {{"colour", key(i)}});
    }
    nlohmann::json scene = text.json();
    const auto scaled = [scale](int n) { return std::max(1, static_cast<int>(std::lround(scale * n))); };
    scene["resolution"] = {scaled(width_), scaled(height_)};
    return scene;
}

nlohmann::json exact_composite() {
    return {{"transfer_function", {{"interpolate", true}}},
            {"sampling",
             {{"scheme", "gauss"},
              {"step", 1.0 / 16},
              {"filter", "linear_fp32"},
              {"termination", 0.0},
              {"tolerance", 0.0},
              {"jitter", "none"},
              {"skip", true}}}};
}

nlohmann::json exact_cells() {
    nlohmann::json changes = exact_composite();
    changes["sampling"]["scheme"] = "cell";
    return changes;
}

std::vector<PictureQuality> judge(Lab& lab, const VolumeScene& scene, std::span<const Judged> judged,
                                  double scale) {
    std::vector<Variant> variants;
    for (const Judged& one : judged) {
        variants.push_back(one.variant);
        variants.push_back({"", one.variant.changes, "bench.ray_count"});
        if (!one.exact.is_null()) {
            variants.push_back(one.variant);
            variants.back().changes.merge_patch(one.exact);
        }
    }
    Stage stage(lab, scene.json(variants, "rgba32f", scale), {.by_pass = false});
    Frame frame = stage.renderer().still(0.0);
    frame.host_state = HostStatePolicy::host_resets;  // what an earlier renderer left in use is gone
    (void)stage.renderer().render(frame);
    std::vector<PictureQuality> qualities;
    Image exact;
    std::size_t next = 0;
    for (const Judged& one : judged) {
        const Image picture = stage.read(key(next++));
        const Image count = stage.read(key(next++));
        if (!one.exact.is_null()) {
            exact = stage.read(key(next++));
        }
        double samples = 0.0;
        for (int y = 0; y < count.height; ++y) {
            for (int x = 0; x < count.width; ++x) {
                samples += static_cast<double>(count.at(x, y, 0));
            }
        }
        qualities.push_back(
            {compare(picture, exact, {}), samples / (static_cast<double>(count.width) * count.height)});
    }
    return qualities;
}

void nudge(Frame& frame) {
    glm::dmat4& view = frame.eyes[0].view;
    view = glm::translate(view, glm::dvec3(1e-9 * static_cast<double>(frame.index), 0.0, 0.0));
}

}  // namespace viscera::app
