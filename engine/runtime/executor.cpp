#include "engine/runtime/executor.h"

#include <algorithm>
#include <utility>

#include "engine/core/error.h"
#include "engine/gl/debug.h"
#include "engine/runtime/naming_pass.h"

namespace viscera {
namespace {

/// Which textures of an old plan hold what the frame after sees as `previous`, and where a new plan has them.
std::vector<TargetPool::Kept> common_history(const Plan& from, const Plan& to) {
    std::vector<TargetPool::Kept> kept;
    for (const PlanHistory& history : to.history) {
        const auto old = std::ranges::find(from.history, history.target, &PlanHistory::target);
        if (old != from.history.end()) {
            kept.push_back({*from.contents[old->previous].texture, *to.contents[history.previous].texture});
        }
    }
    return kept;
}

}  // namespace

Executor::Executor(const Pass::Shared& shared, const gl::Capabilities& capabilities, Options options)
    : shared_(shared),
      capabilities_(capabilities),
      options_(std::move(options)),
      pool_(shared.gl),
      fill_program_(shared.shaders.entry({"common/fullscreen.vert", "common/fill.frag", {"FAR"}})) {}

void Executor::set_plan(Plan plan, std::vector<ImportedTarget> imported, std::span<const PassEffect> effects,
                        bool same_scene) {
    std::vector<TargetPool::Kept> kept;
    if (same_scene) {
        turn_over();
        kept = common_history(plan_, plan);
    }
    ran_ = false;
    pool_.reset(plan, kept);
    plan_ = std::move(plan);
    imported_ = std::move(imported);
    passes_.clear();
    for (std::size_t p = 0; p < plan_.passes.size(); ++p) {
        PassState state{.effect = effects[p].effect,
                        .parameters_key = effects[p].parameters_key,
                        .origin = effects[p].origin};
        state.drawn_keys.assign(plan_.passes[p].bindings.size(), 0);
        state.frame = !state.effect->uses_view() ? 0 : state.origin.eye == 1 ? 2 : 1;
        state.ports = state.effect->ports();
        for (const PlanBinding& binding : plan_.passes[p].bindings) {
            const auto port = std::ranges::find(state.ports, binding.port, &Port::name);
            state.port_of_binding.push_back(static_cast<std::size_t>(port - state.ports.begin()));
        }
        find_programs(state);
        if (options_.timers && capabilities_.gpu_timers()) {
            state.timer = std::make_unique<gl::GpuTimer>(shared_.gl);
        }
        passes_.push_back(std::move(state));
    }
}

void Executor::replace_effect(const PassEffect& effect) {
    for (PassState& state : passes_) {
        const bool right = state.origin.eye == 1;
        if (state.origin.source == effect.origin.source && right == (effect.origin.eye == 1)) {
            state.effect = effect.effect;
            state.parameters_key = effect.parameters_key;
            find_programs(state);
        }
    }
}

void Executor::find_programs(PassState& state) const {
    state.programs.clear();
    for (const ProgramDesc& program : state.effect->programs()) {
        state.programs.push_back(&shared_.shaders.entry(program));
    }
}

void Executor::run(const Frame& frame, FrameReport& report) {
    turn_over();
    import(frame);
    see(frame);
    try {
        prepare(report);
        for (std::size_t p = 0; p < passes_.size(); ++p) {
            PassReport& pass = report.passes[p];
            const PassDecision& decision = schedule_.passes()[p];
            pass.status = decision.status;
            pass.reason = decision.reason;
            if (decision.draws()) {
                const gl::CpuTimer timer;
                pass.path = draw(p) ? DrawPath::compute : DrawPath::fragment;
                pass.cpu_ms += timer.milliseconds();
            }
            if (passes_[p].timer) {
                pass.gpu_ms = passes_[p].timer->latest_ms();
            }
        }
        for (const Settlement& settlement : schedule_.outputs()) {
            settle(settlement);
        }
    } catch (...) {
        forget_frame();
        throw;
    }
    ran_ = true;
}

/// What the frames before made stays: until its end a frame does not touch it.
void Executor::forget_frame() {
    std::vector<TargetPool::Kept> kept;
    for (const PlanHistory& history : plan_.history) {
        const std::size_t texture = *plan_.contents[history.previous].texture;
        kept.push_back({texture, texture});
    }
    pool_.forget_content(kept);
}

const gl::Texture& Executor::texture_of(std::size_t content) const {
    const PlanContent& planned = plan_.contents[content];
    return planned.imported ? imported_textures_[*planned.imported] : pool_.texture(*planned.texture);
}

bool Executor::draw(std::size_t p) {
    PassState& state = passes_[p];
    const PlanPass& pass = plan_.passes[p];
    const gl::DebugGroup group(shared_.gl, pass.name);
    state.inputs.clear();
    state.outputs.clear();
    state.colours.clear();
    const gl::Texture* depth = nullptr;
    glm::ivec2 size(0);
    for (std::size_t b = 0; b < pass.bindings.size(); ++b) {
        const PlanBinding& binding = pass.bindings[b];
        const ContentState* content = binding.content ? &schedule_.contents()[*binding.content] : nullptr;
        const bool held = content != nullptr && !content->empty;
        // What stands in for an output is another's: it is not drawn into.
        const bool drawn = held && (!makes_content(binding.access) || content->holder == *binding.content);
        const gl::Texture* texture = drawn ? &texture_of(content->holder) : nullptr;
        if (!makes_content(binding.access)) {
            state.inputs.push_back({binding.port, texture});
            continue;
        }
        state.outputs.push_back({binding.port, texture});
        const bool is_depth = binding.content && info(plan_.contents[*binding.content].format).is_depth;
        if (is_depth) {
            depth = texture;
        } else {
            state.colours.push_back(texture);
        }
        if (texture != nullptr) {
            size = {texture->width(), texture->height()};
        }
    }
    const gl::Framebuffer& target = pool_.framebuffer(state.colours, depth, pass.name);
    const bool whole = state.work.kind == Work::Kind::all;
    const PixelRegion region = whole ? PixelRegion({0, 0, size.x, size.y}) : state.work.region;

    observe(pass.name, true);
    if (state.timer) {
        state.timer->begin();
    }
    for (const Settlement& settlement : schedule_.before(p)) {
        settle(settlement);
    }
    target.bind();
    const Cleared cleared = clear(state, pass, target, region);
    const Pass view(shared_, frames_[state.frame], state.programs, state.inputs, state.outputs, target, size,
                    region, cleared.kept);
    view.raster(gl::overwrite_state);
    naming_pass(pass.name, [&] { state.effect->draw(view); });
    fill(target, cleared);
    if (state.timer) {
        state.timer->end();
    }
    observe(pass.name, false);
    check(pass.name, state.programs);
    return view.dispatched();
}

void Executor::observe(std::string_view pass, bool begins) const {
    if (options_.observer) {
        options_.observer(pass, begins);
    }
}

void Executor::check(std::string_view pass, std::span<ShaderLibrary::Entry* const> programs) const {
    if (!options_.check_errors) {
        return;
    }
    const GLenum error = gl::drain_errors(shared_.gl);
    if (error != GL_NO_ERROR) {
        throw Error(ErrorCode::gl, "pass '" + std::string(pass) + "'",
                    std::string("OpenGL reports: ") + gl::error_name(error));
    }
    for (const ShaderLibrary::Entry* entry : programs) {
        if (entry->program && !entry->program->unset().empty()) {
            throw Error(ErrorCode::gl, "pass '" + std::string(pass) + "'",
                        entry->program->label() + " is used without a value for '" +
                            std::string(entry->program->unset()) + "'");
        }
    }
}

void Executor::settle(const Settlement& settlement) {
    const bool nothing_differs =
        settlement.action == Settlement::Action::copy_parts && settlement.parts.empty();
    if (settlement.action == Settlement::Action::none || nothing_differs) {
        return;
    }
    const gl::Texture& texture = texture_of(settlement.content);
    if (const auto& slot = plan_.contents[settlement.content].texture) {
        pool_.backdrop(*slot) = {};
    }
    const bool is_depth = info(plan_.contents[settlement.content].format).is_depth;
    const gl::Texture* const colour = is_depth ? nullptr : &texture;
    const gl::Framebuffer& target = pool_.framebuffer(std::span(&colour, is_depth ? 0 : 1),
                                                      is_depth ? &texture : nullptr, "settled target");
    target.bind();
    gl::apply(shared_.gl, gl::depth_tested_state, {0, 0, texture.width(), texture.height()});
    if (settlement.action == Settlement::Action::clear) {
        const auto& value = plan_.contents[settlement.source].clear;
        if (is_depth) {
            target.clear_depth(value[0]);
        } else {
            target.clear_colour(0, value);
        }
        return;
    }
    const gl::Texture& source = texture_of(settlement.source);
    const gl::Texture* const from = is_depth ? nullptr : &source;
    const gl::Framebuffer& origin =
        pool_.framebuffer(std::span(&from, is_depth ? 0 : 1), is_depth ? &source : nullptr, "settled source");
    const gl::Functions& gl = shared_.gl;
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, origin.id());
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.id());
    const PixelRegion all(PixelRect{0, 0, texture.width(), texture.height()});
    const bool parts = settlement.action == Settlement::Action::copy_parts;
    for (const PixelRect& part : (parts ? settlement.parts : all).rects()) {
        const int right = part.x + part.width;
        const int top = part.y + part.height;
        gl.BlitFramebuffer(part.x, part.y, right, top, part.x, part.y, right, top,
                           is_depth ? GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
}

/// Ends the frame before: only now does nobody look at its outputs any more.
void Executor::turn_over() {
    if (!std::exchange(ran_, false)) {
        return;
    }
    for (std::size_t h = 0; h < plan_.history.size(); ++h) {
        const HistoryStep& step = schedule_.history()[h];
        settle(step.settlement);
        if (step.swap) {
            pool_.swap(*plan_.contents[*plan_.history[h].current].texture,
                       *plan_.contents[plan_.history[h].previous].texture);
        }
    }
    std::ranges::copy(schedule_.held_after(), pool_.keys().begin());
}

std::optional<Executor::Output> Executor::output(std::string_view name) const {
    const auto found = std::ranges::find(plan_.outputs, name, &PlanOutput::target);
    if (found == plan_.outputs.end() || !ran_) {
        return std::nullopt;
    }
    const ContentState& state = schedule_.contents()[found->content];
    return Output{state.empty ? nullptr : &texture_of(state.holder), &plan_.contents[found->content],
                  state.key, plan_.contents[state.holder].imported.has_value()};
}

GLuint Executor::release(std::string_view name) {
    const auto found = std::ranges::find(plan_.outputs, name, &PlanOutput::target);
    if (found == plan_.outputs.end() || !ran_) {
        return 0;
    }
    const ContentState& state = schedule_.contents()[found->content];
    const PlanContent& holder = plan_.contents[state.holder];
    if (state.empty || holder.imported) {
        return 0;
    }
    const GLuint id = texture_of(state.holder).id();
    turn_over();  // which may give the texture another place
    return pool_.release(id);
}

}  // namespace viscera
