#include "engine/runtime/loaded_scene.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/runtime/executor.h"

namespace viscera {
namespace {

bool same(const ImportedTarget& a, const ImportedTexture& b) {
    return a.name == b.target && a.format == b.format && a.width == b.width && a.height == b.height &&
           a.writable == b.writable;
}

/// Of the frames that a scene is made for: two when it says so itself, or when the host brings something per
/// eye.
int eyes_of(const Scene& scene, std::span<const ImportedTarget> imported) {
    const bool per_eye = std::ranges::any_of(
        imported, [](const ImportedTarget& target) { return target.name.ends_with(".right"); });
    return scene.camera.stereo || per_eye ? 2 : 1;
}

/// Targets that something draws, each once.
std::vector<std::string> live_targets(const Plan& plan) {
    std::vector<std::string> names;
    for (const PlanContent& content : plan.contents) {
        if (content.writer && content.texture && std::ranges::find(names, content.target) == names.end()) {
            names.push_back(content.target);
        }
    }
    return names;
}

bool reads_history(const SceneEffects& scene) {
    return std::ranges::any_of(scene.effects, [](const std::unique_ptr<Effect>& effect) {
        const std::vector<Port> ports = effect->ports();
        return std::ranges::find(ports, Access::previous, &Port::access) != ports.end();
    });
}

}  // namespace

bool LoadedScene::keeps_state() const {
    for (std::size_t p = 0; p < scene_.passes.size(); ++p) {
        if (scene_.passes[p].enabled && effects_.effects[p]->keeps_state()) {
            return true;
        }
    }
    return has_history_;
}

void LoadedScene::set(Scene scene, std::span<const ImportedTarget> imported) {
    SceneEffects effects = make_effects(scene, registry_);
    // Compiled once for its faults, so that a scene that cannot run is refused while the old one still can.
    (void)compile_scene(scene, EyeScene(scene, effects, imported, {}, eyes_of(scene, imported)).graph(),
                        scene.width, scene.height, max_texture_size_);
    expected_.assign(imported.begin(), imported.end());
    scene_ = std::move(scene);
    effects_ = std::move(effects);
    right_effects_ = {};
    has_history_ = reads_history(effects_);
    planned_ = same_scene_ = false;
}

LoadedScene::Edited LoadedScene::edited(std::string_view pass, std::string_view pointer,
                                        const nlohmann::json& value) const {
    const auto found = std::ranges::find(scene_.passes, pass, &ScenePass::name);
    if (found == scene_.passes.end()) {
        throw Error(ErrorCode::scene, std::string(pass), "the scene has no pass of this name");
    }
    Edited edited{scene_, static_cast<std::size_t>(found - scene_.passes.begin())};
    try {
        edited.scene.passes[edited.pass].parameters[nlohmann::json::json_pointer(std::string(pointer))] =
            value;
    } catch (const nlohmann::json::exception&) {
        throw Error(ErrorCode::scene, std::string(pass),
                    "'" + std::string(pointer) + "' leads to no parameter");
    }
    return edited;
}

bool LoadedScene::replace(Edited& edited, Executor& executor) {
    const std::size_t pass = edited.pass;
    SceneEffects effects = make_effects(edited.scene, registry_);
    if (!planned_ || effects.effects[pass]->uses_view() != effects_.effects[pass]->uses_view() ||
        effects.effects[pass]->ports() != effects_.effects[pass]->ports()) {
        return false;
    }
    const auto take = [&](SceneEffects& made, SceneEffects& into, int eye) {
        executor.replace_effect({made.effects[pass].get(), made.parameter_keys[pass], {pass, eye}});
        std::swap(into.effects[pass], made.effects[pass]);
        into.parameter_keys[pass] = made.parameter_keys[pass];
    };
    if (!right_effects_.effects.empty()) {
        SceneEffects right = make_effects(edited.scene, registry_);
        take(right, right_effects_, 1);
    }
    take(effects, effects_, 0);
    scene_ = std::move(edited.scene);
    return true;
}

/// Targets of the frame before, and those of the host, have a size that no single frame can change.
glm::ivec2 LoadedScene::planned_size(const Frame& frame) const {
    const double share = has_history_ || !frame.imported.empty() ? 1.0 : frame.quality.resolution;
    const auto scaled = [share](int pixels) {
        return std::max(1, static_cast<int>(std::lround(share * pixels)));
    };
    return {scaled(frame.width), scaled(frame.height)};
}

void LoadedScene::plan_for(const Frame& frame, const ReadBack& read_back, Executor& executor) {
    const glm::ivec2 size = planned_size(frame);
    if (planned_ && std::ranges::equal(imported_, frame.imported, same) && planned_eyes_ == frame.eye_count &&
        executor.plan().width == size.x && executor.plan().height == size.y) {
        return;
    }
    planned_ = false;  // until all of the below has worked
    imported_.clear();
    for (const ImportedTexture& texture : frame.imported) {
        imported_.push_back(
            {texture.target, texture.format, texture.width, texture.height, texture.writable});
    }
    if (frame.eye_count == 2 && right_effects_.effects.empty()) {
        right_effects_ = make_effects(scene_, registry_);
    }
    const auto passes_with = [&](const std::vector<std::string>& more) {
        return EyeScene(scene_, effects_, imported_, more, frame.eye_count);
    };
    const auto compile = [&](const EyeScene& passes) {
        return compile_scene(scene_, passes.graph(), size.x, size.y, max_texture_size_);
    };
    std::vector<std::string> dumped;
    switch (read_back.dump.kind) {
        case DumpRequest::Kind::none:
            break;
        case DumpRequest::Kind::outputs:
            dumped = scene_.outputs;
            break;
        case DumpRequest::Kind::names:
            dumped = read_back.dump.names;
            break;
        case DumpRequest::Kind::all:
            dumped = live_targets(compile(passes_with({})));
            break;
    }
    // What is read back is an output: it keeps its texture to the end of the frame.
    std::vector<std::string> more = dumped;
    more.insert(more.end(), read_back.kept.begin(), read_back.kept.end());
    more.insert(more.end(), read_back.watched.begin(), read_back.watched.end());
    EyeScene passes = passes_with(more);
    Plan plan = compile(passes);
    dumped_.clear();
    for (const std::string& name : dumped) {
        for (std::string& one : passes.names_of(name)) {
            dumped_.push_back(std::move(one));
        }
    }
    eye_scene_.emplace(std::move(passes));
    executor.set_plan(std::move(plan), imported_, eye_scene_->effects(effects_, right_effects_), same_scene_);
    planned_eyes_ = frame.eye_count;
    planned_ = same_scene_ = true;
}

std::vector<std::string> LoadedScene::names_of(std::string_view name) const {
    return eye_scene_ ? eye_scene_->names_of(name) : std::vector{std::string(name)};
}

}  // namespace viscera
