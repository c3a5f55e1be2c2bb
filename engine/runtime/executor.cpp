#include "engine/runtime/executor.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/image.h"
#include "engine/gl/debug.h"

namespace viscera {
namespace {

using Clock = std::chrono::steady_clock;

// Software renderers fill whole targets so much faster than parts of them.
constexpr double software_clear_gain = 8.0;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Size of what a pass draws into [pixels]; {0, 0} when nobody needs any of it.
glm::ivec2 target_size(const Plan& plan, const PlanPass& pass) {
    for (const PlanBinding& binding : pass.bindings) {
        if (binding.content && makes_content(binding.access)) {
            const PlanContent& content = plan.contents[*binding.content];
            return {content.width, content.height};
        }
    }
    return {0, 0};
}

/// A clear value as its target holds it, rounded here, since drivers round what they clear with and what they
/// draw in different ways.
std::array<float, 4> stored(const PlanContent& content) {
    std::array<float, 4> value = content.clear;
    if (info(content.format).type == ChannelType::half) {
        std::ranges::transform(value, value.begin(), [](float v) { return half_to_float(float_to_half(v)); });
    }
    return value;
}

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

/// One pass's view of the frame while works are collected.
class Executor::FramePrepare final : public Prepare {
  public:
    FramePrepare(Executor& executor, const Frame& frame, std::size_t pass)
        : executor_(executor), frame_(frame), pass_(pass) {}

    const Frame& frame() const override { return frame_; }
    Assets& assets() override { return executor_.shared_.assets; }
    Log& log() override { return executor_.shared_.log; }
    std::uint64_t parameters_key() const override { return executor_.passes_[pass_].parameters_key; }
    bool has(std::string_view port) const override {
        const PlanBinding* binding = find(port);
        if (binding == nullptr || !binding->content) {
            return false;
        }
        return makes_content(binding->access) || !executor_.schedule_.contents()[*binding->content].empty;
    }
    glm::ivec2 size(std::string_view port) const override {
        const PlanBinding* binding = find(port);
        if (binding == nullptr || !binding->content) {
            return {0, 0};
        }
        const PlanContent& content = executor_.plan_.contents[*binding->content];
        return {content.width, content.height};
    }

    std::uint64_t subject(std::string_view port) const override {
        const PlanBinding* binding = find(port);
        return binding == nullptr || !binding->content ? 0 : executor_.subjects_[*binding->content];
    }

  private:
    const PlanBinding* find(std::string_view port) const {
        const auto& bindings = executor_.plan_.passes[pass_].bindings;
        const auto found = std::ranges::find(bindings, port, &PlanBinding::port);
        return found == bindings.end() ? nullptr : &*found;
    }

