#include "tests/shaders/validate.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "effects/register_all.h"
#include "engine/core/params_json.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

struct Run {
    std::string output;
    int status = 0;
};

Run run(const std::string& command) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen((command + " 2>&1").c_str(), "r"), ::pclose);
    if (!pipe) {
        throw std::runtime_error("cannot run " + command);
    }
    Run result;
    std::array<char, 4096> part{};
    while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe.get())) {
        result.output.append(part.data(), got);
    }
    return result;
}

/// A stage in a file of its own, named so that the validator knows its kind.
struct StageFile {
    std::string name;
    ShaderSource source;
};

class Stages {
  public:
    Stages(const TempFolder& folder, const ShaderReader& reader) : folder_(folder), reader_(reader) {}

    /// The stage's name as it is compiled for software renderers; that for hardware is added where it
    /// differs.
    std::string add(const std::string& file, std::vector<std::string> defines) {
        ShaderSource source = expand_shader(file, defines, reader_);
        if (source.text.find("HARDWARE") != std::string::npos) {
            defines.emplace_back("HARDWARE");
            (void)add(file, expand_shader(file, defines, reader_));
        }
        return add(file, std::move(source));
    }
    [[nodiscard]] const std::vector<StageFile>& stages() const { return stages_; }

  private:
    std::string add(const std::string& file, ShaderSource source) {
        const std::string extension = file.substr(file.rfind('.'));
        const auto [found, is_new] =
            names_.try_emplace(source.text + extension, "s" + std::to_string(names_.size()) + extension);
        if (is_new) {
            (void)folder_.write(found->second, source.text);
            stages_.push_back({found->second, std::move(source)});
        }
        return found->second;
    }

    const TempFolder& folder_;
    const ShaderReader& reader_;
    std::map<std::string, std::string> names_;  ///< by text and kind
    std::vector<StageFile> stages_;
};

/// The validator names each file on a line of its own and then says what is wrong in it.
void collect_faults(const std::string& output, const std::vector<StageFile>& stages,
                    std::vector<std::string>& faults) {
    const StageFile* stage = nullptr;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        const auto named = std::ranges::find(stages, line, &StageFile::name);
        if (named != stages.end()) {
            stage = &*named;
        } else if (line.starts_with("ERROR") || line.starts_with("WARNING")) {
            faults.push_back(stage == nullptr ? line : map_shader_log(line, stage->source));
        }
    }
}

/// Parameters that bring in shader code which the defaults leave out.
struct ParameterSet {
    std::string effect;
    std::string parameters;  ///< JSON
};

