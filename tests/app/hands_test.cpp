#include <cmath>
#include <optional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "effects/register_all.h"
#include "engine/context/context.h"
#include "engine/core/scene.h"
#include "engine/io/volume.h"
#include "samples/viscera/slice_hand.h"
#include "samples/viscera/window_hand.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

/// A volume whose value is 10 times the number of its slice, 2 mm apart.
Volume stairs() {
    Volume volume;
    volume.grid.dims = {8, 8, 20};
    volume.grid.spacing_mm = {1.0, 1.0, 2.0};
    volume.grid.origin_mm = {-3.5, -3.5, -19.0};
    for (int z = 0; z < 20; ++z) {
        volume.voxels.insert(volume.voxels.end(), 64, static_cast<std::byte>(10 * z));
    }
    return volume;
}

class Hands : public testing::Test {
  protected:
    Hands() : context_(create_context(Backend::osmesa, {})) {
        register_all(registry_);
        renderer_.emplace(context_->proc_address(), registry_);
        io::write_volume(stairs(), folder_ / "stairs.nrrd");
    }
    void load(const nlohmann::json& plane) {
        const nlohmann::json scene{
            {"version", 1},
            {"resolution", {8, 8}},
            {"passes",
             {{{"name", "cut"},
               {"effect", "volume.slice"},
               {"parameters",
                {{"volume", {{"file", "stairs.nrrd"}}},
                 {"plane", plane},
                 {"transfer_function", {{"window", {{"width", 200.0}, {"level", 100.0}}}}}}},
               {"targets", {{"colour", "slice"}}}}}},
            {"targets", {{"slice", {{"format", "rgba32f"}}}}},
            {"outputs", {"slice"}}};
        renderer_->set_scene(parse_scene(scene.dump(), folder_ / "scene.json"));
    }
    /// In the picture's middle.
    float grey() {
        (void)renderer_->render(renderer_->still(0.0));
        return renderer_->read("slice").at(4, 4, 0);
    }

    TempFolder folder_;
    std::unique_ptr<Context> context_;
    Registry registry_;
    std::optional<Renderer> renderer_;
};

TEST_F(Hands, SlicesGoOnByOneVoxelAndReturn) {
    for (const nlohmann::json& plane :
         {nlohmann::json{{"axis", "axial"}, {"position_mm", 1.0}}, nlohmann::json{{"axis", "axial"}},
          nlohmann::json{
              {"oblique", {{"point_mm", {0, 0, 1}}, {"normal", {0, 0, 1}}, {"up", {0, -1, 0}}}}}}) {
        load(plane);
        app::SliceHand hand(*renderer_);
        EXPECT_TRUE(hand.shows("slice"));
        EXPECT_FALSE(hand.shows("another"));
        const float before = grey();
        hand.scroll("slice", 3.0);
        EXPECT_NEAR(grey(), before + 3 * 10.0F / 200.0F, 2e-3F) << plane;
        hand.scroll("slice", -1.0);
        EXPECT_NEAR(grey(), before + 2 * 10.0F / 200.0F, 2e-3F) << plane;
        EXPECT_EQ(hand.revision(), 2U);
        hand.reset();
        EXPECT_NEAR(grey(), before, 1e-6F) << plane;
    }
}

TEST_F(Hands, WindowWidensSidewaysAndLevelRisesUpwards) {
    load({{"axis", "axial"}, {"position_mm", 5.0}});
    app::WindowHand hand(*renderer_);
    const float before = grey();
    EXPECT_NEAR(before, 120.0F / 200.0F, 2e-3F);
    hand.drag(0.0, 0.25);  // a quarter of the window up
    EXPECT_NEAR(grey(), before - 0.25F, 2e-3F);
    hand.reset();
    EXPECT_NEAR(grey(), before, 1e-6F);
    hand.drag(0.5, 0.0);
    EXPECT_NEAR(grey(), 0.5F + (before - 0.5F) / std::exp(1.0F), 2e-3F);
    for (int i = 0; i < 100; ++i) {
        hand.drag(-5.0, 0.0);
    }
    EXPECT_EQ(grey(), 1.0F) << "a narrow window is a step at its level";
    EXPECT_EQ(hand.revision(), 103U);
}

}  // namespace
}  // namespace viscera::test
