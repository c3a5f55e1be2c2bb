#include "engine/core/eye_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/graph_builder.h"
#include "tests/core/random_graph.h"

namespace viscera {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

/// "name: target, target" for each pass, in the order of its ports.
std::vector<std::string> texts(const EyeGraph& eyes) {
    std::vector<std::string> lines;
    for (const GraphPass& pass : eyes.graph.passes) {
        std::string line = pass.name + ":";
        for (const GraphPort& port : pass.ports) {
            line += " " + port.target;
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

EyeGraph expand(const Graph& graph, const std::vector<char>& uses_view) {
    return expand_eyes(graph, uses_view);
}

std::vector<std::string> target_names(const EyeGraph& eyes) {
    std::vector<std::string> names;
    for (const TargetDesc& target : eyes.graph.targets) {
        names.push_back(target.name);
    }
    return names;
}

TEST(EyeGraph, WhatDependsOnTheViewAndWhatReadsItIsThereTwice) {
    Graph graph;
    graph.targets = {target("table"), target("picture"), target("out")};
    graph.passes = {pass("bake", {write("table")}), pass("draw", {read("table"), write("picture")}),
                    pass("blur", {read("picture"), write("out")})};
    graph.outputs = {"out", "table"};
    const EyeGraph eyes = expand(graph, {0, 1, 0});
    EXPECT_TRUE(eyes.faults.empty());
    EXPECT_THAT(texts(eyes),
                ElementsAre("bake: table", "draw.left: table picture.left", "draw.right: table picture.right",
                            "blur.left: picture.left out.left", "blur.right: picture.right out.right"));
    EXPECT_THAT(target_names(eyes),
                ElementsAre("table", "picture.left", "picture.right", "out.left", "out.right"));
    EXPECT_THAT(eyes.graph.outputs, ElementsAre("out.left", "out.right", "table"));
    EXPECT_THAT(eyes.names_of("picture"), ElementsAre("picture.left", "picture.right"));
    EXPECT_THAT(eyes.names_of("table"), ElementsAre("table"));
    EXPECT_EQ(eyes.passes[2].source, 1U);
    EXPECT_EQ(eyes.passes[2].eye, 1);
    EXPECT_EQ(eyes.passes[0].eye, -1);
    EXPECT_TRUE(compile(eyes.graph, 8, 8).faults.empty());
}

TEST(EyeGraph, WhereNothingDependsOnTheViewNothingIsTwice) {
    Graph graph;
    graph.targets = {target("a"), target("b")};
    graph.passes = {pass("one", {write("a")}), pass("two", {read("a"), write("b")})};
    graph.outputs = {"b"};
    const EyeGraph eyes = expand(graph, {0, 0});
    EXPECT_THAT(texts(eyes), ElementsAre("one: a", "two: a b"));
    EXPECT_THAT(eyes.graph.outputs, ElementsAre("b"));
    EXPECT_TRUE(eyes.eyed.empty());
}

TEST(EyeGraph, ANameStaysSharedAboveThePassThatMakesItPerEye) {
    Graph graph;
    graph.targets = {target("x"), target("early"), target("late")};
    graph.passes = {pass("bake", {write("x")}), pass("look", {read("x"), write("early")}),
                    pass("step", {read("x"), write("x")}), pass("show", {read("x"), write("late")})};
    graph.outputs = {"early", "late"};
    const EyeGraph eyes = expand(graph, {0, 0, 1, 0});
    EXPECT_THAT(texts(eyes),
                ElementsAre("bake: x", "look: x early", "step.left: x x.left", "step.right: x x.right",
                            "show.left: x.left late.left", "show.right: x.right late.right"));
    EXPECT_THAT(target_names(eyes),
                ElementsAre("x.left", "x.right", "x", "early", "late.left", "late.right"));
    EXPECT_TRUE(compile(eyes.graph, 8, 8).faults.empty());
}

TEST(EyeGraph, WhatIsModifiedPerEyeIsMadePerEye) {
    Graph graph;
    graph.targets = {target("base"), target("x")};
    graph.passes = {pass("bake", {write("base")}), pass("fill", {read("base"), write("x")}),
                    pass("dot", {modify("x")}), pass("draw", {modify("x")})};
    graph.outputs = {"x"};
    const EyeGraph eyes = expand(graph, {0, 0, 0, 1});
    EXPECT_THAT(texts(eyes), ElementsAre("bake: base", "fill.left: base x.left", "fill.right: base x.right",
                                         "dot.left: x.left", "dot.right: x.right", "draw.left: x.left",
                                         "draw.right: x.right"));
    EXPECT_TRUE(compile(eyes.graph, 8, 8).faults.empty());
}

TEST(EyeGraph, LastFramesContentIsEachEyesOwn) {
    Graph graph;
    graph.targets = {target("trail"), target("out"), target("state"), target("side")};
    graph.passes = {pass("show", {previous("trail"), write("out")}), pass("draw", {write("trail")}),
                    pass("simulate", {previous("state"), write("state")})};
    graph.outputs = {"out", "state"};
    const EyeGraph eyes = expand(graph, {0, 1, 0});
    EXPECT_THAT(texts(eyes),
                ElementsAre("show.left: trail.left out.left", "show.right: trail.right out.right",
                            "draw.left: trail.left", "draw.right: trail.right", "simulate: state state"));
}

TEST(EyeGraph, ADisabledPassIsAsIfNotThere) {
    Graph graph;
    graph.targets = {target("x"), target("out")};
    graph.passes = {pass("fill", {write("x")}), pass("draw", {read("x"), write("x")}),
                    pass("show", {read("x"), write("out")})};
    graph.passes[1].enabled = false;
    graph.outputs = {"out"};
    const EyeGraph eyes = expand(graph, {0, 1, 0});
    EXPECT_THAT(texts(eyes), ElementsAre("fill: x", "draw: x x", "show: x out"));
}

TEST(EyeGraph, APassMayReadBothEyesInSoManyWords) {
    Graph graph;
    graph.targets = {target("x"), target("both")};
    graph.passes = {pass("draw", {write("x")}),
                    pass("join", {read("x.left"), read("x.right"), write("both")})};
    graph.outputs = {"both"};
    const EyeGraph eyes = expand(graph, {1, 0});
    EXPECT_THAT(texts(eyes),
                ElementsAre("draw.left: x.left", "draw.right: x.right", "join: x.left x.right both"));
    EXPECT_TRUE(compile(eyes.graph, 8, 8).faults.empty());
}

TEST(EyeGraph, TheHostBringsPerEyeWhatDiffers) {
    Graph graph;
    graph.targets = {target("out")};
    graph.imported = {{"depth.left", PixelFormat::depth32f, 8, 8, false},
                      {"depth.right", PixelFormat::depth32f, 8, 8, false},
                      {"sky", PixelFormat::rgba8, 8, 8, false}};
    graph.passes = {pass("show", {read("depth"), read("sky"), write("out")})};
    graph.outputs = {"out"};
    const EyeGraph eyes = expand(graph, {0});
    EXPECT_THAT(texts(eyes),
                ElementsAre("show.left: depth.left sky out.left", "show.right: depth.right sky out.right"));
    EXPECT_TRUE(compile(eyes.graph, 8, 8).faults.empty());
}

TEST(EyeGraph, OneImportedTargetCannotTakeBothPictures) {
    Graph graph;
    graph.imported = {{"screen", PixelFormat::rgba8, 8, 8, true}};
    graph.passes = {pass("draw", {modify("screen")})};
    graph.outputs = {"screen"};
    const EyeGraph eyes = expand(graph, {1});
    ASSERT_EQ(eyes.faults.size(), 1U);
    EXPECT_THAT(
        to_string(eyes.faults[0]),
        HasSubstr("pass 'draw.left', port 'screen', target 'screen': both eyes would draw into this"));

    graph.imported = {{"screen.left", PixelFormat::rgba8, 8, 8, true},
                      {"screen.right", PixelFormat::rgba8, 8, 8, true}};
    const EyeGraph apart = expand(graph, {1});
    EXPECT_TRUE(apart.faults.empty());
    EXPECT_THAT(texts(apart), ElementsAre("draw.left: screen.left", "draw.right: screen.right"));
    EXPECT_TRUE(compile(apart.graph, 8, 8).faults.empty());
}

TEST(EyeGraph, ATakenNameIsAFault) {
    Graph graph;
    graph.targets = {target("x"), target("x.left")};
    graph.passes = {pass("draw", {write("x")}), pass("other", {write("x.left")})};
    graph.outputs = {"x", "x.left"};
    const EyeGraph eyes = expand(graph, {1, 0});
    ASSERT_FALSE(eyes.faults.empty());
    EXPECT_THAT(to_string(eyes.faults[0]), HasSubstr("target 'x.left': is the name of another target"));
}

TEST(EyeGraph, RandomGraphsThatCompileDoSoForTwoEyesAndRunNothingInVain) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        Random random(seed);
        const Graph graph = random_graph(random);
        if (!compile(graph, 64, 48).faults.empty()) {
            continue;
        }
        for (const bool any : {false, true}) {
            std::vector<char> uses_view;
            for (std::size_t p = 0; p < graph.passes.size(); ++p) {
                uses_view.push_back(any && (seed + p) % 3 == 0 ? 1 : 0);
            }
            const EyeGraph eyes = expand(graph, uses_view);
            if (!any) {
                EXPECT_EQ(eyes.graph.passes.size(), graph.passes.size());
            }
            if (!eyes.faults.empty()) {
                EXPECT_THAT(eyes.faults[0].message, HasSubstr("imported")) << seed;
                continue;
            }
            const CompileResult result = compile(eyes.graph, 64, 48);
            for (const Fault& fault : result.faults) {
                ADD_FAILURE() << "seed " << seed << ": " << to_string(fault);
            }
        }
    }
}

}  // namespace
}  // namespace viscera