std::vector<ParameterSet> parameter_sets() {
    const auto cast = [](const std::string& parameters) {
        return ParameterSet{"volume.ray_cast", R"({"volume": {"host": "host"}, )" + parameters + "}"};
    };
    const auto curved = [](const std::string& geometry, const std::string& parameters) {
        return ParameterSet{"volume.ray_cast", R"({"volume": {"file": "any.mha", "geometry": {)" + geometry +
                                                   "}}, " + parameters + "}"};
    };
    const auto slice = [](const std::string& parameters) {
        return ParameterSet{"volume.slice", R"({"volume": {"host": "host"}, )" + parameters + "}"};
    };
    return {
        cast(R"("transfer_function": {"file": "any.json"})"),
        cast(R"("shading": {"enabled": true, "lights": [{"direction": [0, 0, 1]}], "two_sided": false})"),
        cast(R"("shading": {"enabled": true, "lights": [{"position_mm": [0, 0, 1]}, {}],
                "light_volume": {"ambient_occlusion": 1}},
                "transfer_function": {"gradient": [{"gradient": 1, "factor": 1}], "interpolate": true})"),
        cast(R"("labels": {"host": "labels", "segments": [{"id": 1, "points": [{"value": 0}]}]},
                "overlay": {"host": "overlay"}, "transfer_function": {"interpolate": true},
                "sampling": {"scheme": "preintegrated"}, "clip_planes": [{}, {}, {}])"),
        cast(R"("labels": {"host": "labels"}, "shading": {"light_volume": {"ambient_occlusion": 1}})"),
        cast(R"("sub_volume": {}, "clip_planes": [{}])"),
        slice(R"("slab": {"function": "mip"}, "sampling": {"filter": "bspline"})"),
        slice(R"("slab": {"function": "minip"}, "view": "camera", "sampling": {"filter": "linear_fp32"})"),
        slice(R"("view": "camera")"),
        cast(R"("sampling": {"filter": "nearest"}, "shading": {"enabled": true})"),
        cast(R"("sampling": {"filter": "linear", "gradient": "analytic"}, "shading": {"enabled": true})"),
        cast(
            R"("sampling": {"filter": "linear_fp32", "gradient": "analytic"}, "shading": {"enabled": true})"),
        cast(R"("sampling": {"filter": "bspline"}, "shading": {"enabled": true})"),
        cast(R"("sampling": {"filter": "bspline_fp32"}, "shading": {"enabled": true})"),
        cast(R"("sampling": {"filter": "catmull_rom"}, "shading": {"enabled": true})"),
        cast(R"("sampling": {"filter": "catmull_rom_fp32"}, "shading": {"enabled": true})"),
        cast(
            R"("function": "accumulate", "accumulate": {"channels": [{}, {}, {}]}, "labels": {"host": "labels"},
                "overlay": {"host": "overlay"}, "shading": {"enabled": true,
                "light_volume": {"ambient_occlusion": 1}}, "sampling": {"filter": "catmull_rom"})"),
        cast(R"("function": "accumulate", "accumulate": {"channels": [{}, {}]}, "shading": {"enabled": true},
                "sampling": {"filter": "bspline_fp32"})"),
        cast(R"("sampling": {"gradient": "precomputed"}, "shading": {"enabled": true})"),
        cast(R"("function": "accumulate", "accumulate": {"channels": [{}, {}]},
                "sampling": {"filter": "linear_fp32", "scheme": "cell"}, "clip_planes": [{}])"),
        cast(R"("sampling": {"limits": "two_pass"})"),
        cast(R"("sampling": {"limits": "mesh"})"),
        curved(R"("kind": "cylindrical")",
               R"("labels": {"host": "labels", "segments": [{"id": 1, "points": [{"value": 0}]}]},
                  "overlay": {"host": "overlay"}, "shading": {"enabled": true}, "clip_planes": [{}],
                  "sampling": {"filter": "bspline_fp32", "tolerance": 0.1, "limits": "mesh", "jitter": "hash"})"),
        curved(R"("kind": "spherical")",
               R"("labels": {"host": "labels"}, "overlay": {"host": "overlay"}, "sub_volume": {},
                  "shading": {"enabled": true, "light_volume": {"ambient_occlusion": 1}},
                  "sampling": {"filter": "catmull_rom", "scheme": "preintegrated", "limits": "two_pass"})"),
        curved(R"("kind": "cylindrical")",
               R"("function": "isosurface", "sampling": {"filter": "linear_fp32"})"),
        curved(R"("kind": "spherical")", R"("function": "isosurface", "sampling": {"filter": "bspline"})"),
        curved(R"("kind": "spherical")", R"("function": "xray", "sampling": {"filter": "nearest"})"),
        {"volume.slice",
         R"({"volume": {"file": "any.mha", "geometry": {"kind": "spherical"}}, "view": "camera",
                "sampling": {"filter": "bspline"}})"},
        cast(R"("sampling": {"fovea": {}}, "mixed": {"pass": "coarse"})"),
        cast(R"("sampling": {"fovea": {}}, "mixed": {"pass": "fine"})"),
        {"mesh.surface", R"({"mesh": "any.obj", "lights": [{}, {}]})"},
        {"organ.surface",
         R"({"mesh": {"file": "any.obj"}, "diffuse_map": "a.png", "normal_map": {"map": "b.png"},
            "cut": {"map": "c.png"}, "hint": {"map": "d.png"}, "hematoma": {"host_spots": "spots"}, "focus": {},
            "coagulation": {"burn_curve": "thesis"}, "lights": [{"glow_mm": 9}, {}, {}, {}, {}, {}, {}, {}]})"},
        {"organ.surface", R"({"mesh": {"file": "any.obj"}, "diffuse_map": "a.png", "blending": "blended",
            "cut": {"map": "c.png", "vertex_scalar": "cut"}, "hematoma": {"spots": [{}], "metric": "uv"},
            "lights": []})"},
    };
}

}  // namespace

