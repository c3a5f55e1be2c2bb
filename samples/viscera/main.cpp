#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/params_json.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/interruption.h"

namespace {

/// A first word that is no command: CLI11 would say that a command is wanted, not that this is none.
void refuse_unknown(const CLI::App& app, int argc, char** argv) {
    const std::string word = argc > 1 ? argv[1] : "";
    std::vector<std::string> known;
    for (const CLI::App* command : app.get_subcommands({})) {
        known.push_back(command->get_name());
    }
    if (word.empty() || word.front() == '-' || std::ranges::find(known, word) != known.end()) {
        return;
    }
    const std::string_view near = viscera::nearest_word(word, known);
    throw viscera::Error(viscera::ErrorCode::usage, word,
                         near.empty() ? "is no command; viscera --help names them"
                                      : "is no command; did you mean '" + std::string(near) + "'?");
}

int run(int argc, char** argv) {
    CLI::App app{
        "Effects for medical simulators, drawn from scene files: X-ray contrast in vessels, volumes, and "
        "organs that bleed and are coagulated.",
        "viscera"};
    app.require_subcommand(1);
    app.set_version_flag("--version", VISCERA_VERSION);
    app.option_defaults()->always_capture_default();  // --help tells them
    int exit_code = EXIT_SUCCESS;
    for (const auto add : {viscera::app::add_render, viscera::app::add_view, viscera::app::add_check,
                           viscera::app::add_diff, viscera::app::add_info, viscera::app::add_bench,
                           viscera::app::add_backends, viscera::app::add_schema}) {
        add(app, exit_code);
    }
    refuse_unknown(app, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // CLI11 has exit codes of its own, above 100; ours has one for every wrong command line.
        return app.exit(error) == 0 ? EXIT_SUCCESS : static_cast<int>(viscera::ErrorCode::usage);
    }
    return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const viscera::Error& error) {
        std::cerr << "viscera: " << error.what() << '\n';
        return viscera::app::interrupted() ? viscera::app::interrupted_exit_code
                                           : static_cast<int>(error.code());
    } catch (const std::bad_alloc&) {
        std::cerr << "viscera: out of memory\n";
        return static_cast<int>(viscera::ErrorCode::limit);
    } catch (const std::exception& error) {
        std::cerr << "viscera: " << error.what() << '\n';
        return static_cast<int>(viscera::ErrorCode::usage);
    }
}
