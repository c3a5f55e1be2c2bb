#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/change_log.h"
#include "engine/core/plan.h"

namespace viscera {

/// What the effect of one pass has to do in this frame.
struct PassWork {
    bool idle = false;      ///< nothing to draw: no injection, no emitter, an empty region
    bool region = false;    ///< draws only a part of its targets, or with fewer features
    bool cacheable = true;  ///< the same key and the same inputs give the same picture
    std::uint64_t key = 0;  ///< hash of all that the picture depends on besides the inputs; 0: not cacheable
    std::string_view reason{};  ///< in the effect's words; must outlive the frame
    /// Outside `touched` its writes hold what their passthrough holds, its modifies what stood there. A write
    /// without a passthrough is clear there.
    bool update = false;
    PixelRegion touched{};  ///< on the targets
    /// Bit b: into binding b of the pass nothing is drawn though the pass is not idle.
    std::uint32_t empty_bindings = 0;
    bool rests = false;  ///< nothing has happened since `key` was drawn: idle rather than cached
};

enum class PassStatus { culled, idle, cached, reduced, run };

[[nodiscard]] std::string_view to_string(PassStatus status);

struct PassDecision {
    PassStatus status = PassStatus::culled;
    std::string_view reason;

    [[nodiscard]] bool draws() const { return status == PassStatus::reduced || status == PassStatus::run; }
};

/// What one content of the plan is in this frame.
struct ContentState {
    std::uint64_t key = 0;   ///< names the picture: equal keys, equal pixels; 0: culled with its pass
    std::size_t holder = 0;  ///< content whose texture holds the picture: itself, or what stands in for it
    bool empty = false;      ///< nothing but the clear value of `holder`; its texture holds no such thing

    /// Whether its pass draws it when the pass runs; `self` is the content's own index.
    [[nodiscard]] bool is_drawn(std::size_t self) const { return !empty && holder == self; }
};

/// What is left to do so that a texture holds the picture when all passes are through, or what it is to hold
/// before a pass updates it.
struct Settlement {
    enum class Action { none, clear, copy, copy_parts };
    std::size_t content = 0;  ///< in whose texture the picture is to lie
    Action action = Action::none;
    std::size_t source = 0;  ///< content to copy from, or whose clear value to fill with
    PixelRegion parts{};     ///< copy_parts: all that differs between the two textures
};

/// End of the frame for one Plan::history: settle `current`, then swap the textures of `current` and
/// `previous`. No swap: `previous` already is what the next frame is to see.
struct HistoryStep {
    Settlement settlement;
    bool swap = false;
};

/// Decides each frame what need not be done: the heart of 'skip what a scene doesn't need'.
///
/// Every content gets a key, made from its pass's key and the keys of all that the pass reads. An idle pass,
/// or one binding that a pass leaves empty, makes nothing: the content is its passthrough (or what it
/// modifies), or else empty. Going back from
/// the outputs, a content whose texture already holds its key needs nothing; any other has its writer run,
/// which in turn demands its inputs. Since contents take turns in one texture, a pass that runs destroys what
/// stood there: the frame is played through in order until every running pass finds each input in place.
///
/// An update makes a new content out of its passthrough by drawing a part of it. The texture it draws into
/// mostly holds that content's forerunner, so only what has changed since is copied there before: a log of
/// the last updates (ChangeLog) tells what that is. Unknown differences are copied whole.
///
/// The executor then, in the order of the passes, for each that draws(): does before(), attaches each content
/// c that contents()[c].is_drawn(c), clears what it writes, and what it modifies where the content below
/// (PlanContent::modifies) is empty; reads content c from the texture of contents()[c].holder, or is told
/// that it is empty. At the end it does outputs(), and once nobody reads this frame any more, history().
///
/// One Schedule belongs to one set of textures. A warm update() allocates nothing.
class Schedule {
  public:
    /// `work`: one per pass; ignored for passes that are not live. `held`: for each plan texture the key that
    /// it holds, 0 for none (held_after() of the last frame). `imported_keys`: for each Graph::imported a
    /// hash that changes with its pixels; 0 or missing: changed. Throws Error(usage) on wrong counts.
    void update(const Plan& plan, std::span<const PassWork> work, std::span<const std::uint64_t> held,
                std::span<const std::uint64_t> imported_keys = {});

    /// The same in steps, for callers whose works depend on what is empty above them: begin(), work() for
    /// each live pass in order, after which contents() is right for all that the pass writes, and decide().
    void begin(const Plan& plan, std::span<const std::uint64_t> held,
               std::span<const std::uint64_t> imported_keys = {});
    void work(const Plan& plan, std::size_t pass, const PassWork& work);
    void decide(const Plan& plan);

    [[nodiscard]] std::span<const PassDecision> passes() const { return passes_; }
    [[nodiscard]] std::span<const ContentState> contents() const { return contents_; }
    /// What the textures that a pass updates are to hold before it draws.
    [[nodiscard]] std::span<const Settlement> before(std::size_t pass) const {
        return std::span(before_).subspan(before_begin_[pass], before_begin_[pass + 1] - before_begin_[pass]);
    }
    [[nodiscard]] std::span<const Settlement> outputs() const { return outputs_; }
    [[nodiscard]] std::span<const HistoryStep> history() const { return history_; }
    /// Outside of this, the picture of key `newer` is as that of `older`; none: not known.
    [[nodiscard]] std::optional<PixelRegion> changed(std::uint64_t older, std::uint64_t newer) const {
        return changes_.between(older, newer);
    }
    /// What each plan texture holds when all of the above is done, swaps included. A texture whose pass
    /// failed holds 0.
    [[nodiscard]] std::span<const std::uint64_t> held_after() const { return held_after_; }

  private:
    void choose_passes(const Plan& plan);
    bool play(const Plan& plan);
    bool demand(const Plan& plan, std::size_t content);
    void find_wanted(const Plan& plan);
    void give_status(const Plan& plan);
    void settle_updates(const Plan& plan);
    void settle_update(const Plan& plan, std::size_t pass, std::size_t content);
    void settle_outputs(const Plan& plan);
    void settle_history(const Plan& plan);
    Settlement settle(const Plan& plan, std::size_t content, std::size_t where);
    [[nodiscard]] std::size_t slot(const Plan& plan, std::size_t content) const;
    [[nodiscard]] bool is_in_place(const Plan& plan, std::size_t content) const;
    [[nodiscard]] bool history_stands(const PlanHistory& history) const;

    std::uint64_t frame_ = 0;  ///< makes the keys of what is not cacheable unlike any before
    std::vector<PassWork> works_;
    std::vector<PassDecision> passes_;
    std::vector<ContentState> contents_;
    ChangeLog changes_;
    std::vector<Settlement> before_;
    std::vector<std::size_t> before_begin_;  ///< by pass, and the end
    std::vector<Settlement> outputs_;
    std::vector<HistoryStep> history_;
    std::vector<std::uint64_t> held_after_;
    std::vector<std::uint64_t> at_start_;  ///< keys by slot: the plan's textures, then the imported ones
    std::vector<std::uint64_t> slots_;     ///< the same while the frame is played
    std::vector<char> runs_;               ///< by pass
    std::vector<char> wanted_;             ///< by pass: something that is shown depends on it
    std::vector<char> wanted_contents_;
};

}  // namespace viscera
