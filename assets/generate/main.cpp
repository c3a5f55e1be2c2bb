// Makes viscera's own assets: viscera_assets [FOLDER] [--seed N].

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "assets/generate/generate.h"

constexpr int usage_error = 2;

int main(int argc, char** argv) {
    std::string folder = "assets";
    std::uint64_t seed = viscera::assets::default_seed;
    CLI::App app{"Makes the meshes, centrelines, sprites, pictures and volumes that viscera's scenes use."};
    app.add_option("folder", folder, "Where meshes/, vessels/, sprites/, images/ and volumes/ go")
        ->capture_default_str();
    app.add_option("--seed", seed, "Another seed gives another patient")->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EXIT_SUCCESS : usage_error;
    }
    try {
        viscera::assets::generate_all(folder, seed);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "viscera_assets: %s\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
