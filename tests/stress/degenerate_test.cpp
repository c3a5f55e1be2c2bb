#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/io/exr.h"
#include "tests/core/not_finite.h"
#include "tests/stress/stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

using Degenerate = Stage;

json& parameters(json& scene, int pass) {
    return scene["passes"][static_cast<std::size_t>(pass)]["parameters"];
}

TEST_F(Degenerate, TheChainItselfDrawsEverything) {
    const Pictures pictures = render(chain());
    for (const char* name : {"contrast.main", "contrast.cloud", "contrast.distance", "contrast.summary",
                             "contrast.reflux", "contrast.capillary"}) {
        ASSERT_TRUE(pictures.contains(name)) << name;
        EXPECT_GT(largest(pictures.at(name)), 0.1F) << name;
    }
    EXPECT_EQ(renderer().log().faults().size(), 0U) << said();
}

TEST_F(Degenerate, ACloudWithoutRadius) {
    const Pictures whole = render(chain());
    json scene = chain();
    parameters(scene, 0)["cloud"]["radius_mm"] = 0;
    load(scene);
    for (int frame = 0; frame < 3; ++frame) {
        const Pictures pictures = render(1.0);
        expect_same(pictures.at("contrast.main"), whole.at("contrast.main"), "main");
        expect_same(pictures.at("contrast.summary"), pictures.at("contrast.main"), "summary is main");
        EXPECT_EQ(largest(pictures.at("contrast.cloud")), 0.0F);
    }
    expect_said_once("contrast.cloud_radius", "radius_mm is 0");
}

/// A second emitter that gives no smoke must not touch the first.
void add_emitter(json& scene, const json& base, const json& tip, const json& edge) {
    parameters(scene, 2)["emitters"].push_back({{"base_mm", base}, {"tip_mm", tip}, {"edge_mm", edge}});
}

TEST_F(Degenerate, AnEmitterWithoutLength) {
    const Pictures whole = render(chain());
    json scene = chain();
    add_emitter(scene, {1, 1, 5}, {1, 1, 5}, {1, 1, 6});
    load(scene);
    for (int frame = 0; frame < 3; ++frame) {
        expect_same(render(1.0).at("final"), whole.at("final"), "the other emitter's smoke");
    }
    expect_said_once("contrast.emitter_length", "fall on one point");
}

TEST_F(Degenerate, AnEmitterBehindTheCamera) {
    const Pictures whole = render(chain());
    for (const auto& [base, tip, edge] :
         {std::tuple(json{0, -90, 10}, json{0, -95, 10}, json{0, -95, 12}),     // all of it
          std::tuple(json{0, -50, 10}, json{0, -90, 10}, json{0, -90, 12}),     // its tip
          std::tuple(json{0, -60, 10}, json{0, -50, 10}, json{0, -50, 12})}) {  // its base in the eye
        json scene = chain();
        add_emitter(scene, base, tip, edge);
        expect_same(render(scene).at("final"), whole.at("final"), "the other emitter's smoke");
    }
    expect_said_once("contrast.emitter_behind", "behind the camera");
}

TEST_F(Degenerate, EmittersOnTheLineOfSightShowTheFront) {
    json scene = chain();
    parameters(scene, 2)["emitters"] = json::array();
    add_emitter(scene, {0, 0, 10}, {0, -5, 10}, {2, -5, 10});
    EXPECT_GT(largest(render(scene).at("contrast.reflux")), 0.3F);
    parameters(scene, 2)["emitters"] = json::array();
    add_emitter(scene, {0, 0, 10}, {1e-9, -5, 10}, {1e-9, -5, 10});
    EXPECT_EQ(largest(render(scene).at("contrast.reflux")), 0.0F) << "an edge on the tip: no front either";
}

TEST_F(Degenerate, ViewsOfOtherSizesAreRefusedByName) {
    const io::ExrPart part{.name = "smoke", .image = make_image(8, 4, PixelFormat::r16f)};
    io::write_exr(folder() / "small.exr", std::span(&part, 1));
    json scene = chain();
    parameters(scene, 2)["views"] = {{{"angle_deg", 30}, {"image", "smoke.exr"}}, {{"image", "small.exr"}}};
    load(scene);
    for (int frame = 0; frame < 2; ++frame) {
        try {
            (void)render(1.0);
            ADD_FAILURE() << "drawn all the same";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::scene);
            EXPECT_THAT(error.what(), testing::HasSubstr("pass 'reflux', /views/1/image: "));
            EXPECT_THAT(error.what(), testing::HasSubstr("small.exr has 8 x 4 pixels"));
        }
    }
    EXPECT_GT(largest(render(chain()).at("contrast.reflux")), 0.1F) << "goes on";
}

