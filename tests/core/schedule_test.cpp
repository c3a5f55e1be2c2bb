#include "engine/core/schedule.h"

#include <gtest/gtest.h>

#include <map>

#include "engine/core/error.h"
#include "tests/core/allocation_counter.h"
#include "tests/core/graph_builder.h"
#include "tests/core/random_graph.h"

namespace viscera {
namespace {

using namespace test;

std::size_t fold(std::size_t hash, std::size_t value) {
    return std::hash<std::string>()(std::to_string(hash) + "," + std::to_string(value));
}

// Pictures of four columns, each 16 pixels wide, of which updates touch some.
constexpr std::size_t columns = 4;
constexpr int column_width = 16;

PixelRect column(std::size_t i) {
    return {static_cast<int>(i) * column_width, 0, column_width, 64};
}

/// Pixel values that tell how they came about. Two are equal only when the same things were drawn.
using Picture = std::array<std::size_t, columns>;
constexpr Picture garbage{7, 7, 7, 7};

Picture uniform(std::size_t value) {
    Picture picture;
    picture.fill(value);
    return picture;
}

Picture cleared(const PlanContent& content) {
    return uniform(
        fold(static_cast<std::size_t>(content.clear[0] * 16.0F), static_cast<std::size_t>(content.format)));
}

std::size_t fold(std::size_t hash, const Picture& picture) {
    for (const std::size_t value : picture) {
        hash = fold(hash, value);
    }
    return hash;
}

/// Of what lies below, an update leaves all but the columns it touches.
Picture drawn_over(const Picture& below, const PassWork& work, std::size_t value) {
    Picture picture = below;
    for (std::size_t i = 0; i < columns; ++i) {
        if (!work.update || work.touched.covers(column(i))) {
            picture[i] = value + i;
        }
    }
    return picture;
}

bool leaves_empty(const PassWork& work, std::size_t binding) {
    return work.idle || ((work.empty_bindings >> binding) & 1U) != 0;
}

/// What the pictures of one frame are when every content has a texture of its own and nothing is skipped.
class Oracle {
  public:
    std::vector<Picture> frame(const Plan& plan, const std::vector<PassWork>& work,
                               const std::vector<std::size_t>& noise, Picture host) {
        std::vector<Picture> pictures(plan.contents.size(), garbage);
        for (std::size_t c = 0; c < plan.contents.size(); ++c) {
            if (plan.contents[c].imported && !plan.contents[c].writer) {
                pictures[c] = host;
            }
        }
        for (const PlanHistory& history : plan.history) {
            const auto last = last_.find(history.target);
            pictures[history.previous] =
                last == last_.end() ? cleared(plan.contents[history.previous]) : last->second;
        }
        for (std::size_t p = 0; p < plan.passes.size(); ++p) {
            if (plan.passes[p].live) {
                draw(plan, p, work[p], noise[p], pictures);
            }
        }
        for (const PlanHistory& history : plan.history) {
            last_[history.target] = pictures[history.current.value()];
        }
        return pictures;
    }

  private:
    static void draw(const Plan& plan, std::size_t p, const PassWork& work, std::size_t noise,
                     std::vector<Picture>& pictures) {
        std::size_t input = fold(p, fold(work.key, noise));
        for (const PlanBinding& b : plan.passes[p].bindings) {
            if (b.content && (b.access == Access::read || b.access == Access::previous)) {
                input = fold(input, pictures[*b.content]);
            } else if (b.content && b.access == Access::modify) {
                input = fold(input, pictures[*plan.contents[*b.content].modifies]);
            }
        }
        for (std::size_t i = 0; i < plan.passes[p].bindings.size(); ++i) {
            const PlanBinding& b = plan.passes[p].bindings[i];
            if (!b.content || b.access == Access::read || b.access == Access::previous) {
                continue;
            }
            const PlanContent& content = plan.contents[*b.content];
            const auto stand_in = content.modifies ? content.modifies : content.passthrough;
            const Picture below = stand_in ? pictures[*stand_in] : cleared(content);
            pictures[*b.content] =
                leaves_empty(work, i) ? below : drawn_over(below, work, fold(input, *b.content));
        }
    }

