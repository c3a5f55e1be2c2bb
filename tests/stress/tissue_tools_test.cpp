#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "effects/tissue/energy_queries.h"
#include "tests/core/not_finite.h"
#include "tests/stress/stage.h"
#include "tests/tissue/plane.h"

// Bipolar tools, contacts and queries on surfaces and with numbers that are none: finite, and said.
namespace viscera::test {
namespace {

using nlohmann::json;
using tissue::EnergyQueries;

class TissueTools : public Stage {
  protected:
    static json passes(const json& mesh) {
        return {{{"name", "bake"}, {"effect", "tissue.bake"}, {"parameters", {{"mesh", mesh}, {"size", 64}}}},
                {{"name", "coagulate"},
                 {"effect", "tissue.coagulate"},
                 {"parameters", {{"mesh", mesh}, {"size", 64}}}},
                {{"name", "bipolar"},
                 {"effect", "tissue.coagulate_bipolar"},
                 {"parameters", {{"mesh", mesh}, {"size", 64}, {"max_uv_perimeter", 10}}}}};
    }
    void load_mesh(json mesh) {
        load({{"version", 1},
              {"resolution", {16, 16}},
              {"passes", passes(mesh)},
              {"outputs", {"tissue.energy", "tissue.position", "tissue.metric"}}});
        time_s_ = 0.0;
        hold({}, {});
    }
    /// A frame 0.25 s later, with what the tool holds and where it is.
    Image hold(const std::vector<float>& held, const std::vector<float>& tool,
               const std::vector<float>& contacts = {}) {
        values_.set("tissue.held", held);
        values_.set("tissue.tool", tool);
        values_.set("tissue.contacts", contacts);
        Frame frame = renderer().still(time_s_ += 0.25);
        frame.values = &values_;
        pictures_ = render(frame);
        return pictures_.at("tissue.energy");
    }
    /// The tool's frame, scaled, at a place.
    static std::vector<float> tool_at(float x, float y, float z, float scale = 1.0F) {
        return {scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, x, y, z, 1};
    }
    static int burnt(const Image& energy) {
        int count = 0;
        for (int i = 0; i < energy.width * energy.height; ++i) {
            count += energy.at(i % energy.width, i / energy.width, 0) > 0.0F ? 1 : 0;
        }
        return count;
    }