TEST_F(Degenerate, DensityInTheFileIsMended) {
    const auto broken = [](int i) {
        return i == 40   ? nan_float
               : i == 50 ? -3.0F
               : i == 60 ? 7.0F
               : i == 70 ? std::numeric_limits<float>::infinity()
                         : 0.8F;
    };
    write_tube("tube.ply", [&](int i) {
        const float value = broken(i);
        return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F;
    });
    const Pictures mended = render(per_vertex_chain());
    EXPECT_GT(largest(mended.at("contrast.main")), 0.7F);
    write_tube("broken.ply", broken);
    json scene = per_vertex_chain();
    parameters(scene, 0)["vessel"]["mesh"] = "broken.ply";
    load(scene);
    for (int frame = 0; frame < 3; ++frame) {
        expect_same(render(1.0).at("final"), mended.at("final"), "as if the file had been right");
    }
    expect_said_once("mesh: scalars that are not finite set to 0", "2 scalars that are not finite set to 0");
    expect_said_once("contrast.density_range", "outside [0, 1]");
}

TEST_F(Degenerate, DensityOfTheHostIsMended) {
    std::vector<float> values(tube_vertices, 0.6F);
    HostValues host;
    load(per_vertex_chain());
    const auto picture = [&] {
        Frame frame = renderer().still(1.0);
        host.set("density", values);
        frame.values = &host;
        return render(frame).at("final");
    };
    values[7] = 0.0F;
    values[30] = 1.0F;
    const Image mended = picture();
    values[7] = nan_float;
    values[30] = 1e30F;
    expect_same(picture(), mended, "as if the host had been right");
    expect_said_once("contrast.density_nan", "NaN");
    expect_said_once("contrast.density_range", "outside [0, 1]");
    const Image own = render(1.0).at("final");
    values.resize(5);
    expect_same(picture(), own, "an array of another length is not used");
    expect_said_once("contrast.host_density_count", "have 5 entries");
    values.clear();
    expect_same(picture(), own, "nor an empty one");
    values.assign(tube_vertices, nan_float);
    EXPECT_EQ(largest(picture()), 0.75F) << "no density, no contrast";
}

