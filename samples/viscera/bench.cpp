#include <algorithm>
#include <fstream>
#include <iostream>

#include "engine/core/error.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/report.h"
#include "samples/viscera/bench/scene_case.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/session.h"

namespace viscera::app {
namespace {

struct BenchArguments {
    std::vector<std::string> cases;
    ContextArguments context;
    ComputeArgument compute;
    std::string resolution = "1024x1024";
    int repeats = 20;
    std::filesystem::path assets = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets";
    std::filesystem::path report;
    std::filesystem::path scene;
    std::vector<std::string> overrides;
    std::filesystem::path pixels;
    std::filesystem::path glsl;
    bool list = false;
};

std::vector<const Case*> choose(const std::vector<std::string>& names) {
    std::vector<const Case*> chosen;
    for (const std::string& name : names) {
        const auto found = std::ranges::find(all_cases(), name, &Case::name);
        if (found == all_cases().end()) {
            throw Error(ErrorCode::usage, name, "is no case; --list names them");
        }
        chosen.push_back(&*found);
    }
    if (names.empty()) {
        for (const Case& one : all_cases()) {
            chosen.push_back(&one);
        }
    }
    return chosen;
}

int bench(const BenchArguments& arguments) {
    if (arguments.list) {
        for (const Case& one : all_cases()) {
            std::cout << one.name << ": " << one.doc << '\n';
        }
        return 0;
    }
    const std::vector<const Case*> chosen =
        arguments.scene.empty() ? choose(arguments.cases) : std::vector<const Case*>();
    std::vector<SceneOverride> overrides;
    for (const std::string& text : arguments.overrides) {
        overrides.push_back(parse_override(text));
    }
    const auto [width, height] = parse_resolution(arguments.resolution);
    const std::unique_ptr<Context> context = arguments.context.open();
    Lab lab(*context, {.assets = std::filesystem::absolute(arguments.assets),
                       .width = width,
                       .height = height,
                       .repeats = arguments.repeats,
                       .log = stderr_log(),
                       .compute = arguments.compute.value(),
                       .glsl = arguments.glsl});
    for (const Case* one : chosen) {
        std::cerr << "bench: " << one->name << '\n';
        const std::size_t before = lab.rows().size();
        one->run(lab);
        print_table(std::cout, std::span(lab.rows()).subspan(before), lab.hardware());
        std::cout.flush();
    }
    if (!arguments.scene.empty()) {
        Scene scene = load_scene(arguments.scene, overrides);
        scene.width = width;
        scene.height = height;
        run_scene(lab, scene, arguments.pixels);
        print_table(std::cout, lab.rows(), lab.hardware());
    }
    if (!arguments.report.empty()) {
        const ContextInfo& info = context->info();
        const nlohmann::json document{{"backend", to_string(info.backend)},
                                      {"renderer", info.renderer},
                                      {"version", info.version},
                                      {"software", info.software},
                                      {"clock", lab.hardware() ? "timer queries" : "wall clock, glFinish"},
                                      {"resolution", {width, height}},
                                      {"repeats", arguments.repeats},
                                      {"rows", to_json(lab.rows(), lab.hardware())}};
        std::ofstream file(arguments.report);
        file << document.dump(2) << '\n';
        if (!file.flush()) {
            throw Error(ErrorCode::file, arguments.report.string(), "cannot write the report");
        }
    }
    return 0;
}

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "bench", "Measures the machine's ceilings, then time and error of each part as ratios to them");
    const auto arguments = std::make_shared<BenchArguments>();
    command->add_option("CASE", arguments->cases, "cases to run; none: all of them")->default_str("");
    arguments->context.add_to(*command);
    arguments->compute.add_to(*command);
    command->add_option("--resolution", arguments->resolution, "WxH");
    command->add_option("--repeats", arguments->repeats, "measured frames per figure")
        ->check(CLI::Range(1, 100000));
    command->add_option("--assets", arguments->assets, "folder with scenes, meshes and pictures");
    command->add_option("--report", arguments->report, "writes every row as JSON");
    CLI::Option* const scene =
        command->add_option("--scene", arguments->scene, "times this scene's frames in place of the cases");
    command
        ->add_option("--set", arguments->overrides,
                     "/json/pointer=value: changes --scene before it is read; may be given many times")
        ->take_all()
        ->allow_extra_args(false)
        ->default_str("")
        ->needs(scene);
    command
        ->add_option("--pixels", arguments->pixels,
                     "writes the first output of --scene as float32, top row first")
        ->needs(scene);
    command
        ->add_option("--glsl", arguments->glsl,
                     "shaders in this folder come before those of the same names in the binary")
        ->check(CLI::ExistingDirectory);
    command->add_flag("--list", arguments->list, "names the cases and stops");
    command->callback([arguments, &exit_code] { exit_code = bench(*arguments); });
}

}  // namespace viscera::app
