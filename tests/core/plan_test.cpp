#include "engine/core/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "engine/core/error.h"
#include "tests/core/graph_builder.h"
#include "tests/core/not_finite.h"
#include "tests/core/random_graph.h"

namespace viscera {
namespace {

using namespace test;
using testing::HasSubstr;

std::vector<std::string> fault_texts(const Graph& graph, int width = 64, int height = 48) {
    std::vector<std::string> texts;
    for (const Fault& fault : compile(graph, width, height, 1000).faults) {
        texts.push_back(to_string(fault));
    }
    return texts;
}

void expect_only_fault(const Graph& graph, const std::string& text) {
    EXPECT_THAT(fault_texts(graph), testing::ElementsAre(text));
}

/// base -> blur -> out
Graph two_steps() {
    Graph graph;
    graph.targets = {target("base"), target("blur"), target("out")};
    graph.passes = {pass("draw", {write("base")}), pass("blur", {read("base"), write("blur")}),
                    pass("show", {read("blur"), write("out")})};
    graph.outputs = {"out"};
    return graph;
}

const PlanContent& content_of(const Plan& plan, std::size_t pass, std::size_t port) {
    return plan.contents.at(plan.passes.at(pass).bindings.at(port).content.value());
}

TEST(Compile, ChainBindsCullsAndShares) {
    Graph graph = two_steps();
    graph.targets.push_back(target("unused"));
    graph.passes.push_back(pass("aside", {read("base"), write("unused")}));
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_EQ(plan.passes[0].reason, "read by 'blur'");
    EXPECT_EQ(plan.passes[1].reason, "read by 'show'");
    EXPECT_EQ(plan.passes[2].reason, "writes output 'out'");
    EXPECT_EQ(plan.passes[3].reason, "culled: no output needs it");
    EXPECT_FALSE(plan.passes[3].live);
    EXPECT_EQ(plan.textures.size(), 2U);
    EXPECT_EQ(content_of(plan, 0, 0).texture, content_of(plan, 2, 1).texture);
    EXPECT_EQ(content_of(plan, 0, 0).last_pass, 1U) << "a culled reader keeps nothing alive";
    EXPECT_EQ(content_of(plan, 2, 1).last_pass, 4U);
    EXPECT_EQ(content_of(plan, 3, 1).texture, std::nullopt);
    EXPECT_EQ(plan.contents[plan.outputs.at(0).content].target, "out");
}

TEST(Compile, ReadMeansTheNearestWriteAbove) {
    Graph graph = two_steps();
    graph.passes.insert(graph.passes.begin() + 1, pass("again", {write("base")}));
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_EQ(content_of(plan, 2, 0).writer, 1U);
    EXPECT_FALSE(plan.passes[0].live) << "its content is written over unseen";
}

TEST(Compile, DisabledPassIsAsIfNotThere) {
    Graph graph = two_steps();
    graph.passes.insert(graph.passes.begin() + 1, pass("again", {write("base")}));
    graph.passes[1].enabled = false;
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_EQ(content_of(plan, 2, 0).writer, 0U);
    EXPECT_EQ(plan.passes[1].reason, "disabled");
    EXPECT_FALSE(plan.passes[1].bindings[0].content);

    graph.passes[0].enabled = false;
    expect_only_fault(graph,
                      "pass 'blur', port 'base', target 'base': is written only by disabled pass 'draw'");
}

TEST(Compile, PingPongReadsOneTextureAndWritesAnother) {
    Graph graph = two_steps();
    graph.passes.insert(graph.passes.begin() + 1, pass("step", {write("base"), read("base")}));
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_EQ(content_of(plan, 1, 1).writer, 0U);
    EXPECT_EQ(content_of(plan, 2, 0).writer, 1U);
    EXPECT_NE(content_of(plan, 1, 0).texture, content_of(plan, 1, 1).texture);
}

TEST(Compile, ModifyContinuesInTheSameTexture) {
    Graph graph = two_steps();
    graph.passes.insert(graph.passes.begin() + 1, pass("blend", {modify("base")}));
    const Plan plan = compile_or_throw(graph, 64, 48);
    const PlanContent& blended = content_of(plan, 1, 0);
    ASSERT_TRUE(blended.modifies);
    EXPECT_EQ(plan.contents[*blended.modifies].writer, 0U);
    EXPECT_EQ(plan.contents[*blended.modifies].texture, blended.texture);
    EXPECT_EQ(plan.passes[0].reason, "modified by 'blend'");
    EXPECT_EQ(content_of(plan, 2, 0).writer, 1U);
}

TEST(Compile, UnreadWriteOfALivePassHasNoAttachmentButDepthHas) {
    Graph graph = two_steps();
    graph.targets.push_back(target("spare"));
    graph.targets.push_back(target("depth", PixelFormat::depth32f));
    graph.passes[0].ports.push_back(write("spare"));
    graph.passes[0].ports.push_back(write("depth"));
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_FALSE(plan.passes[0].bindings[1].content);
    EXPECT_TRUE(content_of(plan, 0, 2).texture);
}

TEST(Compile, HistoryKeepsTheLastWriterAliveInTexturesOfItsOwn) {
    Graph graph;
    graph.targets = {target("state"), target("out"), target("temp")};
    graph.passes = {pass("show", {previous("state"), write("out")}), pass("prepare", {write("temp")}),
                    pass("simulate", {read("temp"), write("state")}), pass("finish", {modify("state")})};
    graph.outputs = {"out"};
    const Plan plan = compile_or_throw(graph, 64, 48);
    ASSERT_EQ(plan.history.size(), 1U);
    const PlanContent& before = plan.contents[plan.history[0].previous];
    const PlanContent& after = plan.contents[plan.history[0].current.value()];
    EXPECT_FALSE(before.writer);
    EXPECT_EQ(after.writer, 3U);
    EXPECT_EQ(plan.passes[3].reason, "read by 'show' in the next frame");
    EXPECT_TRUE(plan.passes[1].live);
    EXPECT_EQ(before.first_pass, 0U);
    EXPECT_EQ(before.last_pass, 4U);
    EXPECT_EQ(after.last_pass, 4U);
    EXPECT_NE(before.texture, after.texture);
    EXPECT_EQ(plan.textures.size(), 4U) << "'temp' is free when 'state' starts, but 'state' stays";

    graph.passes[0].ports[0].access = Access::write;  // nobody asks for the last frame now
    graph.passes[0].ports.erase(graph.passes[0].ports.begin());
    EXPECT_TRUE(compile_or_throw(graph, 64, 48).history.empty());
    EXPECT_FALSE(compile_or_throw(graph, 64, 48).passes[3].live);
}

TEST(Compile, PassthroughKeepsItsSourceAsLongAsTheResult) {
    Graph graph = two_steps();
    graph.targets.push_back(target("late"));
    graph.passes[1].ports[1].passthrough = "base";
    graph.passes.insert(graph.passes.begin() + 2, pass("other", {write("late")}));
    graph.passes.push_back(pass("mix", {read("late"), read("out"), read("blur"), write("base")}));
    graph.outputs = {"base"};
    const Plan plan = compile_or_throw(graph, 64, 48);
    const PlanContent& source = content_of(plan, 0, 0);
    EXPECT_EQ(source.last_pass, 4U);
    EXPECT_EQ(content_of(plan, 1, 1).passthrough, plan.passes[1].bindings[0].content);
    EXPECT_NE(content_of(plan, 2, 0).texture, source.texture);
}

TEST(Compile, OptionalReadsOfNothingAreEmpty) {
    Graph graph = two_steps();
    graph.passes[2].ports.push_back(read_if_any("nothing"));
    GraphPort last = previous("never");
    last.optional = true;
    graph.passes[2].ports.push_back(last);
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_FALSE(plan.passes[2].bindings[2].content);
    EXPECT_FALSE(plan.passes[2].bindings[3].content);
    EXPECT_TRUE(plan.history.empty());
}

TEST(Compile, ImportedTargetsHaveTheHostsTexture) {
    Graph graph = two_steps();
    graph.imported = {{"host.colour", PixelFormat::rgba8, 320, 200, true}};
    graph.passes[0].ports.push_back(read("host.colour"));
    graph.passes.push_back(pass("present", {read("out"), write("host.colour")}));
    graph.outputs = {"host.colour"};
    const Plan plan = compile_or_throw(graph, 64, 48);
    EXPECT_EQ(content_of(plan, 0, 1).imported, 0U);
    EXPECT_FALSE(content_of(plan, 0, 1).writer);
    EXPECT_EQ(content_of(plan, 3, 1).imported, 0U);
    EXPECT_FALSE(content_of(plan, 3, 1).texture);
    EXPECT_EQ(content_of(plan, 3, 1).width, 320);
}

TEST(Compile, SizesFollowTheFrameOrAreAbsolute) {
    Graph graph = two_steps();
    graph.targets[0].size = {0.5, 0, 0};
    graph.targets[1].size = {1.0, 7, 9};
    graph.targets[2].size = {0.001, 0, 0};
    const Plan plan = compile_or_throw(graph, 101, 48);
    EXPECT_EQ(content_of(plan, 0, 0).width, 51);
    EXPECT_EQ(content_of(plan, 0, 0).height, 24);
    EXPECT_EQ(content_of(plan, 1, 1).width, 7);
    EXPECT_EQ(content_of(plan, 1, 1).height, 9);
    EXPECT_EQ(content_of(plan, 2, 1).width, 1);
    EXPECT_EQ(plan.textures.size(), 3U) << "sizes differ";
}

struct Broken {
    const char* text;
    void (*spoil)(Graph&);
};

class CompileFaults : public testing::TestWithParam<Broken> {};

TEST(Compile, OptionalWritesThatNobodyWantsMayHaveAnySize) {
    Graph graph = two_steps();
    graph.targets.push_back({.name = "rest", .size = {.scale = 0.5}});
    graph.passes[1].ports.push_back(
        {.port = "blur.rest", .target = "rest", .access = Access::write, .optional = true});
    EXPECT_THAT(fault_texts(graph), testing::IsEmpty());
    graph.outputs.emplace_back("rest");
    expect_only_fault(graph,
                      "pass 'blur', port 'blur.rest', target 'rest': differs in size from 'blur', which the "
                      "pass draws into as well");
}

TEST(Compile, ADepthThatServesItsOwnPassAloneHasThePassesSize) {
    Graph graph = two_steps();
    graph.targets.push_back({.name = "depth", .format = PixelFormat::depth32f, .size = {.scale = 0.5}});
    graph.passes[1].ports.push_back(
        {.port = "blur.depth", .target = "depth", .access = Access::write, .optional = true});
    expect_only_fault(
        graph,
        "pass 'blur', port 'blur.depth', target 'depth': differs in size from 'blur', which the "
        "pass draws into as well");
}

TEST_P(CompileFaults, AreNamedAndAlone) {
    Graph graph = two_steps();
    ASSERT_TRUE(fault_texts(graph).empty());
    GetParam().spoil(graph);
    expect_only_fault(graph, GetParam().text);
}

const Broken broken[] = {
    {"pass 'show', port 'lost', target 'lost': no pass writes it",
     [](Graph& g) { g.passes[2].ports.push_back(read("lost")); }},
    {"pass 'draw', port 'out', target 'out': no pass above writes it; the first to do so is 'show'",
     [](Graph& g) { g.passes[0].ports.push_back(read("out")); }},
    {"pass 'show', port 'lost', target 'lost': no pass writes it",
     [](Graph& g) { g.passes[2].ports.push_back(modify("lost")); }},
    {"pass 'show', port 'lost.last', target 'lost': no pass writes it",
     [](Graph& g) { g.passes[2].ports.push_back(previous("lost")); }},
    {"pass 'blur', port 'x', target 'base': is read and modified in one pass",
     [](Graph& g) {
         g.passes[1].ports.push_back({"x", "base", Access::modify, false, ""});
     }},
    {"pass 'blur', port 'x', target 'blur': is written twice in one pass",
     [](Graph& g) {
         g.passes[1].ports.push_back({"x", "blur", Access::write, false, ""});
     }},
    {"pass 'draw': another pass above has this name", [](Graph& g) { g.passes[2].name = "draw"; }},
    {"pass 'blur', port 'base', target 'base': the pass has two ports of this name",
     [](Graph& g) { g.passes[1].ports.push_back(read("base")); }},
    {"target 'blur': is described twice", [](Graph& g) { g.targets.push_back(target("blur")); }},
    {"pass 'blur', port 'blur.new', target 'blur': the target is written but not described",
     [](Graph& g) { g.targets.erase(g.targets.begin() + 1); }},
    {"target 'base': is imported and described too",
     [](Graph& g) {
         g.imported = {{"base", PixelFormat::rgba16f, 8, 8, true}};
     }},
    {"target 'host': is imported twice",
     [](Graph& g) {
         g.imported = {{"host", PixelFormat::r8, 8, 8, true}, {"host", PixelFormat::r8, 8, 8, true}};
     }},
    {"target 'host': an imported target must be at least 1x1 pixels",
     [](Graph& g) {
         g.imported = {{"host", PixelFormat::r8, 0, 8, true}};
     }},
    {"pass 'show', port 'host.new', target 'host': the imported target is not writable",
     [](Graph& g) {
         g.imported = {{"host", PixelFormat::r8, 64, 48, false}};
         g.passes[2].ports.push_back(write("host"));
     }},
    {"pass 'show', port 'host.new', target 'host': an imported target cannot be read and written in one pass",
     [](Graph& g) {
         g.imported = {{"host", PixelFormat::r8, 64, 48, true}};
         g.passes[2].ports.push_back(read("host"));
         g.passes[2].ports.push_back(write("host"));
     }},
    {"pass 'show', port 'host.last', target 'host': an imported target has no last frame",
     [](Graph& g) {
         g.imported = {{"host", PixelFormat::r8, 8, 8, true}};
         g.passes[2].ports.push_back(previous("host"));
     }},
    {"target 'lost': output: no pass writes it", [](Graph& g) { g.outputs.push_back("lost"); }},
    {"target 'lost': output: is written only by disabled pass 'off'",
     [](Graph& g) {
         g.outputs.push_back("lost");
         g.passes.push_back(pass("off", {write("lost")}));
         g.passes.back().enabled = false;
     }},
    {"target 'out': is listed twice as output", [](Graph& g) { g.outputs.push_back("out"); }},
    {"target 'Base': is not a valid target name", [](Graph& g) { g.targets.push_back(target("Base")); }},
    {"target 'a..b': is not a valid target name", [](Graph& g) { g.targets.push_back(target("a..b")); }},
    {"target 'a.': is not a valid target name", [](Graph& g) { g.targets.push_back(target("a.")); }},
    {"target '.a': is not a valid target name", [](Graph& g) { g.targets.push_back(target(".a")); }},
    {"target '../a': is not a valid target name", [](Graph& g) { g.targets.push_back(target("../a")); }},
    {"is not a valid target name", [](Graph& g) { g.targets.push_back(target("")); }},
    {"pass 'show', port 'A B', target 'A B': is not a valid target name",
     [](Graph& g) { g.passes[2].ports.push_back(read_if_any("A B")); }},
    {"target 'base': the scale of a size must lie in (0, 4]",
     [](Graph& g) { g.targets[0].size.scale = 0.0; }},
    {"target 'base': the scale of a size must lie in (0, 4]",
     [](Graph& g) { g.targets[0].size.scale = 4.1; }},
    {"target 'base': the scale of a size must lie in (0, 4]",
     [](Graph& g) { g.targets[0].size.scale = infinity; }},
    {"target 'base': the scale of a size must lie in (0, 4]",
     [](Graph& g) { g.targets[0].size.scale = infinity - infinity; }},
    {"target 'base': an absolute size needs width and height of at least 1",
     [](Graph& g) { g.targets[0].size.width = 8; }},
    {"target 'base': an absolute size needs width and height of at least 1",
     [](Graph& g) {
         g.targets[0].size = {1.0, 8, -8};
     }},
    {"target 'base': size 2147483647x8 is beyond the device's limit of 1000",
     [](Graph& g) {
         g.targets[0].size = {1.0, 2'000'000'000, 8, 2};
     }},
    {"target 'base': size 1001x8 is beyond the device's limit of 1000",
     [](Graph& g) {
         g.targets[0].size = {1.0, 1001, 8};
     }},
    {"target 'base': the clear value must be finite",
     [](Graph& g) { g.targets[0].clear[2] = std::numeric_limits<float>::quiet_NaN(); }},
    {"pass 'blur', port 'blur.new', target 'blur': passthrough 'nothing' is not a port that this pass reads",
     [](Graph& g) { g.passes[1].ports[1].passthrough = "nothing"; }},
    {"pass 'blur', port 'blur.new', target 'blur': passthrough 'blur.new' is not a port that this pass reads",
     [](Graph& g) { g.passes[1].ports[1].passthrough = "blur.new"; }},
    {"pass 'blur', port 'base', target 'base': only a write can have a passthrough",
     [](Graph& g) { g.passes[1].ports[0].passthrough = "base"; }},
    {"pass 'blur', port 'blur.new', target 'blur': passthrough 'base' differs from the target in format or "
     "size",
     [](Graph& g) {
         g.passes[1].ports[1].passthrough = "base";
         g.targets[0].format = PixelFormat::rgba8;
     }},
    {"pass 'blur', port 'blur.new', target 'blur': passthrough 'base' differs from the target in format or "
     "size",
     [](Graph& g) {
         g.passes[1].ports[1].passthrough = "base";
         g.targets[1].size.scale = 0.5;
     }},
    {"pass 'blur', port 'blur.rest', target 'rest': differs in size from 'blur', which the pass draws into "
     "as well",
     [](Graph& g) {
         g.targets.push_back({.name = "rest", .size = {.scale = 0.5}});
         g.passes[1].ports.push_back({.port = "blur.rest", .target = "rest", .access = Access::write});
     }},
    {"pass 'blend', port 'blur', target 'blur': what is written over may be a passthrough of 'base'",
     [](Graph& g) {
         g.passes[1].ports[1].passthrough = "base";
         g.passes.push_back(pass("blend", {modify("blur")}));
     }},
    {"pass 'blend', port 'base', target 'base': what is written over may stand in for 'blur' by passthrough",
     [](Graph& g) {
         g.passes[1].ports[1].passthrough = "base";
         g.passes.push_back(pass("blend", {modify("base")}));
     }},
};
INSTANTIATE_TEST_SUITE_P(Each, CompileFaults, testing::ValuesIn(broken));

TEST(Compile, ReportsEveryFaultAtOnceInTheOrderOfThePasses) {
    Graph graph = two_steps();
    graph.targets.push_back(target("Bad"));
    graph.passes[2].ports.push_back(read("x"));
    graph.passes[0].ports.push_back(read("y"));
    graph.outputs.push_back("z");
    const auto texts = fault_texts(graph, 0, 48);
    ASSERT_EQ(texts.size(), 5U);
    EXPECT_EQ(texts[0], "the frame must be at least 1x1 pixels, not 0x48");
    EXPECT_THAT(texts[1], HasSubstr("'Bad'"));
    EXPECT_THAT(texts[2], HasSubstr("'y'"));
    EXPECT_THAT(texts[3], HasSubstr("'x'"));
    EXPECT_THAT(texts[4], HasSubstr("'z'"));
    try {
        (void)compile_or_throw(graph, 64, 48);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::scene);
        EXPECT_EQ(std::ranges::count(std::string(error.what()), '\n'), 3);
    }
}

TEST(Compile, FaultyGraphsNeverCrash) {
    Random random(77);
    for (int i = 0; i < 2000; ++i) {
        Graph graph = random_graph(random);
        for (GraphPass& p : graph.passes) {
            for (GraphPort& port : p.ports) {
                port.optional = chance(random, 50);
                port.passthrough = chance(random, 20) ? "port0" : "";
                port.target = chance(random, 10) ? "Nonsense/" : port.target;
            }
        }
        graph.targets.resize(pick(random, 6));
        for (const Fault& fault : compile(graph, 64, 64).faults) {
            EXPECT_FALSE(fault.message.empty());
        }
    }
}

bool makes(Access access) {
    return access == Access::write || access == Access::modify;
}

/// Content that a name means to a read in pass `p`, by looking upwards; none when nothing writes it.
std::optional<std::size_t> writer_above(const Graph& graph, std::size_t p, const std::string& name) {
    while (p-- > 0) {
        for (const GraphPort& port : graph.passes[p].ports) {
            // An optional modify without anything below it makes nothing.
            const bool counts =
                port.access == Access::write ||
                (port.access == Access::modify && (writer_above(graph, p, name) || name == "host"));
            if (graph.passes[p].enabled && port.target == name && counts) {
                return p;
            }
        }
    }
    return std::nullopt;
}

std::set<std::size_t> live_passes(const Graph& graph) {
    std::set<std::size_t> live;
    const std::size_t end = graph.passes.size();
    for (const std::string& output : graph.outputs) {
        live.insert(writer_above(graph, end, output).value());
    }
    for (std::size_t before = live.size() + 1; before != live.size();) {
        before = live.size();
        for (const std::size_t p : std::set(live)) {
            for (const GraphPort& port : graph.passes[p].ports) {
                const bool last = port.access == Access::previous;
                if (port.access != Access::write) {
                    if (const auto writer = writer_above(graph, last ? end : p, port.target)) {
                        live.insert(*writer);
                    }
                }
            }
        }
    }
    return live;
}

std::size_t root_of(const Plan& plan, std::size_t content) {
    while (plan.contents[content].modifies) {
        content = *plan.contents[content].modifies;
    }
    return content;
}

void check_bindings(const Graph& graph, const Plan& plan) {
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        for (std::size_t i = 0; plan.passes[p].live && i < plan.passes[p].bindings.size(); ++i) {
            const GraphPort& port = graph.passes[p].ports[i];
            const auto content = plan.passes[p].bindings[i].content;
            if (port.access == Access::read) {
                const auto writer = writer_above(graph, p, port.target);
                EXPECT_EQ(content && plan.contents[*content].writer, writer.has_value());
                EXPECT_TRUE(!writer || plan.contents[content.value()].writer == writer);
            }
            if (content) {
                const PlanContent& c = plan.contents[*content];
                EXPECT_EQ(c.target, port.target);
                EXPECT_NE(c.texture.has_value(), c.imported.has_value());
                EXPECT_LE(c.first_pass, makes(port.access) ? p : c.last_pass);
                EXPECT_GE(c.last_pass, p);
            }
        }
    }
}

void check_textures(const Plan& plan) {
    std::set<std::size_t> exclusive;
    for (const PlanHistory& history : plan.history) {
        exclusive.insert(root_of(plan, history.previous));
        exclusive.insert(root_of(plan, history.current.value()));
    }
    for (std::size_t a = 0; a < plan.contents.size(); ++a) {
        const PlanContent& x = plan.contents[a];
        if (!x.texture) {
            continue;
        }
        EXPECT_EQ(x.format, plan.textures[*x.texture].format);
        EXPECT_EQ(x.width, plan.textures[*x.texture].width);
        for (std::size_t b = a + 1; b < plan.contents.size(); ++b) {
            const PlanContent& y = plan.contents[b];
            if (root_of(plan, a) == root_of(plan, b)) {
                EXPECT_TRUE(!y.texture || x.texture == y.texture);
            } else if (x.texture == y.texture) {
                EXPECT_TRUE(x.last_pass < y.first_pass || y.last_pass < x.first_pass);
                EXPECT_FALSE(exclusive.contains(root_of(plan, a)) || exclusive.contains(root_of(plan, b)));
            }
        }
    }
}

/// The fewest textures of a format: as many as must exist at once, and those that nobody may share.
void check_count(const Plan& plan, PixelFormat format) {
    std::set<std::size_t> kept;
    for (const PlanHistory& history : plan.history) {
        for (const std::size_t content : {history.previous, history.current.value()}) {
            if (plan.contents[content].format == format) {
                kept.insert(root_of(plan, content));
            }
        }
    }
    std::size_t most = 0;
    for (std::size_t p = 0; p <= plan.passes.size(); ++p) {
        std::set<std::size_t> at_once;
        for (std::size_t c = 0; c < plan.contents.size(); ++c) {
            const PlanContent& content = plan.contents[c];
            if (content.texture && content.format == format && content.first_pass <= p &&
                p <= content.last_pass && !kept.contains(root_of(plan, c))) {
                at_once.insert(root_of(plan, c));
            }
        }
        most = std::max(most, at_once.size());
    }
    const auto count = std::ranges::count(plan.textures, format, &PlanTexture::format);
    EXPECT_EQ(static_cast<std::size_t>(count), most + kept.size());
}

TEST(Compile, RandomGraphsAgreeWithANaiveReading) {
    Random random(4711);
    std::size_t valid = 0;
    std::size_t culled = 0;
    while (valid < 3000 && !HasFailure()) {
        const Graph graph = random_graph(random);
        const CompileResult result = compile(graph, 64, 64);
        if (!result.faults.empty()) {
            continue;
        }
        ++valid;
        const std::set<std::size_t> live = live_passes(graph);
        for (std::size_t p = 0; p < graph.passes.size(); ++p) {
            EXPECT_EQ(result.plan.passes[p].live, live.contains(p)) << "pass " << p;
            EXPECT_FALSE(result.plan.passes[p].reason.empty());
        }
        culled += graph.passes.size() - live.size();
        check_bindings(graph, result.plan);
        check_textures(result.plan);
        for (const PixelFormat format : {PixelFormat::rgba16f, PixelFormat::r8, PixelFormat::depth32f}) {
            check_count(result.plan, format);
        }
    }
    EXPECT_GT(culled, 100U);
}

}  // namespace
}  // namespace viscera
