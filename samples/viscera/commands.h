#pragma once

#include <CLI/CLI.hpp>

namespace viscera::app {

/// Each adds one subcommand. When the user chose it, it runs while the line is parsed and leaves its exit
/// code in `exit_code` (0 ok, 1 images differ); errors leave by exception.
void add_render(CLI::App& app, int& exit_code);
void add_view(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_diff(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
void add_backends(CLI::App& app, int& exit_code);
void add_schema(CLI::App& app, int& exit_code);

}  // namespace viscera::app
