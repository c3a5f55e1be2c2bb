#include "engine/core/scene.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <set>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/json_text.h"
#include "engine/core/params_reader.h"
#include "engine/core/scene_document.h"
#include "engine/core/scene_fields.h"

namespace viscera {
namespace {

using nlohmann::json;

constexpr std::size_t largest_file = std::size_t{64} << 20U;
constexpr std::size_t most_faults_shown = 100;
constexpr std::size_t longest_fault = 500;
constexpr std::size_t longest_name = 128;

[[nodiscard]] bool is_pass_name(std::string_view name) {
    constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return !name.empty() && name.size() <= longest_name &&
           name.find_first_not_of(allowed) == std::string_view::npos;
}

constexpr const char* target_name_rule =
    "a target's name is made of lower-case letters, digits and '_', in words joined by '.'";

[[noreturn]] void report(const std::filesystem::path& file, const std::vector<JsonFault>& faults) {
    const std::string where = file.empty() ? "scene" : file.string();
    std::string text;
    for (std::size_t i = 0; i < std::min(faults.size(), most_faults_shown); ++i) {
        const JsonFault& fault = faults[i];
        std::string line = shorten(fault.pointer, longest_fault) + (fault.pointer.empty() ? "" : ": ") +
                           shorten(fault.message, longest_fault);
        // A key may hold line breaks; a fault is one line.
        std::ranges::replace_if(
            line, [](char c) { return static_cast<unsigned char>(c) < ' '; }, '?');
        if (i > 0) {
            text.append("\n").append(where).append(": ");
        }
        text += line;
    }
    if (faults.size() > most_faults_shown) {
        text += "\n" + where + ": and " + std::to_string(faults.size() - most_faults_shown) + " faults more";
    }
    throw Error(ErrorCode::scene, where, text);
}

/// Reads the document of one scene, gathering what is wrong with it.
class SceneReader {
  public:
    SceneReader(const json& document, std::filesystem::path base, std::vector<JsonFault>& faults)
        : document_(document), base_(std::move(base)), faults_(faults) {}

    [[nodiscard]] Scene read() {
        Scene scene;
        read_fields(scene);
        if (!document_.is_object()) {
            return scene;
        }
        if (const json* targets = member("targets", "an object", json::value_t::object, false)) {
            for (const auto& [name, value] : targets->items()) {
                if (name != "comment") {
                    scene.targets.push_back(read_target(name, value));
                }
            }
        }
        const json none = json::object();
        const json* const shared = member("shared", "an object", json::value_t::object, false);
        References references(shared != nullptr ? *shared : none, faults_);
        if (const json* passes = member("passes", "a list", json::value_t::array, true)) {
            std::set<std::string> names;
            for (std::size_t i = 0; i < passes->size(); ++i) {
                ScenePass pass = read_pass((*passes)[i], child_pointer("/passes", i), references);
                if (!pass.name.empty() && !names.insert(pass.name).second) {
                    fault(child_pointer(pass.pointer, "name"), "another pass is called " + quote(pass.name));
                }
                scene.passes.push_back(std::move(pass));
            }
        }
        return scene;
    }

  private:
    void fault(std::string pointer, std::string message) {
        faults_.push_back({std::move(pointer), std::move(message)});
    }

    template <class Fields>
    void read_visited(Fields& fields, const json& value, const std::string& pointer,
                      std::span<const std::string_view> others) {
        read_params_beside(
            value, pointer, base_, [&fields](ParamVisitor& v) { fields.visit(v); }, others, faults_);
    }

    [[nodiscard]] const json* member(const char* key, std::string_view kind, json::value_t type,
                                     bool required) {
        const auto found = document_.find(key);
        if (found == document_.end()) {
            if (required) {
                fault(child_pointer("", key), "missing");
            }
            return nullptr;
        }
        if (found->type() != type) {
            fault(child_pointer("", key),
                  "expected " + std::string(kind) + ", not " + std::string(kind_name(*found)));
            return nullptr;
        }
        return &*found;
    }

