#include "engine/core/plan_dump.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "tests/core/graph_builder.h"
#include "tests/core/random_graph.h"

namespace viscera {
namespace {

using namespace test;

Graph small_graph() {
    Graph graph;
    graph.targets = {target("vessel.main"), target("summary"), target("final"),
                     target("trace", PixelFormat::r32f, {0.5, 0, 0})};
    graph.imported = {{"photo", PixelFormat::rgba8, 32, 16, false}};
    graph.passes = {
        pass("vessels", {write("vessel.main")}),
        pass("summarize", {read("vessel.main"), previous("summary"), write("summary")}),
        pass("composite", {read("summary"), read("photo"), write("final")}),
        pass("mark", {modify("final")}),
        pass("debug", {read("summary"), write("trace")}),
        pass("off", {write("final")}),
    };
    graph.passes[5].enabled = false;
    graph.outputs = {"final"};
    return graph;
}

TEST(PlanDump, TableOfASmallGraph) {
    EXPECT_EQ(to_table(compile_or_throw(small_graph(), 512, 256)),
              R"(frame 512x256, 4 of 6 passes live

#  pass       effect  live  why                         reads                            writes
0  vessels    effect  yes   read by 'summarize'         -                                vessel.main
1  summarize  effect  yes   read by 'composite'         vessel.main, summary (previous)  summary
2  composite  effect  yes   modified by 'mark'          summary, photo                   final
3  mark       effect  yes   writes output 'final'       -                                final (modify)
4  debug      effect  no    culled: no output needs it  summary                          trace
5  off        effect  no    disabled                    -                                -

target              format   size     passes    place
photo               rgba8    32x16    0 to 2    imported 0
vessel.main         rgba16f  512x256  0 to 1    texture 0
summary (previous)  rgba16f  512x256  0 to end  texture 1
summary             rgba16f  512x256  1 to end  texture 2
final               rgba16f  512x256  2 to 3    texture 0
final               rgba16f  512x256  3 to end  texture 0
trace               r32f     256x128  4 to 4    none

memory: 3.00 MiB in 3 textures; without sharing 4.00 MiB in 4
)");
}

TEST(PlanDump, TableOfNothing) {
    EXPECT_EQ(to_table(Plan{}),
              "frame 0x0, 0 of 0 passes live\n\n#  pass  effect  live  why  reads  writes\n\n"
              "target  format  size  passes  place\n\n"
              "memory: 0.00 MiB in 0 textures; without sharing 0.00 MiB in 0\n");
}

TEST(PlanDump, DotOfASmallGraph) {
    Graph graph;
    graph.targets = {target("trail"), target("spare", PixelFormat::r8)};
    graph.imported = {{"photo", PixelFormat::rgba8, 32, 16, false}};
    graph.passes = {pass("fade", {previous("trail"), read("photo"), write("trail")}),
                    pass("mark", {modify("trail")}), pass("debug", {write("spare")})};
    graph.outputs = {"trail"};
    EXPECT_EQ(to_dot(compile_or_throw(graph, 8, 4)), R"(digraph plan {
  rankdir=LR;
  p0 [shape=box, label="fade (effect): modified by 'mark'"];
  p1 [shape=box, label="mark (effect): writes output 'trail'"];
  p2 [shape=box, label="debug (effect): culled: no output needs it", style=filled, fillcolor=grey85, color=grey50, fontcolor=grey40];
  c0 [shape=ellipse, label="photo: rgba8 32x16, imported 0"];
  c1 [shape=ellipse, label="trail (previous): rgba16f 8x4, texture 0"];
  c2 [shape=ellipse, label="trail: rgba16f 8x4, texture 1"];
  c3 [shape=ellipse, label="trail: rgba16f 8x4, texture 1", penwidth=3];
  c4 [shape=ellipse, label="spare: r8 8x4, none"];
  c1 -> p0 [style=dashed, label="previous"];
  c0 -> p0;
  p0 -> c2;
  c2 -> p1 [label="modify"];
  p1 -> c3;
  p2 -> c4;
  c3 -> c1 [style=dashed, constraint=false, label="next frame"];
}
)");
}

/// Every line a statement of the small part of the DOT language that is used, every edge between nodes that
/// are declared above it, and between a pass and a content.
void check_structure(const std::string& dot, const Plan& plan) {
    const std::regex node(R"(  ([pc]\d+) \[shape=(box|ellipse), label="([^"\\]|\\.)*"(, \w+=\w+)*\];)");
    const std::regex edge(R"(  ([pc]\d+) -> ([pc]\d+)( \[\w+=(\w+|"[^"]*")(, \w+=(\w+|"[^"]*"))*\])?;)");
    std::istringstream lines(dot);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "digraph plan {");
    std::getline(lines, line);
    EXPECT_EQ(line, "  rankdir=LR;");
    std::set<std::string> nodes;
    std::size_t edges = 0;
    while (std::getline(lines, line) && line != "}") {
        std::smatch match;
        if (std::regex_match(line, match, node)) {
            EXPECT_TRUE(nodes.insert(match[1]).second) << line;
            EXPECT_EQ(match[1].str()[0] == 'p', match[2] == "box") << line;
        } else if (std::regex_match(line, match, edge)) {
            EXPECT_TRUE(nodes.contains(match[1]) && nodes.contains(match[2])) << line;
            const bool over_frames = line.find("next frame") != std::string::npos;
            EXPECT_EQ(match[1].str()[0] == match[2].str()[0], over_frames) << line;
            ++edges;
        } else {
            ADD_FAILURE() << "not understood: " << line;
        }
    }
    EXPECT_EQ(line, "}");
    EXPECT_FALSE(std::getline(lines, line));
    EXPECT_EQ(nodes.size(), plan.passes.size() + plan.contents.size());
    std::size_t expected = plan.history.size();
    for (const PlanPass& pass : plan.passes) {
        for (const PlanBinding& binding : pass.bindings) {
            expected += binding.content ? (binding.access == Access::modify ? 2 : 1) : 0;
        }
    }
    EXPECT_EQ(edges, expected);
}

TEST(PlanDump, DotHoldsTogetherOnRandomGraphs) {
    Random random(31);
    for (int valid = 0; valid < 100;) {
        const CompileResult result = compile(random_graph(random), 64, 64);
        if (result.faults.empty()) {
            check_structure(to_dot(result.plan), result.plan);
            ++valid;
        }
    }
}

TEST(PlanDump, DotQuotesWhatAUserWrote) {
    Graph graph;
    graph.targets = {target("out")};
    graph.passes = {pass("a \"b\" \\ c\nd", {write("out")})};
    graph.outputs = {"out"};
    const Plan plan = compile_or_throw(graph, 8, 8);
    check_structure(to_dot(plan), plan);
    EXPECT_NE(to_dot(plan).find(R"(a \"b\" \\ c d)"), std::string::npos);
}

TEST(PlanDump, DeadPassesAreGrey) {
    const std::string dot = to_dot(compile_or_throw(small_graph(), 64, 64));
    std::istringstream lines(dot);
    std::size_t grey = 0;
    for (std::string line; std::getline(lines, line);) {
        const bool dead =
            line.find("culled") != std::string::npos || line.find("disabled") != std::string::npos;
        EXPECT_EQ(dead, line.find("fillcolor=grey85") != std::string::npos) << line;
        grey += dead ? 1 : 0;
    }
    EXPECT_EQ(grey, 2U);
}

}  // namespace
}  // namespace viscera
