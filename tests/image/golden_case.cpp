#include "tests/image/golden_case.h"

#include <array>
#include <fstream>
#include <set>
#include <stdexcept>

#include "engine/io/exr.h"

namespace viscera::test {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
    throw std::runtime_error(file.string() + ": " + why);
}

void expect_keys(const std::filesystem::path& file, const json& object, const std::set<std::string>& known) {
    for (const auto& [key, value] : object.items()) {
        if (!known.contains(key)) {
            refuse(file, "unknown key '" + key + "'");
        }
    }
}

Limits read_limits(const std::filesystem::path& file, const json& object) {
    expect_keys(file, object, {"max", "mean", "fraction", "reason"});
    Limits limits{{.max = object.at("max"), .mean = object.at("mean"), .fraction = object.at("fraction")},
                  object.at("reason")};
    if (limits.reason.empty()) {
        refuse(file, "limits need a reason");
    }
    return limits;
}

struct Target {
    std::string pass;
    std::string name;
    Image image;
};

/// Every target of a frame in the order of the passes that wrote them last.
std::vector<Target> render(const GoldenCase& golden, Stage& stage, double time_s) {
    Renderer& renderer = stage.renderer();
    std::vector<Target> targets;
    renderer.set_dump({DumpRequest::Kind::all, {}}, [&](CapturedFrame&& frame) {
        for (CapturedTarget& target : frame.targets) {
            targets.push_back({{}, target.name, std::move(target.image)});
        }
    });
    stage.render(time_s);
    renderer.finish_captures();
    const Plan& plan = renderer.plan();
    std::map<std::string, std::size_t> writers;
    for (const PlanContent& content : plan.contents) {
        if (content.writer) {
            writers[content.target] = std::max(writers[content.target], *content.writer);
        }
    }
    std::ranges::stable_sort(targets, {}, [&](const Target& target) { return writers.at(target.name); });
    for (Target& target : targets) {
        target.pass = plan.passes[writers.at(target.name)].name;
    }
    if (targets.empty()) {
        refuse(golden.scene, "has no target to look at");
    }
    return targets;
}

std::string compare_with_file(const GoldenCase& golden, const std::filesystem::path& file,
                              const Target& target) {
    if (!std::filesystem::exists(file)) {
        return "its image is missing: " + file.filename().string();
    }
    const std::vector<io::ExrPart> parts = io::read_exr(file);
    if (parts.size() != 1) {
        return file.filename().string() + " holds " + std::to_string(parts.size()) + " pictures";
    }
    return compare(target.image, parts.front().image, golden.limits_of(target.name).values).reason;
}

}  // namespace

const Limits& GoldenCase::limits_of(const std::string& target) const {
    const auto found = targets.find(target);
    return found == targets.end() ? limits : found->second;
}

std::filesystem::path GoldenCase::file(std::size_t frame, const std::string& target) const {
    return folder / (std::to_string(frame) + "." + target + ".exr");
}

std::string to_string(const Finding& finding) {
    return "frame " + std::to_string(finding.frame) + ", pass '" + finding.pass + "', target '" +
           finding.target + "': " + finding.what;
}

GoldenCase load_case(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "expect.json";
    std::ifstream in(file);
    if (!in) {
        refuse(file, "cannot be read");
    }
    const json text = json::parse(in);
    expect_keys(file, text, {"times_s", "limits", "targets"});
    GoldenCase golden{.name = folder.filename().string(),
                      .scene = folder / "scene.json",
                      .folder = folder,
                      .times_s = text.at("times_s"),
                      .limits = read_limits(file, text.at("limits")),
                      .targets = {}};
    if (golden.times_s.empty()) {
        refuse(file, "times_s names no frame");
    }
    const json targets = text.value("targets", json::object());
    for (const auto& [target, limits] : targets.items()) {
        golden.targets.emplace(target, read_limits(file, limits));
    }
    return golden;
}

std::filesystem::path case_folder(const std::string& name) {
    return std::filesystem::path(VISCERA_SOURCE_DIR) / "tests" / "image" / name;
}

std::vector<std::string> case_names() {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(case_folder(""))) {
        if (std::filesystem::exists(entry.path() / "scene.json")) {
            names.insert(entry.path().filename().string());
        }
    }
    return {names.begin(), names.end()};
}

std::vector<Finding> check(const GoldenCase& golden, Stage& stage) {
    std::vector<Finding> findings;
    std::set<std::filesystem::path> expected;
    stage.renderer().set_scene(load_scene(golden.scene));
    for (std::size_t frame = 0; frame < golden.times_s.size(); ++frame) {
        for (const Target& target : render(golden, stage, golden.times_s[frame])) {
            const std::filesystem::path file = golden.file(frame, target.name);
            expected.insert(file);
            std::string what = compare_with_file(golden, file, target);
            if (!what.empty()) {
                findings.push_back({frame, target.pass, target.name, std::move(what)});
            }
        }
    }
    for (const auto& entry : std::filesystem::directory_iterator(golden.folder)) {
        if (entry.path().extension() == ".exr" && !expected.contains(entry.path())) {
            findings.push_back({0, {}, entry.path().filename().string(), "no pass writes such a target"});
        }
    }
    return findings;
}

void update(const GoldenCase& golden, Stage& stage) {
    for (const auto& entry : std::filesystem::directory_iterator(golden.folder)) {
        if (entry.path().extension() == ".exr") {
            std::filesystem::remove(entry.path());
        }
    }
    stage.renderer().set_scene(load_scene(golden.scene));
    for (std::size_t frame = 0; frame < golden.times_s.size(); ++frame) {
        for (const Target& target : render(golden, stage, golden.times_s[frame])) {
            const std::array<io::ExrPart, 1> parts{io::ExrPart{.name = target.name, .image = target.image}};
            io::write_exr(golden.file(frame, target.name), parts, io::ExrCompression::piz);
        }
    }
}

}  // namespace viscera::test