    std::map<std::string, Picture> last_;
};

/// An executor whose textures hold pictures; checks whatever it reads against the oracle's.
class Machine {
  public:
    void frame(const Plan& plan, const Schedule& schedule, const std::vector<PassWork>& work,
               const std::vector<std::size_t>& noise, Picture host, const std::vector<Picture>& expected) {
        textures_.resize(plan.textures.size(), garbage);
        host_ = host;
        drawn = 0;
        for (std::size_t p = 0; p < plan.passes.size(); ++p) {
            if (schedule.passes()[p].draws()) {
                draw(plan, schedule, p, work[p], noise[p], expected);
                ++drawn;
            }
        }
        for (std::size_t i = 0; i < plan.outputs.size(); ++i) {
            settle(plan, schedule.outputs()[i]);
        }
        for (std::size_t i = 0; i < plan.outputs.size(); ++i) {
            EXPECT_EQ(at(plan, schedule.outputs()[i].content), expected[plan.outputs[i].content]) << "output";
            if (plan.contents[plan.outputs[i].content].imported) {
                EXPECT_EQ(host_, expected[plan.outputs[i].content]) << "output in the host's texture";
            }
        }
        for (std::size_t i = 0; i < plan.history.size(); ++i) {
            const HistoryStep& step = schedule.history()[i];
            settle(plan, step.settlement);
            if (step.swap) {
                std::swap(at(plan, plan.history[i].previous), at(plan, *plan.history[i].current));
            }
        }
    }

    std::size_t drawn = 0;
    std::size_t copied_whole = 0;
    std::size_t copied_parts = 0;
    std::size_t copied_columns = 0;

  private:
    Picture& at(const Plan& plan, std::size_t content) {
        const PlanContent& c = plan.contents[content];
        return c.imported ? host_ : textures_.at(c.texture.value());
    }

    void settle(const Plan& plan, const Settlement& s) {
        if (s.action == Settlement::Action::clear) {
            at(plan, s.content) = cleared(plan.contents[s.source]);
        } else if (s.action == Settlement::Action::copy) {
            at(plan, s.content) = at(plan, s.source);
            ++copied_whole;
        } else if (s.action == Settlement::Action::copy_parts) {
            for (std::size_t i = 0; i < columns; ++i) {
                if (s.parts.covers(column(i))) {
                    at(plan, s.content)[i] = at(plan, s.source)[i];
                    ++copied_columns;
                }
            }
            ++copied_parts;
        }
    }

    Picture sample(const Plan& plan, const Schedule& schedule, std::size_t content) {
        const ContentState& state = schedule.contents()[content];
        return state.empty ? cleared(plan.contents[state.holder]) : at(plan, state.holder);
    }

    void draw(const Plan& plan, const Schedule& schedule, std::size_t p, const PassWork& work,
              std::size_t noise, const std::vector<Picture>& expected) {
        ASSERT_FALSE(work.idle);
        for (const Settlement& s : schedule.before(p)) {
            settle(plan, s);
        }
        std::size_t input = fold(p, fold(work.key, noise));
        for (const PlanBinding& b : plan.passes[p].bindings) {
            if (b.content && (b.access == Access::read || b.access == Access::previous)) {
                EXPECT_EQ(sample(plan, schedule, *b.content), expected[*b.content]) << "read of pass " << p;
                input = fold(input, sample(plan, schedule, *b.content));
            } else if (b.content && b.access == Access::modify) {
                const std::size_t base = *plan.contents[*b.content].modifies;
                const bool empty = schedule.contents()[base].empty;
                const Picture below = empty ? cleared(plan.contents[base]) : at(plan, *b.content);
                EXPECT_EQ(below, expected[base]) << "modify of pass " << p;
                input = fold(input, below);
            }
        }
        for (const PlanBinding& b : plan.passes[p].bindings) {
            if (b.content && (b.access == Access::write || b.access == Access::modify) &&
                schedule.contents()[*b.content].is_drawn(*b.content)) {
                const PlanContent& content = plan.contents[*b.content];
                const bool continues = (content.modifies && !schedule.contents()[*content.modifies].empty) ||
                                       (content.passthrough && work.update);
                const Picture below = continues          ? at(plan, *b.content)
                                      : content.modifies ? cleared(plan.contents[*content.modifies])
                                                         : cleared(content);
                at(plan, *b.content) = drawn_over(below, work, fold(input, *b.content));
            }
        }
    }

