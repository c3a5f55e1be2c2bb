#include "engine/core/schedule.h"

#include <gtest/gtest.h>

#include "tests/core/allocation_counter.h"
#include "tests/core/graph_builder.h"
#include "tests/core/schedule_machine.h"

namespace viscera {
namespace {

using namespace test;
using PassStatus::cached;
using PassStatus::idle;

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
    EXPECT_EQ(schedule.passes()[1].status, PassStatus::reduced);
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

}  // namespace
}  // namespace viscera
