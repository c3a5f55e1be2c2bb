#include <iostream>

#include <nlohmann/json.hpp>

#include "engine/core/scene.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/session.h"

namespace viscera::app {
namespace {

void print_markdown(const Registry& registry) {
    std::cout << "# Effects and their parameters\n\nMade by `viscera schema --markdown`.\n";
    for (const Registry::Entry& entry : registry.entries()) {
        const std::unique_ptr<Effect> effect = entry.make();
        std::cout << "\n## `" << entry.name << "`\n\n"
                  << entry.doc << "\n\n| port | access | target | meaning |\n| --- | --- | --- | --- |\n";
        for (const Port& port : effect->ports()) {
            std::cout << "| `" << port.name << "` | " << to_string(port.access)
                      << (port.optional ? ", optional" : "") << " | "
                      << (port.target.empty() ? "-" : "`" + port.target + "`") << " | " << port.doc << " |\n";
        }
        std::cout << '\n' << params_markdown([&](ParamVisitor& v) { effect->visit(v); });
    }
}

}  // namespace

void add_schema(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand("schema", "Prints the JSON Schema of scene files");
    const auto markdown = std::make_shared<bool>(false);
    command->add_flag("--markdown", *markdown,
                      "the effects with their ports and parameters as Markdown instead");
    command->callback([markdown, &exit_code] {
        const Registry registry = make_registry();
        if (*markdown) {
            print_markdown(registry);
        } else {
            std::vector<std::unique_ptr<Effect>> effects;
            std::vector<EffectSchema> schemas;
            for (const Registry::Entry& entry : registry.entries()) {
                effects.push_back(entry.make());
                schemas.push_back({entry.name, entry.doc,
                                   [effect = effects.back().get()](ParamVisitor& v) { effect->visit(v); }});
            }
            std::cout << scene_schema(schemas).dump(2) << '\n';
        }
        exit_code = 0;
    });
}

}  // namespace viscera::app