    std::vector<Picture> textures_;
    Picture host_{};
};

/// A static camera with something moving now and then: most keys stay, so that caches are hit.
std::vector<PassWork> random_work(Random& random, std::size_t passes) {
    std::vector<PassWork> work(passes);
    for (PassWork& w : work) {
        w.idle = chance(random, 25);
        w.region = chance(random, 10);
        w.update = !w.region && chance(random, 50);
        w.empty_bindings = chance(random, 30) ? static_cast<std::uint32_t>(random() % 16) : 0;
        w.cacheable = chance(random, 90);
        w.key = chance(random, 5) ? 0 : 1 + (chance(random, 15) ? pick(random, 3) : 0);
        for (std::size_t i = 0; i < columns; ++i) {
            w.touched.add(chance(random, 40) ? column(i) : PixelRect{});
        }
    }
    return work;
}

TEST(Schedule, RandomGraphsShowWhatTheyShowWithoutSkipping) {
    Random random(20240229);
    std::size_t graphs = 0;
    std::size_t skipped = 0;
    std::size_t swaps = 0;
    std::size_t shared = 0;
    std::size_t settled = 0;
    std::size_t copied_parts = 0;
    while (graphs < 4000 && !HasFailure()) {
        Graph graph = random_graph(random);
        for (TargetDesc& target : graph.targets) {
            target.clear[0] = chance(random, 30) ? 1.0F : 0.0F;
        }
        const CompileResult result = compile(graph, 64, 64);
        if (!result.faults.empty() || graph.outputs.empty()) {
            continue;
        }
        ++graphs;
        const Plan& plan = result.plan;
        Schedule schedule;
        Oracle oracle;
        Machine machine;
        std::vector<std::uint64_t> held(plan.textures.size(), 0);
        std::vector<PassWork> work = random_work(random, plan.passes.size());
        for (std::size_t frame = 0; frame < 8; ++frame) {
            if (!chance(random, 30)) {
                const auto fresh = random_work(random, plan.passes.size());
                work[pick(random, work.size())] = fresh[0];
            }
            std::vector<std::size_t> noise(plan.passes.size(), 0);
            for (std::size_t p = 0; p < noise.size(); ++p) {
                noise[p] = work[p].cacheable && work[p].key != 0 ? 0 : random();
            }
            const std::uint64_t host_key = chance(random, 20) ? 0 : pick(random, 2);
            const Picture host = uniform(host_key == 0 ? random() : 1000 + host_key);
            schedule.update(plan, work, held, std::array{host_key});
            const auto expected = oracle.frame(plan, work, noise, host);
            machine.frame(plan, schedule, work, noise, host, expected);
            held.assign(schedule.held_after().begin(), schedule.held_after().end());
            skipped += plan.passes.size() - machine.drawn;
            for (const HistoryStep& step : schedule.history()) {
                swaps += step.swap ? 1 : 0;
            }
            for (const Settlement& s : schedule.outputs()) {
                settled += s.action != Settlement::Action::none ? 1 : 0;
            }
        }
        std::size_t apart = 0;
        for (const PlanContent& content : plan.contents) {
            apart += content.texture && !content.modifies ? 1 : 0;
        }
        shared += apart - plan.textures.size();
        copied_parts += machine.copied_parts;
        if (HasFailure()) {
            ADD_FAILURE() << "graph " << graphs;
        }
    }
    // Else the graphs would prove nothing.
    EXPECT_GT(skipped, 1000U);
    EXPECT_GT(swaps, 100U);
    EXPECT_GT(shared, 100U);
    EXPECT_GT(settled, 100U);
    EXPECT_GT(copied_parts, 10U);
}

/// a -> b -> out, and mark reads b.
Graph chain(bool passthrough = true) {
    Graph graph;
    graph.targets = {target("a"), target("b"), target("out")};
    graph.passes = {
        pass("first", {write("a")}),
        pass("second", {read("a"), write("b", passthrough ? "a" : "")}),
        pass("third", {read("b"), write("out")}),
    };
    graph.outputs = {"out"};
    return graph;
}

class ScheduleOfChain : public testing::Test {
  protected:
    void frame() {
        schedule.update(plan, work, held);
        held.assign(schedule.held_after().begin(), schedule.held_after().end());
    }
    std::vector<PassStatus> statuses() const {
        std::vector<PassStatus> all;
        for (const PassDecision& pass : schedule.passes()) {
            all.push_back(pass.status);
        }
        return all;
    }

