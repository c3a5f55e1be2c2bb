#include "samples/host_common/embedded_scene.h"

#include <array>
#include <iostream>

#include "effects/register_all.h"
#include "engine/core/scene.h"

namespace host {
namespace {

viscera::Registry all_effects() {
    viscera::Registry registry;
    viscera::register_all(registry);
    return registry;
}

void log(viscera::LogLevel level, std::string_view message) {
    if (level >= viscera::LogLevel::warning) {
        std::cerr << "viscera: " << message << '\n';
    }
}

}  // namespace

EmbeddedScene::EmbeddedScene(viscera::ProcAddress proc, const std::filesystem::path& scene)
    : registry_(all_effects()), renderer_(proc, registry_, {.log = log}) {
    // The scene names an array of the host's, from which its smoke gets more emitters.
    const viscera::SceneOverride contacts{"/passes/4/parameters/host_emitters", "contacts"};
    renderer_.set_scene(viscera::load_scene(scene, std::span(&contacts, 1)));
}

void EmbeddedScene::draw(double time_s, unsigned framebuffer, const viscera::PixelRect& viewport) {
    // A simulator would say here where contrast leaves the vessel: base, tip, edge [mm] and size of each.
    const std::array<float, 10> contact{24.1F, -26.7F, 16.9F,  44.0F, -30.0F,
                                        24.0F, 44.0F,  -28.0F, 27.0F, 1.2F};
    values_.set("contacts", contact);

    viscera::Frame frame = renderer_.still(time_s);
    frame.width = viewport.width;
    frame.height = viewport.height;
    frame.look(viscera::make_eyes(renderer_.scene().camera, frame.aspect(), time_s));
    frame.values = &values_;
    frame.present = {.enabled = true, .framebuffer = framebuffer, .viewport = viewport};
    frame.host_state = viscera::HostStatePolicy::restore;
    renderer_.render(frame);
}

}  // namespace host
