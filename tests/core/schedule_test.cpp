#include "engine/core/schedule.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/core/allocation_counter.h"
#include "tests/core/graph_builder.h"
#include "tests/core/schedule_machine.h"

namespace viscera {
namespace {

using namespace test;

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

using PassStatus::cached;
using PassStatus::culled;
using PassStatus::idle;
using PassStatus::run;

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
    EXPECT_EQ(statuses(), (std::vector{PassStatus::reduced, run, run}));
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

TEST(Schedule, StatusWords) {
    EXPECT_EQ(to_string(culled), "culled");
    EXPECT_EQ(to_string(idle), "idle");
    EXPECT_EQ(to_string(cached), "cached");
    EXPECT_EQ(to_string(PassStatus::reduced), "reduced");
    EXPECT_EQ(to_string(run), "run");
}

}  // namespace
}  // namespace viscera
