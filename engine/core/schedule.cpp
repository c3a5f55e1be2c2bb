#include "engine/core/schedule.h"

#include <algorithm>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace viscera {
namespace {

// First word of each kind of key, so that two kinds never meet.
enum class KeyKind { empty, imported, imported_unknown, pass, pass_unknown };

std::uint64_t empty_key(const PlanContent& content) {
    return Hash()
        .add(KeyKind::empty)
        .add(content.format)
        .add(content.width)
        .add(content.height)
        .add(content.clear)
        .value();
}

}  // namespace

std::string_view to_string(PassStatus status) {
    switch (status) {
        case PassStatus::culled:
            return "culled";
        case PassStatus::idle:
            return "idle";
        case PassStatus::cached:
            return "cached";
        case PassStatus::reduced:
            return "reduced";
        case PassStatus::run:
            return "run";
    }
    return "unknown";
}

void Schedule::update(const Plan& plan, std::span<const PassWork> work, std::span<const std::uint64_t> held,
                      std::span<const std::uint64_t> imported_keys) {
    if (work.size() != plan.passes.size()) {
        throw Error(ErrorCode::usage, "schedule", "needs one work per pass");
    }
    begin(plan, held, imported_keys);
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        if (plan.passes[p].live) {
            this->work(plan, p, work[p]);
        }
    }
    decide(plan);
}

void Schedule::decide(const Plan& plan) {
    choose_passes(plan);
    find_wanted(plan);
    give_status(plan);
    settle_updates(plan);
    settle_outputs(plan);
    settle_history(plan);
}

void Schedule::begin(const Plan& plan, std::span<const std::uint64_t> held,
                     std::span<const std::uint64_t> imported_keys) {
    if (held.size() != plan.textures.size()) {
        throw Error(ErrorCode::usage, "schedule", "needs one key per texture");
    }
    ++frame_;
    works_.assign(plan.passes.size(), {});
    contents_.resize(plan.contents.size());
    std::size_t imported_count = 0;
    for (const PlanContent& content : plan.contents) {
        imported_count = std::max(imported_count, content.imported ? *content.imported + 1 : 0);
    }
    at_start_.assign(plan.textures.size() + imported_count, 0);
    std::ranges::copy(held, at_start_.begin());

    for (std::size_t c = 0; c < plan.contents.size(); ++c) {
        const PlanContent& content = plan.contents[c];
        contents_[c] = {0, c, false};
        if (content.imported && !content.writer) {
            const std::size_t i = *content.imported;
            const bool known = i < imported_keys.size() && imported_keys[i] != 0;
            contents_[c].key = Hash()
                                   .add(known ? KeyKind::imported : KeyKind::imported_unknown)
                                   .add(i)
                                   .add(known ? imported_keys[i] : frame_)
                                   .value();
            at_start_[slot(plan, c)] = contents_[c].key;
        }
    }
    for (const PlanHistory& history : plan.history) {
        ContentState& previous = contents_[history.previous];
        const std::uint64_t key = at_start_[slot(plan, history.previous)];
        const std::uint64_t nothing = empty_key(plan.contents[history.previous]);
        previous.empty = key == 0 || key == nothing;
        previous.key = previous.empty ? nothing : key;
    }
}

void Schedule::work(const Plan& plan, std::size_t pass, const PassWork& work) {
    works_[pass] = work;
    const auto& bindings = plan.passes[pass].bindings;
    const bool known = work.cacheable && work.key != 0;
    Hash inputs;
    inputs.add(known ? KeyKind::pass : KeyKind::pass_unknown).add(pass).add(known ? work.key : frame_);
    if (work.update) {
        // The same drawing in another part makes another picture.
        for (const PixelRect& part : work.touched.rects()) {
            inputs.add(part.x).add(part.y).add(part.width).add(part.height);
        }
        inputs.add(work.update);
    }
    for (std::size_t b = 0; b < bindings.size(); ++b) {
        if (!bindings[b].content) {
            continue;
        }
        std::optional<std::size_t> input = bindings[b].content;
        if (makes_content(bindings[b].access)) {
            input = plan.contents[*input].modifies;
        }
        if (input) {
            inputs.add(b).add(contents_[*input].key);
        }
    }
    for (std::size_t b = 0; b < bindings.size(); ++b) {
        if (!bindings[b].content || !makes_content(bindings[b].access)) {
            continue;
        }
        const PlanContent& content = plan.contents[*bindings[b].content];
        ContentState& state = contents_[*bindings[b].content];
        const bool left_empty = work.idle || (b < 32 && ((work.empty_bindings >> b) & 1U) != 0);
        if (!left_empty) {
            state.key = Hash(inputs).add(b).add(empty_key(content)).value();
        } else if (const auto source = content.modifies ? content.modifies : content.passthrough) {
            state = contents_[*source];
        } else {
            state.key = empty_key(content);
            state.empty = true;
        }
    }
}