    Plan plan = compile_or_throw(chain(), 32, 32);
    std::vector<PassWork> work = std::vector<PassWork>(3, PassWork{.key = 5});
    std::vector<std::uint64_t> held = std::vector<std::uint64_t>(plan.textures.size(), 0);
    Schedule schedule;
};

using enum PassStatus;

TEST_F(ScheduleOfChain, FirstFrameRunsAllSecondNone) {
    frame();
    EXPECT_EQ(statuses(), (std::vector{run, run, run}));
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, cached, cached}));
    EXPECT_EQ(schedule.passes()[0].reason, "inputs, parameters and camera unchanged");
    EXPECT_EQ(schedule.outputs()[0].action, Settlement::Action::none);
}

TEST_F(ScheduleOfChain, ChangeReachesOnlyWhatDependsOnIt) {
    frame();
    work[2].key = 6;
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, cached, run}));
    work[1].key = 7;
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, run, run}));
    work[0].key = 8;
    frame();
    EXPECT_EQ(statuses(), (std::vector{run, run, run}));
}

TEST_F(ScheduleOfChain, WhatLostItsTextureToAnotherIsDrawnAgainWhenNeeded) {
    plan = compile_or_throw(chain(false), 32, 32);  // 'a' and 'out' share
    held.assign(plan.textures.size(), 0);
    ASSERT_EQ(held.size(), 2U);
    frame();
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, cached, cached}));
    work[2].key = 6;
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, cached, run})) << "what 'second' made still stands";
    work[1].key = 7;
    frame();
    EXPECT_EQ(statuses(), (std::vector{run, run, run}));
}

TEST_F(ScheduleOfChain, GoingBackToAnOldKeyDoesNotFindItsPicture) {
    frame();
    work[2].key = 6;
    frame();
    work[2].key = 5;
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, cached, run}));
}

TEST_F(ScheduleOfChain, IdlePassStandsAsideForItsPassthrough) {
    work[1].idle = true;
    work[1].reason = "no emitter";
    frame();
    EXPECT_EQ(statuses(), (std::vector{run, idle, run}));
    EXPECT_EQ(schedule.passes()[1].reason, "no emitter");
    const std::size_t a = *plan.passes[1].bindings[0].content;
    const std::size_t b = *plan.passes[1].bindings[1].content;
    EXPECT_EQ(schedule.contents()[b].holder, a);
    EXPECT_EQ(schedule.contents()[b].key, schedule.contents()[a].key);
    EXPECT_FALSE(schedule.contents()[b].empty);
}

TEST_F(ScheduleOfChain, EmptyGoesThroughIdlePassesAndIsClearedAtTheOutput) {
    work[0].idle = work[1].idle = work[2].idle = true;
    frame();
    EXPECT_EQ(statuses(), (std::vector{idle, idle, idle}));
    EXPECT_TRUE(schedule.contents()[plan.outputs[0].content].empty);
    EXPECT_EQ(schedule.outputs()[0].action, Settlement::Action::clear);
    frame();
    EXPECT_EQ(schedule.outputs()[0].action, Settlement::Action::none) << "it is clear already";
}

TEST_F(ScheduleOfChain, InputsOfAnIdlePassWithoutPassthroughAreCulled) {
    work[2].idle = true;
    frame();
    EXPECT_EQ(statuses(), (std::vector{culled, culled, idle}));
    EXPECT_EQ(schedule.passes()[0].reason, "no pass that draws needs it in this frame");
}

TEST_F(ScheduleOfChain, UncacheablePassAlwaysRunsWithAllBelowIt) {
    frame();
    work[1].cacheable = false;
    for (int i = 0; i < 3; ++i) {
        frame();
        EXPECT_EQ(schedule.passes()[1].status, run);
        EXPECT_EQ(schedule.passes()[1].reason, "cannot be cached");
        EXPECT_EQ(schedule.passes()[2].status, run);
    }
    work[1] = {.key = 0};
    frame();
    frame();
    EXPECT_EQ(schedule.passes()[1].status, run) << "key 0";
}

TEST_F(ScheduleOfChain, RegionIsReportedAsReduced) {
    work[0].region = true;
    work[0].reason = "3 of 40 bricks";
    frame();
    EXPECT_EQ(statuses(), (std::vector{reduced, run, run}));
    EXPECT_EQ(schedule.passes()[0].reason, "3 of 40 bricks");
    frame();
    EXPECT_EQ(statuses(), (std::vector{cached, cached, cached}));
}