std::optional<std::filesystem::path> find_validator() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::filesystem::path file = std::filesystem::path(folder) / "glslangValidator";
        if (std::filesystem::exists(file)) {
            return file;
        }
    }
    return std::nullopt;
}

std::vector<ProgramDesc> all_programs() {
    Registry registry;
    register_all(registry);
    std::vector<ProgramDesc> programs{{"common/fullscreen.vert", "common/present.frag", {}},
                                      {"common/fullscreen.vert", "common/fill.frag", {"FAR"}},
                                      {"common/fullscreen.vert", "common/side_by_side.frag", {}}};
    for (const Registry::Entry& entry : registry.entries()) {
        const std::unique_ptr<Effect> effect = entry.make();
        const auto own = effect->programs();
        programs.insert(programs.end(), own.begin(), own.end());
    }
    for (const ParameterSet& set : parameter_sets()) {
        const std::unique_ptr<Effect> effect = registry.find(set.effect)->make();
        std::vector<JsonFault> faults;
        read_params(
            nlohmann::json::parse(set.parameters), "", "", [&](ParamVisitor& v) { effect->visit(v); },
            faults);
        if (!faults.empty()) {
            throw std::runtime_error(set.effect + faults.front().pointer + ": " + faults.front().message);
        }
        // What else is in the picture has its own file, and so have curvilinear volumes: the default
        // parameters validate them, and sets of their own; with every set it would only take ten times as
        // long.
        const bool curved = set.parameters.find("geometry") != std::string::npos;
        const bool mixed = set.parameters.find("mixed") != std::string::npos;
        std::ranges::copy_if(effect->programs(), std::back_inserter(programs),
                             [&](const ProgramDesc& program) {
                                 return std::ranges::none_of(program.defines, [&](const std::string& define) {
                                     // Filling in heeds surfaces.
                                     return (define == "SURFACE" && !mixed) || define == "BACKGROUND" ||
                                            (!curved && define.starts_with("COORDINATES"));
                                 });
                             });
    }
    return programs;
}

Verdict validate(const std::filesystem::path& validator, const std::vector<ProgramDesc>& programs,
                 const ShaderReader& reader) {
    const TempFolder folder;
    Stages stages(folder, reader);
    std::set<std::pair<std::string, std::string>> pairs;
    for (const ProgramDesc& program : programs) {
        if (!program.compute.empty()) {
            pairs.emplace(stages.add(program.compute, program.defines), std::string());
            continue;
        }
        const std::string vertex = stages.add(program.vertex, program.defines);
        const std::string fragment =
            program.fragment.empty() ? std::string() : stages.add(program.fragment, program.defines);
        pairs.emplace(vertex, fragment);
    }
    Verdict verdict{.faults = {}, .stages = stages.stages().size(), .links = pairs.size()};
    const std::string enter = "cd '" + folder.path().string() + "' && ";
    std::string names;
    for (const StageFile& stage : stages.stages()) {
        names += " " + stage.name;
    }
    collect_faults(run(enter + "'" + validator.string() + "'" + names).output, stages.stages(),
                   verdict.faults);
    if (!verdict.faults.empty()) {
        return verdict;  // what does not compile does not link
    }
    // One pair a call, all in one shell.
    std::string links;
    for (const auto& [vertex, fragment] : pairs) {
        links += "echo 'link " + vertex + " " + fragment + "'; '" + validator.string() + "' -l " + vertex +
                 " " + fragment + "; ";
    }
    std::istringstream lines(run(enter + "{ " + links + "}").output);
    std::string link;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("link ")) {
            link = line;
        } else if (line.starts_with("ERROR")) {
            verdict.faults.push_back(link + ": " + line);
        }
    }
    return verdict;
}

}  // namespace viscera::test