    void read_fields(Scene& scene) {
        SceneFields fields;
        const std::size_t faults_before = faults_.size();
        read_visited(fields, document_, "", SceneFields::others);
        if (fields.resolution.size() != 2) {
            fault("/resolution", "expected [width, height]");
            fields.resolution = {1, 1};
        }
        std::set<std::string> names;
        for (std::size_t i = 0; i < fields.outputs.size(); ++i) {
            const std::string& name = fields.outputs[i];
            if (!is_target_name(name)) {
                fault(child_pointer("/outputs", i), target_name_rule);
            } else if (!names.insert(name).second) {
                fault(child_pointer("/outputs", i), quote(name) + " stands twice");
            }
        }
        if (document_.is_object() && document_.contains("outputs") && document_["outputs"].is_array() &&
            fields.outputs.empty()) {
            fault("/outputs", "expected at least one target");
        }
        scene.name = fields.name;
        scene.width = fields.resolution[0];
        scene.height = fields.resolution[1];
        scene.time_s = fields.time_s;
        scene.frames_per_second = fields.frames_per_second;
        scene.camera = fields.camera;
        scene.outputs = fields.outputs;
        scene.timeline = fields.timeline;
        check_timeline(scene.timeline);
        if (faults_.size() == faults_before) {
            check_camera(scene);
        }
    }

    void check_timeline(const std::vector<TimelineTrack>& timeline) {
        std::set<std::string> names;
        for (std::size_t i = 0; i < timeline.size(); ++i) {
            const std::string pointer = child_pointer("/timeline", i);
            if (std::string wrong = timeline[i].fault(); !wrong.empty()) {
                fault(pointer, std::move(wrong));
            } else if (!names.insert(timeline[i].value).second) {
                fault(pointer, "another track is of " + quote(timeline[i].value));
            }
        }
    }

    void check_camera(const Scene& scene) {
        try {
            (void)make_view(scene.camera, static_cast<double>(scene.width) / scene.height, scene.time_s);
        } catch (const Error& error) {
            const std::string_view text = error.what();
            const std::string lead = error.where() + ": ";
            fault("/camera", std::string(text.starts_with(lead) ? text.substr(lead.size()) : text));
        }
    }

    [[nodiscard]] SceneTarget read_target(const std::string& name, const json& value) {
        const std::string pointer = child_pointer("/targets", name);
        if (!is_target_name(name)) {
            fault(pointer, target_name_rule);
        }
        SceneTargetFields fields;
        read_visited(fields, value, pointer, {});
        SceneTarget target{name, fields.format, std::nullopt, std::nullopt};
        if (fields.scale && fields.size) {
            fault(child_pointer(pointer, "size"), "scale and size exclude each other");
        } else if (fields.scale) {
            target.size = SizeRule{*fields.scale, 0, 0};
        } else if (fields.size && fields.size->size() != 2) {
            fault(child_pointer(pointer, "size"), "expected [width, height]");
        } else if (fields.size) {
            target.size = SizeRule{1.0, fields.size->front(), fields.size->back()};
        }
        if (fields.clear && (fields.clear->empty() || fields.clear->size() > 4)) {
            fault(child_pointer(pointer, "clear"), "expected one to four numbers");
        } else if (fields.clear) {
            target.clear.emplace().fill(0.0F);
            std::ranges::transform(*fields.clear, target.clear->begin(),
                                   [](double x) { return static_cast<float>(x); });
        }
        return target;
    }

    [[nodiscard]] ScenePass read_pass(const json& value, const std::string& pointer, References& references) {
        ScenePassFields fields;
        read_visited(fields, value, pointer, ScenePassFields::others);
        ScenePass pass;
        pass.name = fields.name;
        pass.effect = fields.effect;
        pass.enabled = fields.enabled;
        pass.pointer = pointer;
        if (!value.is_object()) {
            return pass;
        }
        const auto has_text = [&value](const char* key) {
            return value.contains(key) && value[key].is_string();
        };
        if (has_text("name") && !is_pass_name(pass.name)) {
            fault(child_pointer(pointer, "name"),
                  "a pass's name is made of letters, digits, '_', '.' and '-', at most " +
                      std::to_string(longest_name));
        }
        if (has_text("effect") && pass.effect.empty()) {
            fault(child_pointer(pointer, "effect"), "no effect is named");
        }
        if (const auto found = value.find("parameters"); found != value.end()) {
            const std::string here = child_pointer(pointer, "parameters");
            const std::size_t faults_before = faults_.size();
            json parameters = references.expand(*found, here);
            if (parameters.is_object()) {
                pass.parameters = std::move(parameters);
            } else if (faults_.size() == faults_before) {
                fault(here, "expected an object, not " + std::string(kind_name(parameters)));
            }
        }
        if (const auto found = value.find("targets"); found != value.end()) {
            read_bindings(*found, child_pointer(pointer, "targets"), pass);
        }
        return pass;
    }