TEST_F(ScheduleOfChain, BindingLeftEmptyIsAsThatOfAnIdlePass) {
    work[1].empty_bindings = 2;  // its output; it has a passthrough
    work[0].empty_bindings = 1;
    frame();
    const std::size_t a = *plan.passes[1].bindings[0].content;
    const std::size_t b = *plan.passes[1].bindings[1].content;
    EXPECT_TRUE(schedule.contents()[a].empty);
    EXPECT_TRUE(schedule.contents()[b].empty);
    EXPECT_EQ(schedule.contents()[b].holder, a);
    EXPECT_EQ(statuses(), (std::vector{culled, culled, run}));
}

TEST_F(ScheduleOfChain, InStepsEmptinessIsKnownBeforeTheNextWork) {
    schedule.begin(plan, held);
    schedule.work(plan, 0, {.idle = true});
    EXPECT_TRUE(schedule.contents()[*plan.passes[1].bindings[0].content].empty);
    schedule.work(plan, 1, {.idle = true});
    EXPECT_TRUE(schedule.contents()[*plan.passes[2].bindings[0].content].empty);
    schedule.work(plan, 2, {.key = 1});
    schedule.decide(plan);
    EXPECT_EQ(statuses(), (std::vector{idle, idle, run}));
}

TEST_F(ScheduleOfChain, LostTextureIsDrawnAgain) {
    frame();
    held[*plan.contents[plan.outputs[0].content].texture] = 0;
    frame();
    EXPECT_EQ(schedule.passes()[2].status, run);
    EXPECT_EQ(schedule.passes()[1].status, cached);
}

TEST_F(ScheduleOfChain, WarmUpdateAllocatesNothing) {
    frame();
    frame();
    work[1].cacheable = false;
    const std::size_t before = allocation_count();
    schedule.update(plan, work, held);
    EXPECT_EQ(allocation_count() - before, 0U);
    const std::vector<int> counted(3);
    EXPECT_GT(allocation_count() - before, 0U) << "the counter counts";
}

TEST_F(ScheduleOfChain, WrongCountsAreRefused) {
    EXPECT_THROW(schedule.update(plan, std::span(work).first(2), held), Error);
    EXPECT_THROW(schedule.update(plan, work, std::span(held).first(1)), Error);
}

TEST(Schedule, IdleSimulationKeepsItsStateWithoutACopy) {
    Graph graph;
    graph.targets = {target("state"), target("out")};
    graph.passes = {
        pass("simulate", {previous("state"), write("state", "state.last")}),
        pass("show", {read("state"), write("out")}),
    };
    graph.outputs = {"out"};
    const Plan plan = compile_or_throw(graph, 32, 32);
    Schedule schedule;
    std::vector<std::uint64_t> held(plan.textures.size(), 0);
    std::vector<PassWork> work{{.key = 1}, {.key = 1}};
    const auto frame = [&] {
        schedule.update(plan, work, held);
        held.assign(schedule.held_after().begin(), schedule.held_after().end());
    };
    frame();
    EXPECT_TRUE(schedule.contents()[plan.history[0].previous].empty) << "first frame";
    EXPECT_TRUE(schedule.history()[0].swap);
    frame();
    EXPECT_FALSE(schedule.contents()[plan.history[0].previous].empty);
    EXPECT_EQ(schedule.passes()[0].status, run) << "each state makes the next";
    work[0].idle = true;
    frame();
    EXPECT_FALSE(schedule.history()[0].swap);
    EXPECT_EQ(schedule.contents()[*plan.history[0].current].holder, plan.history[0].previous);
    EXPECT_EQ(schedule.passes()[1].status, cached) << "the state it stands in for is the one last shown";
}

/// A state that two passes update one after the other, and what is shown of it.
class ScheduleOfUpdates : public testing::Test {
  protected:
    ScheduleOfUpdates() {
        work[2].key = 1;
        work[0] = work[1] = {.idle = true};
    }
    static PassWork touches(std::initializer_list<std::size_t> touched) {
        PassWork update{.key = 1, .update = true};
        for (const std::size_t i : touched) {
            update.touched.add(column(i));
        }
        return update;
    }
    /// Columns copied, all before the drawing and after it; a whole copy counts as all columns.
    std::size_t frame() {
        schedule.update(plan, work, held);
        machine.copied_whole = machine.copied_columns = 0;
        machine.frame(plan, schedule, work, {0, 0, 0}, {}, oracle.frame(plan, work, {0, 0, 0}, {}));
        held.assign(schedule.held_after().begin(), schedule.held_after().end());
        return machine.copied_whole * columns + machine.copied_columns;
    }