TEST_F(Degenerate, AVesselWithoutTriangles) {
    (void)folder().write("points.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n");
    (void)folder().write("flat.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                         "end_header\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n");
    for (const char* name : {"points.ply", "flat.ply"}) {
        json scene = chain();
        parameters(scene, 0)["vessel"]["mesh"] = name;
        for (const float value : to_floats(render(scene).at("final"))) {
            ASSERT_EQ(value, 0.75F) << "the background and nothing else";
        }
        // Beside another vessel: that one is drawn as if alone.
        scene = chain();
        const Pictures whole = render(scene);
        json empty = scene["passes"][0];
        empty["name"] = "empty";
        empty["effect"] = "contrast.main";
        empty["parameters"]["vessel"]["mesh"] = name;
        empty["targets"] = {{"main", "contrast.other"}};
        scene["passes"].insert(scene["passes"].begin(), empty);
        const Pictures both = render(scene);
        expect_same(both.at("final"), whole.at("final"), "the other vessel");
    }
    EXPECT_TRUE(renderer().log().faults().contains("contrast.no_triangles"));
}

class DegenerateGraph : public Stage {
  protected:
    Pictures flow(const json& nodes, const json& edges, const json& terminals = json::object()) {
        // A file of its own each time, since what was read once is kept.
        const std::string name = "line" + std::to_string(count_++) + ".json";
        (void)folder().write(name, json{{"unit", "mm"}, {"nodes", nodes}, {"edges", edges}}.dump());
        json scene = chain();
        json flow{{"injection_speed_mm_s", 20}};
        flow.update(terminals);
        parameters(scene, 0)["vessel"] = {{"mesh", "tube.ply"}, {"centreline", name}, {"flow", flow}};
        return render(scene);
    }
    int count_ = 0;
};

TEST_F(DegenerateGraph, AnIsolatedNodeChangesNothing) {
    const Pictures whole = flow({{0, 0, 0, 2}, {0, 0, 10, 2}, {0, 0, 20, 2}}, {{0, 1}, {1, 2}});
    EXPECT_GT(largest(whole.at("contrast.main")), 0.5F);
    const Pictures pictures =
        flow({{0, 0, 0, 2}, {0, 0, 10, 2}, {0, 0, 20, 2}, {900, 0, 0, 2}}, {{0, 1}, {1, 2}});
    expect_same(pictures.at("final"), whole.at("final"), "the rest of the graph");
    (void)render(1.5);
    expect_said_once("contrast.unreached_nodes", "reached by no contrast");
}

TEST_F(DegenerateGraph, AZeroRadiusStopsTheFlowThereAndSaysSo) {
    const Pictures pictures = flow({{0, 0, 0, 2}, {0, 0, 10, 2}, {0, 0, 20, 0}}, {{0, 1}, {1, 2}});
    EXPECT_TRUE(renderer().log().faults().contains("contrast.graph_radius")) << said();
    (void)pictures;
    (void)flow({{0, 0, 0, 0}, {0, 0, 10, 0}, {0, 0, 20, 0}}, {{0, 1}, {1, 2}});
}

TEST_F(DegenerateGraph, ACycleFlows) {
    const Pictures pictures =
        flow({{0, 0, 0, 2}, {1, 0, 10, 2}, {-1, 0, 10, 2}, {0, 0, 15, 2}, {0, 0, -5, 2}, {0, 0, 20, 1}},
             {{4, 0}, {0, 1}, {0, 2}, {1, 3}, {2, 3}, {1, 2}, {3, 5}});
    EXPECT_GT(largest(pictures.at("contrast.main")), 0.1F) << said();
    // Nothing but a cycle has neither inlet nor outlet.
    (void)flow({{0, 0, 0, 2}, {1, 0, 10, 2}, {-1, 0, 10, 2}}, {{0, 1}, {1, 2}, {2, 0}});
    EXPECT_FALSE(renderer().log().faults().empty());
}

TEST_F(DegenerateGraph, NoOutletMeansNoFlowAndSaysSo) {
    const json closed{{{"node", 0}, {"pressure_mmhg", 90}}, {{"node", 2}, {"pressure_mmhg", 90}}};
    const Pictures pictures =
        flow({{0, 0, 0, 2}, {0, 0, 10, 2}, {0, 0, 20, 2}}, {{0, 1}, {1, 2}}, {{"inlets", closed}});
    EXPECT_EQ(largest(pictures.at("contrast.main")), 0.0F);
    const auto faults = renderer().log().faults();
    EXPECT_TRUE(faults.contains("contrast.no_outlet") || faults.contains("contrast.no_flow")) << said();
}

/// As where one of them comes in metres, or in RAS and the other in LPS.
TEST_F(DegenerateGraph, ACentrelineOrAnInjectionFarFromTheMeshIsSaid) {
    (void)flow({{0, 0, 0, 2}, {0, 0, 10, 2}, {0, 0, 20, 2}}, {{0, 1}, {1, 2}});
    json near = chain();
    parameters(near, 0)["vessel"]["injection_mm"] = {0, 0, -15};
    (void)render(near);
    EXPECT_TRUE(renderer().log().faults().empty()) << said();
    (void)flow({{60, 0, 0, 2}, {60, 0, 10, 2}, {60, 0, 20, 2}}, {{0, 1}, {1, 2}});
    EXPECT_THAT(said(),
                testing::HasSubstr("line1.json: most of the vessel's vertices are more than three radii"));
    json far = chain();
    parameters(far, 0)["vessel"]["injection_mm"] = {0, 0, -60};
    (void)render(far);
    EXPECT_THAT(said(), testing::HasSubstr("tube.ply: injection_mm lies 60 mm away"));
}

TEST_F(DegenerateGraph, OddGraphsStayFinite) {
    const json one{{0, 0, 0, 2}};
    const json two{{0, 0, 0, 2}, {0, 0, 0, 2}};
    (void)flow(one, json::array());
    (void)flow(two, {{0, 1}});
    (void)flow({{0, 0, 0, 2}, {0, 0, 10, 2}}, {{0, 0}, {0, 1}, {1, 0}, {0, 1}});
    (void)flow({{0, 0, 0, 1e-30}, {0, 0, 10, 1e30}, {0, 0, 20, 2}}, {{0, 1}, {1, 2}});
    (void)flow({{1e30, 0, 0, 2}, {-1e30, 0, 10, 2}}, {{0, 1}});
    (void)flow({{0, 0, 0, 2}, {0, 0, 1e-12, 2}, {0, 0, 20, 2}}, {{0, 1}, {1, 2}});
}

TEST_F(Degenerate, TheCameraInsideTheVessel) {
    for (const json& eye : {json{0, 0, 10}, json{0.1, 0.05, 2}, json{2, 0, 4}}) {
        json scene = chain();
        scene["camera"]["eye_mm"] = eye;
        scene["camera"]["target_mm"] = {0, 0.1, 20};
        scene["camera"]["up"] = {1, 0, 0};
        scene["camera"]["near_mm"] = 0.01;
        const Pictures pictures = render(scene);
        EXPECT_GT(largest(pictures.at("contrast.main")), 0.1F) << eye;
    }
}

TEST_F(Degenerate, TargetsOfAnyShape) {
    load(chain());
    for (const auto& [width, height] :
         {std::pair(1, 1), std::pair(1, 7), std::pair(300, 1), std::pair(2, 2), std::pair(37, 91),
          std::pair(16384, 1), std::pair(1, 16384), std::pair(64, 48)}) {
        Frame frame = renderer().still(1.0);
        frame.width = width;
        frame.height = height;
        frame.eyes[0] = make_view(renderer().scene().camera, frame.aspect(), 1.0);
        const Pictures pictures = render(frame);
        EXPECT_EQ(pictures.at("final").width, width);
        EXPECT_EQ(pictures.at("final").height, height);
    }
    // A blur of 5 % of 16384 pixels is all that there is to say of these sizes.
    EXPECT_THAT(renderer().log().faults(), testing::ElementsAre(testing::Key("filter.gaussian_sigma")))
        << said();
}

TEST_F(Degenerate, AStripAsWideAsTheDevice) {
    load(chain());
    Frame frame = renderer().still(1.0);
    frame.width = 16384;
    frame.height = 64;
    EXPECT_GT(largest(render(frame).at("contrast.main")), 0.1F);
}

}  // namespace
}  // namespace viscera::test