    void read_bindings(const json& value, const std::string& pointer, ScenePass& pass) {
        if (!value.is_object()) {
            fault(pointer, "expected an object of port and target, not " + std::string(kind_name(value)));
            return;
        }
        for (const auto& [port, target] : value.items()) {
            if (port == "comment") {
                continue;
            }
            if (target.is_null()) {
                pass.targets.emplace(port, "");
            } else if (!target.is_string()) {
                fault(child_pointer(pointer, port),
                      "expected the name of a target or null, not " + std::string(kind_name(target)));
            } else if (!is_target_name(target.get_ref<const std::string&>())) {
                fault(child_pointer(pointer, port), target_name_rule);
            } else {
                pass.targets.emplace(port, target.get<std::string>());
            }
        }
    }

    const json& document_;
    std::filesystem::path base_;
    std::vector<JsonFault>& faults_;
};

[[nodiscard]] std::string hash_of(const json& document) {
    const std::uint64_t hash =
        Hash().add(document.dump(-1, ' ', false, json::error_handler_t::replace)).value();
    std::array<char, 16> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16).ptr;
    const std::string text(digits.data(), end);
    return std::string(digits.size() - text.size(), '0') + text;
}

}  // namespace

SceneOverride parse_override(std::string_view text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) {
        throw Error(ErrorCode::usage, std::string(text), "expected /json/pointer=value");
    }
    SceneOverride change{std::string(text.substr(0, equals)), nullptr};
    const std::optional<std::vector<std::string>> tokens = pointer_tokens(change.pointer);
    if (!tokens || tokens->empty()) {
        throw Error(ErrorCode::usage, std::string(text),
                    "the part before '=' is not a JSON pointer, as /time_s is");
    }
    const std::string_view written = text.substr(equals + 1);
    std::vector<JsonFault> faults;
    change.value = parse_json(written, faults);
    if (faults.empty()) {
        return change;
    }
    const bool structured =
        !written.empty() && std::string_view("{[\"").find(written.front()) != std::string_view::npos;
    if (structured || faults.front().message.ends_with("UTF-8")) {
        throw Error(ErrorCode::usage, change.pointer, "the value is not JSON: " + faults.front().message);
    }
    change.value = std::string(written);
    return change;
}

Scene parse_scene(std::string_view text, const std::filesystem::path& file,
                  std::span<const SceneOverride> overrides) {
    std::vector<JsonFault> faults;
    if (text.size() > largest_file) {
        report(file, {{"", "longer than " + std::to_string(largest_file >> 20U) + " MiB"}});
    }
    json document = parse_json(text, faults);
    if (document.is_null() && !faults.empty()) {
        report(file, faults);
    }
    apply_overrides(document, overrides, faults);
    Scene scene = SceneReader(document, file.parent_path(), faults).read();
    if (!faults.empty()) {
        report(file, faults);
    }
    scene.file = file;
    scene.hash = hash_of(document);
    return scene;
}

Scene load_scene(const std::filesystem::path& file, std::span<const SceneOverride> overrides) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw Error(ErrorCode::file, file.string(), "is a folder, not a scene file");
    }
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw Error(ErrorCode::file, file.string(),
                    std::filesystem::exists(file, error) ? "cannot be opened" : "no such file");
    }
    // In pieces and not by the file's size, which a pipe does not tell.
    std::string text;
    std::vector<char> piece(std::size_t{1} << 16U);
    while (stream && text.size() <= largest_file) {
        stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
        text.append(piece.data(), static_cast<std::size_t>(stream.gcount()));
    }
    if (stream.bad()) {
        throw Error(ErrorCode::file, file.string(), "cannot be read");
    }
    return parse_scene(text, file, overrides);
}

}  // namespace viscera
