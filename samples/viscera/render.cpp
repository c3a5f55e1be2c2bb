#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <mutex>
#include <sstream>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/runtime/frame_writer.h"
#include "engine/runtime/renderer.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/interruption.h"
#include "samples/viscera/session.h"

namespace viscera::app {
namespace {

struct RenderArguments {
    SceneArguments scene;
    ContextArguments context;
    ComputeArgument compute;
    CacheArgument cache;
    std::filesystem::path folder = "out";
    std::optional<double> time_s;
    std::string frames;
    std::string dump = "outputs";
    std::string png;
    std::string compression = "zip";
    bool multipart = false;
    std::filesystem::path report;
    std::filesystem::path glsl;
    bool progress = false;
    bool no_run_up = false;
};

struct FrameRange {
    std::uint64_t first = 0;
    std::uint64_t end = 1;
};

FrameRange parse_frames(const std::string& text) {
    FrameRange range;
    const std::size_t colon = text.find(':');
    const auto number = [&](std::string_view part) {
        std::uint64_t value = 0;
        const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (failure != std::errc{} || end != part.data() + part.size()) {
            throw Error(ErrorCode::usage, "--frames", "'" + text + "' is not A:B with A < B");
        }
        return value;
    };
    if (colon == std::string::npos) {
        range.first = number(text);
        range.end = range.first + 1;
        return range;
    }
    range = {number(std::string_view(text).substr(0, colon)),
             number(std::string_view(text).substr(colon + 1))};
    if (range.first >= range.end) {
        throw Error(ErrorCode::usage, "--frames", "'" + text + "' is not A:B with A < B");
    }
    return range;
}

/// A report that has no place to go is better known before hours of rendering than after.
void check_report(const std::filesystem::path& report) {
    const std::filesystem::path folder = report.has_parent_path() ? report.parent_path() : ".";
    if (!report.empty() &&
        (!std::filesystem::is_directory(folder) || std::filesystem::is_directory(report))) {
        throw Error(ErrorCode::file, report.string(), "the report cannot be written there");
    }
}

/// With --dump all every target is there; what else is not dumped is not written as PNG either.
void check_png(const std::vector<std::string>& png, const DumpRequest& dump,
               const std::vector<std::string>& outputs) {
    for (const std::string& name : png) {
        const auto among = [&](const std::vector<std::string>& names) {
            return std::ranges::any_of(
                names, [&](const std::string& n) { return n == name || name.starts_with(n + "."); });
        };
        if (dump.kind != DumpRequest::Kind::all && !among(dump.names) &&
            (dump.kind != DumpRequest::Kind::outputs || !among(outputs))) {
            throw Error(ErrorCode::usage, "--png", "'" + name + "' is not dumped; --dump names it as well");
        }
    }
}

/// Renders the frames that what comes next builds upon, without reading anything back.
void run_up(Renderer& renderer, double until_s) {
    const Scene& scene = renderer.scene();
    const double first = std::ceil(scene.time_s * scene.frames_per_second);
    for (double i = std::max(first, 0.0); i / scene.frames_per_second < until_s && !interrupted(); ++i) {
        Frame frame = renderer.frame(static_cast<std::uint64_t>(i));
        frame.capture = false;
        renderer.render(frame);
    }
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> names;
    std::istringstream stream(text);
    for (std::string name; std::getline(stream, name, ',');) {
        names.push_back(name);
    }
    return names;
}

DumpRequest parse_dump(const std::string& text) {
    if (text == "outputs") {
        return {DumpRequest::Kind::outputs, {}};
    }
    if (text == "all") {
        return {DumpRequest::Kind::all, {}};
    }
    DumpRequest dump{DumpRequest::Kind::names, split(text)};
    if (dump.names.empty()) {
        throw Error(ErrorCode::usage, "--dump", "names no target");
    }
    return dump;
}

io::ExrCompression parse_compression(const std::string& text) {
    const auto names = choice_names(io::ExrCompression::none);
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == text) {
            return static_cast<io::ExrCompression>(i);
        }
    }
    throw Error(ErrorCode::usage, "--exr-compression",
                "'" + text + "' is none of none, zips, zip, piz, dwaa");
}

std::vector<io::ExrAttribute> header(const Scene& scene, const ContextInfo& context) {
    const nlohmann::json camera =
        write_params([camera = scene.camera](ParamVisitor& v) mutable { camera.visit(v); });
    return {{"viscera:scene_hash", scene.hash},
            {"viscera:scene", scene.name},
            {"viscera:camera", camera.dump()},
            {"viscera:renderer", context.renderer + ", OpenGL " + context.version},
            {"viscera:backend", std::string(to_string(context.backend))}};
}

void print_frame(const FrameReport& report) {
    std::cout << "frame " << report.index << ", time " << std::fixed << std::setprecision(3) << report.time_s
              << " s, " << report.cpu_ms << " ms\n";
    for (const PassReport& pass : report.passes) {
        std::cout << "  " << std::left << std::setw(24) << pass.name << std::setw(9) << to_string(pass.status)
                  << std::right << std::setw(9) << pass.cpu_ms << " ms cpu  ";
        if (pass.gpu_ms) {
            std::cout << std::setw(9) << *pass.gpu_ms << " ms gpu  ";
        }
        if (pass.path == DrawPath::compute) {
            std::cout << "compute  ";
        }
        std::cout << pass.reason << '\n';
    }
}

nlohmann::json context_json(const ContextInfo& info) {
    return {{"backend", to_string(info.backend)},
            {"renderer", info.renderer},
            {"vendor", info.vendor},
            {"version", info.version},
            {"software", info.software}};
}

