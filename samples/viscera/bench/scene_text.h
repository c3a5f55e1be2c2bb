#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace viscera::app {

/// A scene put together pass by pass.
class SceneText {
  public:
    explicit SceneText(nlohmann::json scene) : scene_(std::move(scene)) {}

    /// Null: no parameters, no targets but the default ones.
    SceneText& pass(std::string_view name, std::string_view effect, nlohmann::json parameters = nullptr,
                    nlohmann::json targets = nullptr) {
        for (nlohmann::json* part : {&parameters, &targets}) {
            *part = part->is_null() ? nlohmann::json::object() : std::move(*part);
        }
        scene_["passes"].push_back({{"name", name},
                                    {"effect", effect},
                                    {"parameters", std::move(parameters)},
                                    {"targets", std::move(targets)}});
        return *this;
    }
    /// A pass as scenes give it.
    SceneText& add(nlohmann::json pass) {
        scene_["passes"].push_back(std::move(pass));
        return *this;
    }
    SceneText& target(const std::string& name, std::string_view format, double scale = 1.0) {
        scene_["targets"][name] = {{"format", format}, {"scale", scale}};
        return *this;
    }
    SceneText& output(std::string_view name) {
        scene_["outputs"].push_back(name);
        return *this;
    }
    [[nodiscard]] const nlohmann::json& json() const { return scene_; }

  private:
    nlohmann::json scene_;
};

/// The vessels of the default scene, as a geometry pass takes them.
[[nodiscard]] inline nlohmann::json coronary(nlohmann::json more = nlohmann::json::object()) {
    more["$ref"] = "#/shared/coronary";
    return more;
}

}  // namespace viscera::app