    Executor& executor_;
    const Frame& frame_;
    std::size_t pass_;
};

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
            state.timer = std::make_unique<gl::GpuTimer>(shared_.gl, capabilities_.software);
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
                const Clock::time_point start = Clock::now();
                pass.path = draw(p) ? DrawPath::compute : DrawPath::fragment;
                pass.cpu_ms += milliseconds_since(start);
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

void Executor::see(const Frame& frame) {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        Frame& seen = frames_[i];
        seen = frame;
        seen.eye_count = i == 0 ? 0 : 1;
        seen.eye_index = i == 2 ? 1 : 0;
        if (i == 2) {
            seen.eyes[0] = frame.eyes[1];
        }
    }
}

void Executor::import(const Frame& frame) {
    imported_textures_.clear();
    imported_keys_.clear();
    for (const ImportedTarget& target : imported_) {
        const auto found = std::ranges::find(frame.imported, target.name, &ImportedTexture::target);
        if (found->texture == 0 || shared_.gl.IsTexture(found->texture) == GL_FALSE) {
            throw Error(
                ErrorCode::usage, target.name,
                "the imported texture " + std::to_string(found->texture) + " does not exist in this context");
        }
        // A host may have deleted a texture and made another of the same name, which no framebuffer made
        // before then holds.
        if (target.writable) {
            pool_.forget_framebuffers(found->texture);
        }
        imported_textures_.push_back(gl::Texture::wrap(shared_.gl, found->texture, GL_TEXTURE_2D,
                                                       {found->width, found->height},
                                                       gl::texture_format(found->format)));
        imported_keys_.push_back(
            found->version == 0 ? 0 : Hash().add(found->texture).add(found->version).value());
    }
}

void Executor::prepare(FrameReport& report) {
    report.passes.resize(passes_.size());
    schedule_.begin(plan_, pool_.keys(), imported_keys_);
    subjects_.assign(plan_.contents.size(), 0);
    for (std::size_t p = 0; p < passes_.size(); ++p) {
        PassState& state = passes_[p];
        const PlanPass& pass = plan_.passes[p];
        report.passes[p].name = pass.name;
        report.passes[p].effect = pass.effect;
        report.passes[p].eye = state.origin.eye;
        report.passes[p].cpu_ms = 0.0;
        report.passes[p].path.reset();
        if (!pass.live) {
            continue;
        }
        const Clock::time_point start = Clock::now();
        FramePrepare view(*this, frames_[state.frame], p);
        state.work = state.effect->prepare(view);
        // An effect may ask for more than there is.
        const glm::ivec2 size = target_size(plan_, pass);
        state.work.region = state.work.region.confined(size.x, size.y);
        PassWork work{.idle = state.work.kind == Work::Kind::idle,
                      .region = state.work.kind == Work::Kind::region,
                      .key = state.work.key,
                      .reason = state.work.reason,
                      .update = state.work.kind == Work::Kind::update,
                      .touched = state.work.region,
                      .rests = state.work.rests};
        for (std::size_t b = 0; b < state.port_of_binding.size(); ++b) {
            work.empty_bindings |= ((state.work.empty_outputs >> state.port_of_binding[b]) & 1U) << b;
        }
        schedule_.work(plan_, p, work);
        pass_on_subject(pass, state.work.subject);
        report.passes[p].cpu_ms = milliseconds_since(start);
    }
    schedule_.decide(plan_);
}

/// A pass's outputs belong to what it says, or to what its inputs belong to.
void Executor::pass_on_subject(const PlanPass& pass, std::uint64_t subject) {
    for (const PlanBinding& binding : pass.bindings) {
        if (subject == 0 && binding.content && !makes_content(binding.access)) {
            subject = subjects_[*binding.content];
        }
    }
    for (const PlanBinding& binding : pass.bindings) {
        if (binding.content && makes_content(binding.access)) {
            subjects_[*binding.content] = subject;
        }
    }
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
    const Cleared cleared = clear(state, pass, target, region.bounds());
    const Pass view(shared_, frames_[state.frame], state.programs, state.inputs, state.outputs, target, size,
                    region, cleared.kept);
    view.raster(gl::overwrite_state);
    state.effect->draw(view);
    fill(target, cleared);
    if (state.timer) {
        state.timer->end();
    }
    observe(pass.name, false);
    check(pass.name);
    return view.dispatched();
}

void Executor::observe(std::string_view pass, bool begins) const {
    if (options_.observer) {
        options_.observer(pass, begins);
    }
}

/// Whether all that a pass draws into holds what it drew there last.
bool Executor::holds_last(const PassState& state, const PlanPass& pass) {
    for (std::size_t b = 0; b < pass.bindings.size(); ++b) {
        const PlanBinding& binding = pass.bindings[b];
        if (!makes_content(binding.access) || !binding.content ||
            !schedule_.contents()[*binding.content].is_drawn(*binding.content)) {
            continue;
        }
        const std::optional<std::size_t> texture = plan_.contents[*binding.content].texture;
        const std::uint64_t last = state.drawn_keys[b];
        if (!texture || last == 0 || pool_.backdrop(*texture).key != last) {
            return false;
        }
    }
    return true;
}

/// Whether nothing of what an output held before is seen in it.
bool Executor::is_new(const PassState& state, const PlanBinding& binding) const {
    const PlanContent& content = plan_.contents[*binding.content];
    return !(content.modifies && !schedule_.contents()[*content.modifies].empty) &&
           !(content.passthrough && state.work.kind == Work::Kind::update);
}

/// Whether an output gets its clear value where nothing has been drawn before it, rather than everywhere.
bool Executor::fills_after(const PassState& state, const PlanPass& pass, std::size_t binding) const {
    const auto drawn = [&](const PlanBinding& other) {
        return makes_content(other.access) && other.content &&
               schedule_.contents()[*other.content].is_drawn(*other.content);
    };
    if (!options_.fill_after || !state.ports[state.port_of_binding[binding]].behind_depth) {
        return false;
    }
    std::size_t colours = 0;
    bool behind = false;
    for (const PlanBinding& other : pass.bindings) {
        const bool is_depth = drawn(other) && info(plan_.contents[*other.content].format).is_depth;
        colours += drawn(other) && !is_depth ? 1 : 0;
        behind =
            behind || (is_depth && is_new(state, other) && plan_.contents[*other.content].clear[0] == 1.0F);
    }
    return behind && colours == 1 && is_new(state, pass.bindings[binding]);
}

/// Gives a pass's clear value to what it has left at the greatest depth.
void Executor::fill(const gl::Framebuffer& target, const Cleared& cleared) const {
    if (cleared.uncovered.empty()) {
        return;
    }
    const PixelRect& part = cleared.uncovered;
    target.bind();
    gl::apply(shared_.gl,
              {.depth_test = GL_LEQUAL, .scissor = gl::Rect{part.x, part.y, part.width, part.height}},
              {0, 0, target.width(), target.height()});
    const gl::Program& program = shared_.shaders.program(fill_program_);
    program.use();
    const std::array<float, 4>& v = cleared.value;
    program.set("u_value", glm::vec4(v[0], v[1], v[2], v[3]));
    shared_.no_vertices.bind();
    shared_.gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

Executor::Cleared Executor::clear(PassState& state, const PlanPass& pass, const gl::Framebuffer& target,
                                  const PixelRect& region) {
    Cleared cleared;
    const PixelRect all{0, 0, target.width(), target.height()};
    cleared.kept = state.work.goes_on && holds_last(state, pass);
    int colour = 0;
    for (std::size_t b = 0; b < pass.bindings.size(); ++b) {
        const PlanBinding& binding = pass.bindings[b];
        if (!makes_content(binding.access)) {
            continue;
        }
        const bool is_depth = binding.content && info(plan_.contents[*binding.content].format).is_depth;
        const int index = is_depth ? -1 : colour++;
        if (!binding.content || !schedule_.contents()[*binding.content].is_drawn(*binding.content)) {
            continue;
        }
        const PlanContent& content = plan_.contents[*binding.content];
        const bool continues = !is_new(state, binding);
        const bool overwritten =
            state.ports[state.port_of_binding[b]].overwrites && state.work.kind == Work::Kind::all;
        TargetPool::Backdrop unknown;
        TargetPool::Backdrop& backdrop = content.texture ? pool_.backdrop(*content.texture) : unknown;
        state.drawn_keys[b] = schedule_.contents()[*binding.content].key;
        backdrop.key = state.drawn_keys[b];
        if (continues || overwritten || cleared.kept) {
            backdrop.known = backdrop.known && !overwritten;
            backdrop.drawn = around(backdrop.drawn, region);
            continue;
        }
        const bool has_backdrop = backdrop.known && backdrop.clear == content.clear;
        const PixelRect part = has_backdrop ? backdrop.drawn : all;
        if (fills_after(state, pass, b)) {
            cleared.uncovered = around(part, region);
            cleared.value = stored(content);
        } else {
            clear_part(target, index, stored(content), part);
        }
        backdrop = {true, content.clear, region, state.drawn_keys[b]};
    }
    return cleared;
}

/// index: of a colour, or -1 for depth.
void Executor::clear_part(const gl::Framebuffer& target, int index, const std::array<float, 4>& value,
                          const PixelRect& part) const {
    const double share = static_cast<double>(part.width) * part.height /
                         (static_cast<double>(target.width()) * target.height());
    const bool whole = share * (capabilities_.software ? software_clear_gain : 1.0) >= 1.0;
    if (part.empty()) {
        return;
    }
    gl::RasterState state = gl::depth_tested_state;
    if (!whole) {
        state.scissor = gl::Rect{part.x, part.y, part.width, part.height};
    }
    gl::apply(shared_.gl, state, {0, 0, target.width(), target.height()});
    if (index < 0) {
        target.clear_depth(value[0]);
    } else {
        target.clear_colour(index, value);
    }
}

void Executor::check(std::string_view pass) const {
    if (!options_.check_errors) {
        return;
    }
    const GLenum error = gl::drain_errors(shared_.gl);
    if (error != GL_NO_ERROR) {
        throw Error(ErrorCode::gl, "pass '" + std::string(pass) + "'",
                    std::string("OpenGL reports: ") + gl::error_name(error));
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
                  state.key};
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
