#include <algorithm>

#include "engine/core/image.h"
#include "engine/runtime/executor.h"

// What a pass's targets hold before it draws, and behind what it has drawn.
namespace viscera {
namespace {

// Software renderers fill whole targets so much faster than parts of them.
constexpr double software_clear_gain = 8.0;

/// A clear value as its target holds it, rounded here, since drivers round what they clear with and what they
/// draw in different ways.
std::array<float, 4> stored(const PlanContent& content) {
    std::array<float, 4> value = content.clear;
    if (info(content.format).type == ChannelType::half) {
        std::ranges::transform(value, value.begin(), [](float v) { return half_to_float(float_to_half(v)); });
    }
    return value;
}

}  // namespace

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
                                  const PixelRegion& drawn) {
    Cleared cleared;
    const PixelRect region = drawn.bounds();
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
        const bool sets_region =
            state.ports[state.port_of_binding[b]].overwrites && drawn.rects().size() == 1;
        TargetPool::Backdrop unknown;
        TargetPool::Backdrop& backdrop = content.texture ? pool_.backdrop(*content.texture) : unknown;
        state.drawn_keys[b] = schedule_.contents()[*binding.content].key;
        backdrop.key = state.drawn_keys[b];
        if (continues || cleared.kept) {
            backdrop.drawn = around(backdrop.drawn, region);
            continue;
        }
        const bool has_backdrop = backdrop.known && backdrop.clear == content.clear;
        const PixelRect part = has_backdrop ? backdrop.drawn : all;
        if (sets_region) {
            clear_outside(target, index, stored(content), part, region);
        } else if (fills_after(state, pass, b)) {
            cleared.uncovered = around(part, region);
            cleared.value = stored(content);
        } else {
            clear_part(target, index, stored(content), part);
        }
        backdrop = {true, content.clear, region, state.drawn_keys[b]};
    }
    return cleared;
}

/// Whether a clear of so many pixels takes as long as one of the whole target.
bool Executor::costs_all(const gl::Framebuffer& target, std::int64_t area) const {
    const double share = static_cast<double>(area) / (static_cast<double>(target.width()) * target.height());
    return share * (capabilities_.software ? software_clear_gain : 1.0) >= 1.0;
}

/// Clears a part but for the pixels that are set anyway.
void Executor::clear_outside(const gl::Framebuffer& target, int index, const std::array<float, 4>& value,
                             const PixelRect& part, const PixelRect& set) const {
    std::int64_t area = 0;
    for (const PixelRect& rect : outside(part, set)) {
        area += rect.area();
    }
    if (costs_all(target, area)) {
        return clear_part(target, index, value, part);
    }
    for (const PixelRect& rect : outside(part, set)) {
        clear_part(target, index, value, rect);
    }
}

/// index: of a colour, or -1 for depth.
void Executor::clear_part(const gl::Framebuffer& target, int index, const std::array<float, 4>& value,
                          const PixelRect& part) const {
    if (part.empty()) {
        return;
    }
    gl::RasterState state = gl::depth_tested_state;
    if (!costs_all(target, part.area())) {
        state.scissor = gl::Rect{part.x, part.y, part.width, part.height};
    }
    gl::apply(shared_.gl, state, {0, 0, target.width(), target.height()});
    if (index < 0) {
        target.clear_depth(value[0]);
    } else {
        target.clear_colour(index, value);
    }
}

}  // namespace viscera
