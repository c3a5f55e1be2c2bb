#include <cstdlib>
#include <iostream>
#include <new>

#include "engine/core/error.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/interruption.h"

namespace {

int run(int argc, char** argv) {
    CLI::App app{"Effects for medical simulators: X-ray contrast, drawn from scene files.", "viscera"};
    app.require_subcommand(1);
    app.set_version_flag("--version", VISCERA_VERSION);
    int exit_code = EXIT_SUCCESS;
    for (const auto add : {viscera::app::add_render, viscera::app::add_view, viscera::app::add_check,
                           viscera::app::add_diff, viscera::app::add_info, viscera::app::add_bench,
                           viscera::app::add_backends, viscera::app::add_schema}) {
        add(app, exit_code);
    }
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