int render(const RenderArguments& arguments) {
    catch_interrupts();
    Scene scene = arguments.scene.load();
    const bool sequence = !arguments.frames.empty();
    if (sequence && arguments.time_s) {
        throw Error(ErrorCode::usage, "--time",
                    "a sequence of --frames has its own times: frame / frames_per_second");
    }
    if (arguments.time_s && !std::isfinite(*arguments.time_s)) {
        throw Error(ErrorCode::usage, "--time", "must be a finite number of seconds");
    }
    const FrameRange range = sequence ? parse_frames(arguments.frames) : FrameRange{};
    const DumpRequest dump = parse_dump(arguments.dump);
    const io::ExrCompression compression = parse_compression(arguments.compression);
    check_report(arguments.report);

    const std::unique_ptr<Context> context = arguments.context.open();
    const Registry registry = make_registry();
    RendererOptions options{.log = stderr_log(), .compute = arguments.compute.value()};
    if (!arguments.glsl.empty()) {
        options.shaders = shader_reader_from_folder(arguments.glsl);
    }
    options.cache_folder = arguments.cache.folder();
    options.progress = [show = arguments.progress](std::string_view what, double fraction) {
        if (show) {
            std::cerr << "\r" << what << ' ' << std::lround(100.0 * fraction) << " %"
                      << (fraction < 1.0 ? "" : "\n") << std::flush;
        }
        return !interrupted();
    };
    Renderer renderer(context->proc_address(), registry, std::move(options));
    renderer.set_scene(std::move(scene));

    nlohmann::json document = context_json(context->info());
    document["scene"] = renderer.scene().file.string();
    document["scene_hash"] = renderer.scene().hash;
    nlohmann::json& frames = document["frames"] = nlohmann::json::array();
    std::vector<std::string> png = split(arguments.png);
    check_png(png, dump, renderer.scene().outputs);
    png.insert(png.end(), renderer.scene().outputs.begin(), renderer.scene().outputs.end());
    for (std::size_t i = 0, count = png.size(); renderer.scene().camera.stereo && i < count; ++i) {
        png.push_back(eye_name(png[i], 0));
        png.push_back(eye_name(png[i], 1));
    }
    std::mutex mutex;
    const std::uint64_t total = range.end - range.first;
    FrameWriter writer({.folder = arguments.folder,
                        .compression = compression,
                        .multipart = arguments.multipart,
                        .png = std::move(png),
                        .attributes = header(renderer.scene(), context->info())},
                       [&](FrameReport&& report) {
                           const std::scoped_lock lock(mutex);
                           print_frame(report);
                           frames.push_back(to_json(report));
                           if (arguments.progress) {
                               std::cerr << "\r" << frames.size() << " of " << total << " frames"
                                         << std::flush;
                           }
                       });
    renderer.set_dump(dump, [&](CapturedFrame&& frame) { writer.submit(std::move(frame)); });
    if (renderer.keeps_state() && !arguments.no_run_up) {
        run_up(renderer, sequence ? renderer.frame(range.first).time_s
                                  : arguments.time_s.value_or(renderer.scene().time_s));
    }
    std::uint64_t index = range.first;
    for (; index < range.end && !interrupted(); ++index) {
        Frame frame = sequence ? renderer.frame(index)
                               : renderer.still(arguments.time_s.value_or(renderer.scene().time_s));
        renderer.render(frame);
    }
    renderer.finish_captures();
    writer.finish();
    if (arguments.progress) {
        std::cerr << '\n';
    }
    for (const auto& [key, count] : renderer.log().faults()) {
        document["faults"][key] = count;
    }
    if (!arguments.report.empty()) {
        io::write_file(arguments.report, document.dump(2) + '\n');
    }
    if (index < range.end) {
        throw Error(ErrorCode::usage, "render",
                    "cancelled after " + std::to_string(index - range.first) + " of " +
                        std::to_string(total) + " frames");
    }
    return 0;
}

}  // namespace

void add_render(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "render", "Renders a scene headless and writes its targets to EXR, its outputs also to PNG");
    const auto arguments = std::make_shared<RenderArguments>();
    arguments->scene.add_to(*command);
    arguments->context.add_to(*command);
    arguments->compute.add_to(*command);
    arguments->cache.add_to(*command);
    command->add_option("-o,--output", arguments->folder, "folder for the pictures");
    command->add_option("--time", arguments->time_s, "time of a single picture [s], in place of the scene's");
    command->add_option("--frames", arguments->frames,
                        "A:B renders frames A to B-1 at frame / frames_per_second; A renders one");
    command->add_option("--dump", arguments->dump, "outputs, all, or target names with commas between");
    command->add_option("--png", arguments->png,
                        "dumped targets also written as PNG, besides the outputs; names with commas between");
    command->add_option("--exr-compression", arguments->compression, "none, zips, zip, piz or dwaa");
    command->add_flag("--exr-multipart", arguments->multipart, "one file per frame with a part per target");
    command->add_option("--report", arguments->report, "writes what every pass and target did, as JSON");
    command
        ->add_option("--glsl", arguments->glsl,
                     "reads shaders from this folder in place of those in the binary")
        ->check(CLI::ExistingDirectory);
    command->add_flag(
        "--no-run-up", arguments->no_run_up,
        "begins scenes that keep a state (energy, blood) at the first frame asked for, not at the "
        "scene's beginning");
    command->add_flag("--progress", arguments->progress, "tells on stderr what is loaded, and counts frames");
    command->callback([arguments, &exit_code] { exit_code = render(*arguments); });
}

}  // namespace viscera::app