    static Graph graph() {
        Graph graph;
        graph.targets = {target("state"), target("out")};
        graph.passes = {
            pass("first", {previous("state"), write("state", "state.last")}),
            pass("second", {read("state"), write("state", "state")}),
            pass("show", {read("state"), write("out")}),
        };
        graph.outputs = {"out"};
        return graph;
    }
    Plan plan = compile_or_throw(graph(), 64, 64);
    std::vector<PassWork> work = std::vector<PassWork>(3);
    std::vector<std::uint64_t> held = std::vector<std::uint64_t>(plan.textures.size(), 0);
    Schedule schedule;
    Machine machine;
    Oracle oracle;
};

TEST_F(ScheduleOfUpdates, OnlyWhatChangedSinceIsCopied) {
    work[1] = touches({0});
    frame();
    frame();  // by now each texture has held some state
    EXPECT_EQ(schedule.passes()[1].status, reduced);
    EXPECT_EQ(schedule.passes()[1].reason, "only the touched region");
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(frame(), 0U) << "the same region again is drawn anew in any case";
    }
    work[1] = touches({2});
    EXPECT_EQ(frame(), 1U) << "column 0";
    EXPECT_EQ(frame(), 0U);
    work[1] = touches({1, 3});
    EXPECT_EQ(frame(), 1U) << "column 2";
    work[1] = {.idle = true};
    EXPECT_EQ(frame(), 0U) << "an idle frame";
    EXPECT_EQ(schedule.passes()[2].status, cached);
    work[1] = touches({3});
    EXPECT_EQ(frame(), 1U) << "column 1 of before the idle frame";
}

TEST_F(ScheduleOfUpdates, PassesInARowCopyOnlyWhatChanged) {
    work[0] = touches({0});
    work[1] = touches({2});
    for (int i = 0; i < 4; ++i) {
        frame();
    }
    EXPECT_LE(frame(), 3U) << "of the twelve of three textures";
    work[1] = {.idle = true};
    frame();
    EXPECT_LE(frame(), 2U) << "what the first made stands in for the second's";
}

TEST_F(ScheduleOfUpdates, RandomUpdatesShowWhatWholeCopiesShow) {
    Random random(11);
    std::size_t copied = 0;
    for (int i = 0; i < 2000 && !HasFailure(); ++i) {
        for (std::size_t p = 0; p < 2; ++p) {
            work[p] = chance(random, 40) ? PassWork{.idle = true} : touches({pick(random, columns)});
            work[p].update = !chance(random, 5);  // now and then all is drawn
        }
        if (chance(random, 5)) {
            oracle = {};
            held.assign(held.size(), 0);  // as after a failed frame: the state begins anew
        }
        copied += frame();
    }
    EXPECT_GT(copied, 500U);
    EXPECT_LT(copied, 2000U * 3U) << "of 24000";
}

TEST_F(ScheduleOfUpdates, ALostTextureIsCopiedWhole) {
    work[1] = touches({0});
    for (int i = 0; i < 3; ++i) {
        frame();
    }
    held[*plan.contents[*plan.history[0].current].texture] = 0;
    schedule.update(plan, work, held);
    EXPECT_EQ(schedule.before(1).front().action, Settlement::Action::copy);
}

TEST_F(ScheduleOfUpdates, TheFirstUpdateIsMadeOfNothing) {
    work[1] = touches({0});
    schedule.update(plan, work, held);
    ASSERT_EQ(schedule.before(1).size(), 1U);
    EXPECT_EQ(schedule.before(1).front().action, Settlement::Action::clear);
    EXPECT_TRUE(schedule.before(0).empty());
}

TEST_F(ScheduleOfUpdates, WarmUpdatesAllocateNothing) {
    work[1] = touches({0});
    for (int i = 0; i < 3; ++i) {
        frame();
    }
    const std::size_t before = allocation_count();
    for (int i = 0; i < 3; ++i) {
        schedule.update(plan, work, held);
        std::ranges::copy(schedule.held_after(), held.begin());
    }
    EXPECT_EQ(allocation_count() - before, 0U);
}

TEST(Schedule, StatusWords) {
    EXPECT_EQ(to_string(culled), "culled");
    EXPECT_EQ(to_string(idle), "idle");
    EXPECT_EQ(to_string(cached), "cached");
    EXPECT_EQ(to_string(reduced), "reduced");
    EXPECT_EQ(to_string(run), "run");
}

}  // namespace
}  // namespace viscera
