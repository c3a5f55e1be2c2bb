#include <iostream>

#include "engine/core/plan_dump.h"
#include "engine/runtime/eye_scene.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/session.h"

namespace viscera::app {

void add_check(CLI::App& app, int& exit_code) {
    struct Arguments {
        SceneArguments scene;
        bool dot = false;
    };
    CLI::App* command =
        app.add_subcommand("check", "Reads a scene without OpenGL and prints what would run, and why");
    const auto arguments = std::make_shared<Arguments>();
    arguments->scene.add_to(*command);
    command->add_flag("--dot", arguments->dot, "as a Graphviz digraph");
    command->callback([arguments, &exit_code] {
        const Scene scene = arguments->scene.load();
        const SceneEffects effects = make_effects(scene, make_registry());
        const EyeScene passes(scene, effects, {}, {}, scene.camera.stereo ? 2 : 1);
        const Plan plan = compile_scene(scene, passes.graph(), scene.width, scene.height);
        std::cout << (arguments->dot ? to_dot(plan) : to_table(plan));
        exit_code = 0;
    });
}

}  // namespace viscera::app