    HostValues values_;
    Pictures pictures_;
    double time_s_ = 0.0;
};

TEST_F(TissueTools, VerticesThatAreNone) {
    load_mesh({{"file", Plane().write("stress").string()}});
    const std::vector<float> place = tool_at(20, 20, 0);
    EXPECT_EQ(burnt(hold({nan_float, infinity_float, -infinity_float, -1.0F, 0.5F, 1e9F, 3e38F}, place)), 0);
    expect_said_once("tissue.held", "are left out");
    std::vector<float> many;
    for (int i = 0; i < 10000; ++i) {
        many.push_back(static_cast<float>(i % 289));
    }
    EXPECT_GT(burnt(hold(many, place)), 10) << "each of them, many times";
}

TEST_F(TissueTools, PosesAndSizesOfAnyKind) {
    load_mesh({{"file", Plane().write("stress").string()}});
    const std::vector<float> held{144, 145};
    for (const std::vector<float>& tool :
         {tool_at(nan_float, 20, 0), tool_at(20, infinity_float, 0), tool_at(20, 20, 0, 0.0F),
          std::vector<float>(16, 0.0F), std::vector<float>(16, nan_float)}) {
        EXPECT_EQ(burnt(hold(held, tool)), 0);
    }
    expect_said_once("tissue.tool_pose", "not finite or has no inverse");
    EXPECT_EQ(burnt(hold(held, {1, 2, 3})), 0);
    expect_said_once("tissue.tool", "16 numbers");
    for (const float scale : {1e-12F, 1e-3F, 1e3F, 1e12F}) {
        (void)hold(held, tool_at(20, 20, 0, scale));
    }
    EXPECT_GT(burnt(hold(held, tool_at(20, 20, 0))), 10) << "all that is held lies within it";
    for (const char* shape : {"capsule", "box", "sphere", "cylinder"}) {
        json scene{{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.energy"}}};
        scene["passes"] = passes({{"file", Plane().write("stress").string()}});
        scene["passes"][2]["parameters"]["tool"] = {{"shape", shape}, {"size_mm", {0, 0, 0}}};
        load(scene);
        time_s_ = 0.0;
        EXPECT_EQ(burnt(hold(held, tool_at(20, 20, 0))), 0) << shape << " of no size";
    }
}

TEST_F(TissueTools, OrgansOfAnySize) {
    for (const double scale : {1e-3, 1e4}) {
        load_mesh({{"file", Plane().write("stress").string()}, {"mm_per_unit", scale}});
        const auto at = static_cast<float>(20.0 * scale);
        EXPECT_GT(burnt(hold({144}, tool_at(at, at, 0, static_cast<float>(scale)))), 10) << scale;
    }
}

// Two squares: whatever is odd about them, contacts and the tool burn them, and nothing else happens.
TEST_F(TissueTools, SurfacesOfEveryFault) {
    const std::string square = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\n";
    const std::string uv = "vt .1 .1\nvt .4 .1\nvt .4 .4\nvt .1 .4\n";
    struct Case {
        const char* name;
        std::string obj;
        const char* atlas;
    };
    const std::array cases{
        Case{"mirrored", square + "vt .4 .1\nvt .1 .1\nvt .1 .4\nvt .4 .4\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n",
             "file"},
        Case{"overlapping", square + uv + "f 1/1 2/2 3/3\nf 1/1 3/2 4/3\n", "file"},
        Case{"no_coordinates", square + "f 1 2 3\nf 1 3 4\n", "automatic"},
        Case{"flat_in_the_texture", square + uv + "vt .25 .25\nf 1/1 2/2 3/3\nf 1/1 3/3 4/5\n", "file"},
        Case{"flat_in_space", square + uv + "v 5 0 0\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 1/1 5/2 2/3\n", "file"},
        Case{"fins",
             square + "v 0 0 9\nv 0 0 -9\n" + uv +
                 "vt .6 .1\nvt .9 .1\nvt .9 .4\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
                 "f 1/5 3/6 5/7\nf 1/5 3/7 6/6\n",
             "automatic"}};
    for (const Case& it : cases) {
        const auto file = folder().write(std::string(it.name) + ".obj", it.obj);
        load_mesh({{"file", file.string()}, {"atlas", it.atlas}});
        EXPECT_GT(burnt(hold({}, {}, {5, 5, 0, 2, 3, 0})), 5) << it.name << ", contact";
        EXPECT_GE(largest(hold({0, 1, 2, 3}, tool_at(5, 5, 0))), 0.5F) << it.name << ", tool";
        EnergyQueries queries;
        queries.take_surface(pictures_.at("tissue.position"), pictures_.at("tissue.metric"));
        queries.take_energy(pictures_.at("tissue.energy"));
        const double area = queries.coagulated_area(1e-6);
        EXPECT_TRUE(std::isfinite(area) && area > 0.0 && area <= 400.0) << it.name << ": " << area;
        EXPECT_TRUE(queries.energy_at(glm::dvec3(5, 5, 0), 3.0).has_value()) << it.name;
    }
}

TEST_F(TissueTools, QuestionsThatAreNone) {
    EnergyQueries queries;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(queries.energy_at(glm::dvec2(0.5)).has_value()) << "nothing is known yet";
    EXPECT_FALSE(queries.energy_at(glm::dvec3(0.0), 1e9).has_value());
    EXPECT_EQ(queries.coagulated_area(0.5), 0.0);
    load_mesh({{"file", Plane().write("stress").string()}});
    (void)hold({}, {}, {20, 20, 0, 2, 5, 0});
    queries.take_surface(pictures_.at("tissue.position"), pictures_.at("tissue.metric"));
    queries.take_energy(pictures_.at("tissue.energy"));
    ASSERT_TRUE(queries.energy_at(glm::dvec3(20, 20, 0), 1.0).has_value());
    for (const double odd : {nan, infinity, -infinity, 1e300}) {
        EXPECT_FALSE(queries.energy_at(glm::dvec2(odd, 0.5)).has_value()) << odd;
        EXPECT_FALSE(queries.energy_at(glm::dvec3(odd, 20, 0), 1.0).has_value()) << odd;
    }
    EXPECT_FALSE(queries.energy_at(glm::dvec3(20, 20, 0), nan).has_value());
    EXPECT_FALSE(queries.energy_at(glm::dvec3(20, 20, 0), -1.0).has_value());
    EXPECT_TRUE(queries.energy_at(glm::dvec3(20, 20, 0), infinity).has_value());
    EXPECT_EQ(queries.coagulated_area(nan), 0.0);
    EXPECT_EQ(queries.coagulated_area(infinity), 0.0);
    EXPECT_GT(queries.coagulated_area(-1.0), 0.0) << "0 is never coagulated";
    EXPECT_EQ(queries.coagulated_area(-1.0), queries.coagulated_area(0.0));
}

TEST_F(TissueTools, ABakeOfAnotherMesh) {
    json scene{{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.energy"}}};
    scene["passes"] = passes({{"file", Plane().write("stress").string()}});
    scene["passes"][0]["parameters"]["mesh"] = {{"file", Plane{.cells = 3}.write("stress3").string()}};
    load(scene);
    time_s_ = 0.0;
    hold({}, {});
    (void)hold({7}, tool_at(20, 20, 0), {20, 20, 0, 2, 5, 0});
    expect_said_once("tissue.other_mesh", "tissue.coagulate has");
    expect_said_once("tissue.other_mesh", "of another mesh or atlas");
}

/// The same mesh, but placed or moved by the bake alone: contacts are looked for where it is not.
TEST_F(TissueTools, ABakeOfTheMeshInAnotherPlace) {
    const json mesh{{"file", Plane().write("stress").string()}};
    for (const json& other :
         {json{{"placement", {{"move_mm", {5, 0, 0}}}}}, json{{"host_positions", "moved"}}}) {
        for (const bool both : {true, false}) {
            json scene{{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.energy"}}};
            json moved = mesh;
            moved.update(other);
            scene["passes"] = passes(both ? moved : mesh);
            scene["passes"][0]["parameters"]["mesh"] = moved;
            const auto before = renderer().log().faults()["tissue.other_place"];
            load(scene);
            time_s_ = 0.0;
            hold({}, {});
            (void)hold({7}, tool_at(20, 20, 0), {20, 20, 0, 2, 5, 0});
            EXPECT_EQ(renderer().log().faults()["tissue.other_place"] == before, both) << other;
        }
    }
    expect_said_once("tissue.other_place", "than the bake that it reads");
    EXPECT_FALSE(renderer().log().faults().contains("tissue.other_mesh")) << said();
}

TEST_F(TissueTools, ABakeThatIsMovedAlone) {
    json scene{{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.energy"}}};
    scene["passes"] = passes({{"file", Plane().write("stress").string()}});
    load(scene);
    time_s_ = 0.0;
    (void)hold({}, {}, {20, 20, 0, 2, 5, 0});
    (void)hold({}, {}, {20, 20, 0, 2, 5, 0});
    EXPECT_FALSE(renderer().log().faults().contains("tissue.other_place")) << said();
    renderer().set_parameter("bake", "/mesh/placement/move_mm", {0, 3, 0});
    (void)hold({}, {}, {20, 20, 0, 2, 5, 0});  // may begin anew, and a first frame has no time
    (void)hold({}, {}, {20, 20, 0, 2, 5, 0});
    expect_said_once("tissue.other_place", "tissue.coagulate has another");
}

/// Also when the bake alone is given another mesh, while the passes that paint stay as they are.
TEST_F(TissueTools, ABakeThatBecomesThatOfAnotherMesh) {
    json scene{{"version", 1}, {"resolution", {16, 16}}, {"outputs", {"tissue.energy"}}};
    scene["passes"] = passes({{"file", Plane().write("stress").string()}});
    load(scene);
    values_.set("tissue.contacts", std::vector<float>{20, 20, 0, 2, 5, 0});
    const auto draw = [&](double time_s) {
        Frame frame = renderer().still(time_s);
        frame.values = &values_;
        renderer().render(frame);
    };
    draw(0.0);
    draw(0.25);
    EXPECT_FALSE(renderer().log().faults().contains("tissue.other_mesh")) << said();
    renderer().set_parameter("bake", "/mesh/file", Plane{.cells = 3}.write("stress3").string());
    draw(0.5);
    expect_said_once("tissue.other_mesh", "tissue.coagulate has");
}

}  // namespace
}  // namespace viscera::test
