#include <iostream>

#include "engine/context/context.h"
#include "samples/viscera/commands.h"

namespace viscera::app {

void add_backends(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "backends", "Tries every way to an OpenGL context and says why those refused were");
    command->callback([&exit_code] {
        for (const BackendReport& report : probe_backends()) {
            std::cout << to_string(report.backend);
            if (report.info && report.info->egl_device) {
                std::cout << " --egl-device " << *report.info->egl_device;
            }
            if (report.info) {
                std::cout << ": " << report.info->renderer << ", OpenGL " << report.info->version
                          << (report.info->software ? ", software" : ", hardware");
            } else {
                std::cout << ": refused";
            }
            std::cout << (report.why.empty() ? "" : ": " + report.why) << '\n';
        }
        exit_code = 0;
    });
}

}  // namespace viscera::app