std::size_t Schedule::slot(const Plan& plan, std::size_t content) const {
    const PlanContent& planned = plan.contents[content];
    return planned.imported ? plan.textures.size() + *planned.imported : planned.texture.value();
}

bool Schedule::is_in_place(const Plan& plan, std::size_t content) const {
    const ContentState& state = contents_[content];
    return state.empty || slots_[slot(plan, state.holder)] == state.key;
}

bool Schedule::history_stands(const PlanHistory& history) const {
    return !history.current || contents_[*history.current].key == contents_[history.previous].key;
}

bool Schedule::demand(const Plan& plan, std::size_t content) {
    if (is_in_place(plan, content)) {
        return false;
    }
    // Without a writer a content is always in place. A writer chosen just now is seen when played again.
    const auto writer = plan.contents[contents_[content].holder].writer;
    if (!writer || runs_[*writer] != 0) {
        return false;
    }
    runs_[*writer] = 1;
    return true;
}

bool Schedule::play(const Plan& plan) {
    bool grew = false;
    slots_ = at_start_;
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        if (runs_[p] == 0) {
            continue;
        }
        for (const PlanBinding& binding : plan.passes[p].bindings) {
            if (!binding.content) {
                continue;
            }
            if (!makes_content(binding.access)) {
                grew |= demand(plan, *binding.content);
            } else if (const auto base = plan.contents[*binding.content].modifies) {
                grew |= demand(plan, *base);
            }
        }
        for (const PlanBinding& binding : plan.passes[p].bindings) {
            // What the pass leaves empty, or lets something else stand in for, it does not draw into.
            if (binding.content && makes_content(binding.access) &&
                contents_[*binding.content].is_drawn(*binding.content)) {
                slots_[slot(plan, *binding.content)] = contents_[*binding.content].key;
            }
        }
    }
    for (const PlanOutput& output : plan.outputs) {
        grew |= demand(plan, output.content);
    }
    for (const PlanHistory& history : plan.history) {
        if (!history_stands(history)) {
            grew |= demand(plan, *history.current);
        }
    }
    return grew;
}

void Schedule::choose_passes(const Plan& plan) {
    runs_.assign(plan.passes.size(), 0);
    while (play(plan)) {
    }
}

void Schedule::find_wanted(const Plan& plan) {
    wanted_.assign(plan.passes.size(), 0);
    wanted_contents_.assign(plan.contents.size(), 0);
    const auto want = [&](std::size_t content) {
        if (!contents_[content].empty) {
            wanted_contents_[contents_[content].holder] = 1;
        }
    };
    for (const PlanOutput& output : plan.outputs) {
        want(output.content);
    }
    for (const PlanHistory& history : plan.history) {
        if (history.current) {
            want(*history.current);
        }
    }
    for (std::size_t p = plan.passes.size(); p-- > 0;) {
        const auto& bindings = plan.passes[p].bindings;
        const bool wanted = plan.passes[p].live && !works_[p].idle &&
                            std::ranges::any_of(bindings, [&](const PlanBinding& binding) {
                                return binding.content && makes_content(binding.access) &&
                                       wanted_contents_[*binding.content] != 0;
                            });
        wanted_[p] = wanted ? 1 : 0;
        if (wanted_[p] == 0) {
            continue;
        }
        for (const PlanBinding& binding : bindings) {
            if (!binding.content) {
                continue;
            }
            if (!makes_content(binding.access)) {
                want(*binding.content);
            } else if (const auto base = plan.contents[*binding.content].modifies) {
                want(*base);
            }
        }
    }
}

