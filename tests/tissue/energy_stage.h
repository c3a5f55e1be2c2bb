#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/reference/tissue_energy.h"
#include "tests/tissue/plane.h"

namespace viscera::test {

/// A plane under contacts that the host brings.
class EnergyStage {
  public:
    explicit EnergyStage(const nlohmann::json& coagulate = nlohmann::json::object(), const Plane& plane = {},
                         const std::string& name = "plane", int size = 128,
                         const std::string& format = "r32f",
                         const std::function<ProcAddress(ProcAddress)>& watched = {})
        : stage(Backend::osmesa, {}, ComputeUse::automatic, BackgroundFill::automatic, watched), size_(size) {
        stage.load(scene(coagulate, plane, name, size, format));
    }
    [[nodiscard]] static nlohmann::json scene(const nlohmann::json& coagulate = nlohmann::json::object(),
                                              const Plane& plane = {}, const std::string& name = "plane",
                                              int size = 128, const std::string& format = "r32f") {
        const nlohmann::json mesh{{"file", plane.write(name).string()}};
        nlohmann::json parameters{{"mesh", mesh}, {"size", size}};
        if (!coagulate.is_null()) {
            parameters.update(coagulate);
        }
        for (auto item = parameters.begin(); item != parameters.end();) {
            item = item->is_null() ? parameters.erase(item) : std::next(item);
        }
        nlohmann::json scene =
            scene_of({{"kind", "orthographic"}}, nlohmann::json::array(), {"tissue.energy"}, 32, 32);
        scene.erase("camera");
        scene["passes"].push_back(pass("bake", "tissue.bake", {{"mesh", mesh}, {"size", size}}));
        scene["passes"].push_back(pass("coagulate", "tissue.coagulate", parameters));
        scene["outputs"] = {"tissue.energy", "tissue.position"};
        scene["targets"]["tissue.energy"]["format"] = format;
        return scene;
    }

    struct HostContact {
        double x = 0.0;
        double y = 0.0;
        double z = 0.0;
        double power = 1.0;
        double sigma = 2.0;
        reference::Action action = reference::Action::coagulate;
    };
    void contacts(const std::vector<HostContact>& list) {
        std::vector<float> floats;
        for (const HostContact& c : list) {
            for (const double value : {c.x, c.y, c.z, c.power, c.sigma, static_cast<double>(c.action)}) {
                floats.push_back(static_cast<float>(value));
            }
        }
        values.set("tissue.contacts", floats);
    }
    PassReport frame(double time_s) { return pass_of(stage.render(time_s, &values), "coagulate"); }
    Image energy() { return stage.renderer().read("tissue.energy"); }
    Image position() { return stage.renderer().read("tissue.position"); }

    /// Calls f(place, energy) for each texel inside a chart.
    template <class F>
    void each_texel(F f, int step = 1) {
        const Image places = position();
        const Image energies = energy();
        for (int y = 0; y < size_; y += step) {
            for (int x = 0; x < size_; x += step) {
                if (places.at(x, y, 3) == 1.0F) {
                    f(glm::dvec3(places.at(x, y, 0), places.at(x, y, 1), places.at(x, y, 2)),
                      static_cast<double>(energies.at(x, y, 0)));
                }
            }
        }
    }

    Stage stage;
    HostValues values;

  private:
    int size_;
};

}  // namespace viscera::test