void Schedule::give_status(const Plan& plan) {
    using enum PassStatus;
    const auto or_else = [](std::string_view reason, std::string_view other) {
        return reason.empty() ? other : reason;
    };
    passes_.resize(plan.passes.size());
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        // Why it would rest is not why it runs.
        const bool restless = works_[p].rests && runs_[p] != 0;
        const std::string_view said = restless ? std::string_view{} : works_[p].reason;
        if (!plan.passes[p].live) {
            passes_[p] = {culled, plan.passes[p].reason};
        } else if (works_[p].idle) {
            passes_[p] = {idle, or_else(said, "nothing to draw")};
        } else if (wanted_[p] == 0) {
            passes_[p] = {culled, "no pass that draws needs it in this frame"};
        } else if (runs_[p] == 0 && works_[p].rests) {
            passes_[p] = {idle, or_else(said, "nothing has changed")};
        } else if (runs_[p] == 0) {
            passes_[p] = {cached, "inputs, parameters and camera unchanged"};
        } else if (works_[p].region || works_[p].update) {
            passes_[p] = {reduced, or_else(said, "only the touched region")};
        } else if (!works_[p].cacheable || works_[p].key == 0) {
            passes_[p] = {run, or_else(said, "cannot be cached")};
        } else {
            passes_[p] = {run, or_else(said, "changed, or its texture served another target since")};
        }
    }
}

/// Plays the chosen passes once more, now that it is known what each texture holds when.
void Schedule::settle_updates(const Plan& plan) {
    before_.clear();
    before_begin_.assign(plan.passes.size() + 1, 0);
    slots_ = at_start_;
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        before_begin_[p] = before_.size();
        if (runs_[p] == 0) {
            continue;
        }
        for (const PlanBinding& binding : plan.passes[p].bindings) {
            if (!binding.content || !makes_content(binding.access) ||
                !contents_[*binding.content].is_drawn(*binding.content)) {
                continue;
            }
            if (works_[p].update) {
                settle_update(plan, p, *binding.content);
            }
            slots_[slot(plan, *binding.content)] = contents_[*binding.content].key;
        }
    }
    before_begin_.back() = before_.size();
}

void Schedule::settle_update(const Plan& plan, std::size_t pass, std::size_t content) {
    const PlanContent& planned = plan.contents[content];
    const PixelRegion& touched = works_[pass].touched;
    const auto base = planned.modifies ? planned.modifies : planned.passthrough;
    if (!base) {
        return;
    }
    if (!planned.modifies) {
        Settlement step = settle(plan, *base, content);
        if (step.action == Settlement::Action::copy_parts) {
            PixelRegion parts;
            for (const PixelRect& part : step.parts.rects()) {
                parts.add(touched.covers(part) ? PixelRect{} : part);  // drawn in any case
            }
            step.parts = parts;
        }
        before_.push_back(step);
    }
    changes_.note(contents_[content].key, contents_[*base].key, touched);
}

Settlement Schedule::settle(const Plan& plan, std::size_t content, std::size_t where) {
    using enum Settlement::Action;
    const ContentState& state = contents_[content];
    const std::uint64_t lies_there = std::exchange(slots_[slot(plan, where)], state.key);
    if (lies_there == state.key) {
        return {where, none, where};
    }
    if (state.empty) {
        return {where, clear, state.holder};
    }
    if (const auto parts = changes_.between(lies_there, state.key)) {
        return {where, copy_parts, state.holder, *parts};
    }
    return {where, copy, state.holder};
}

void Schedule::settle_outputs(const Plan& plan) {
    outputs_.clear();
    for (const PlanOutput& output : plan.outputs) {
        // An output is shown from wherever it lies, but the host expects it in the texture it brought.
        const bool brought = plan.contents[output.content].imported.has_value();
        outputs_.push_back(
            settle(plan, output.content, brought ? output.content : contents_[output.content].holder));
    }
}

void Schedule::settle_history(const Plan& plan) {
    history_.clear();
    for (const PlanHistory& history : plan.history) {
        HistoryStep step;
        step.settlement = {history.previous, Settlement::Action::none, history.previous};
        if (!history_stands(history)) {
            const std::size_t current = *history.current;
            std::uint64_t& previous_slot = slots_[slot(plan, history.previous)];
            if (contents_[current].key == empty_key(plan.contents[history.previous])) {
                previous_slot = 0;  // as before the first frame: readers are told that it is empty
            } else {
                step.settlement = settle(plan, current, current);
                step.swap = true;
                std::swap(slots_[slot(plan, current)], previous_slot);
            }
        }
        history_.push_back(step);
    }
    const auto textures = static_cast<std::ptrdiff_t>(plan.textures.size());
    held_after_.assign(slots_.begin(), slots_.begin() + textures);
}

}  // namespace viscera
