#include <algorithm>
#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "effects/tissue/blood_state.h"
#include "engine/runtime/pass.h"
#include "tests/reference/tissue_drops.h"
#include "tests/tissue/blood_stage.h"

// The way of a drop on the GPU, read from its ring, against the same rules in double precision.
namespace viscera::test {
namespace {

using nlohmann::json;

/// Draws the ring of drops of the blood named "blood", whose state it finds.
class DropsEffect final : public Effect {
  public:
    explicit DropsEffect(std::weak_ptr<tissue::BloodState>& found) : found_(found) {}

    void visit(ParamVisitor& /*v*/) override {}
    std::vector<Port> ports() const override {
        return {
            {.name = "height", .access = Access::read, .target = "tissue.blood_height", .doc = "After it."},
            {.name = "drops",
             .access = Access::write,
             .target = "test.drops",
             .doc = "The ring.",
             .format = PixelFormat::rgba32f,
             .size = {.width = 256, .height = 16}}};
    }
    std::span<const ProgramDesc> programs() const override { return programs_; }
    Work prepare(Prepare& prepare) override {
        found_ = state_ = tissue::BloodState::find(prepare.assets(), "blood");
        return prepare.has("height") ? Work::all(0) : Work::idle("there is no blood");
    }
    void draw(const Pass& pass) override {
        const gl::Program& program = pass.use(0);
        pass.bind(program, "u_film", state_->gpu->drops(), gl::Filter::nearest);
        pass.draw_fullscreen();
    }

  private:
    std::vector<ProgramDesc> programs_{{"common/fullscreen.vert", "tissue/blood_copy.frag", {}}};
    std::weak_ptr<tissue::BloodState>& found_;
    std::shared_ptr<tissue::BloodState> state_;
};

struct Watched {
    std::unique_ptr<Context> context = create_context(Backend::osmesa, {.debug = true});
    Registry registry;
    std::weak_ptr<tissue::BloodState> state;  ///< must not outlive the renderer
    std::unique_ptr<Renderer> renderer;

    explicit Watched(json scene) {
        register_all(registry);
        registry.add("test.drops", "Drops.", [this] { return std::make_unique<DropsEffect>(state); });
        renderer = std::make_unique<Renderer>(context->proc_address(), registry, RendererOptions{});
        scene["passes"].push_back(pass("drops", "test.drops", json::object()));
        scene["outputs"].push_back("test.drops");
        renderer->set_scene(parse_scene(scene.dump(), "test.json"));
    }
    ~Watched() { context->make_current(); }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;

    reference::Drop drop(double time_s) const {
        renderer->render(renderer->still(time_s));
        const Image ring = renderer->read("test.drops");
        return {{ring.at(0, 0, 0), ring.at(0, 0, 1)}, ring.at(0, 0, 2), ring.at(0, 0, 3)};
    }
};

TEST(BloodDropReference, AWayOverASeamIsTheReferences) {
    BloodStage stage(96);
    // Bent, cut in the middle; the second chart is turned, mirrored and finer.
    const std::array<SurfaceChart, 2> charts{SurfaceChart{.high = {30.0, 40.0},
                                                          .origin_px = {8.0, 8.0},
                                                          .a_px = {1.0, 0.15},
                                                          .b_px = {0.0, 1.1},
                                                          .cells = {15, 20}},
                                             SurfaceChart{.low = {30.0, 0.0},
                                                          .high = {60.0, 40.0},
                                                          .origin_px = {48.4, -31.0},
                                                          .a_px = {0.0, 1.3},
                                                          .b_px = {1.0, 0.0},
                                                          .cells = {15, 20}}};
    const auto place = [](glm::dvec2 p) {
        return glm::dvec3(p, 0.004 * (p.x - 80.0) * (p.x - 80.0) + 0.01 * (p.y - 20.0) * (p.y - 20.0));
    };
    stage.surface(charts, place);
    stage.gravity = {{"gravity_m_s2", {0.0, 0.0, -9.0}}};
    const glm::dvec3 start = place({12.0, 13.0});
    constexpr double rate = 120.0;
    stage.blood = {{"liquid",
                    {{"viscosity_mpa_s", 20.0},
                     {"trail_mm", 0.002},
                     {"drop_life_s", 600.0},
                     {"drop_mm3", 0.5},
                     {"steps_per_s", rate},
                     {"max_drops", 256}}},
                   {"wounds",
                    {{{"position_mm", {start.x, start.y, start.z}},
                      {"radius_mm", 0.0},
                      {"rate_mm3_s", 0.5 * rate * 1.01},
                      {"stop_s", 1.0 / rate}}}}};
    Watched watched(stage.scene());
    watched.drop(0.0);
    reference::Drop drop = watched.drop(1.0 / rate);
    ASSERT_NEAR(drop.volume_mm3, 0.5, 0.01);
    stage.load();
    stage.frame(0.0);
    const reference::TissueSurface surface = stage.baked();
    const Image map = stage.read("tissue.gravity");
    std::vector<glm::dvec4> gravity;
    for (int y = 0; y < 96; ++y) {
        for (int x = 0; x < 96; ++x) {
            gravity.emplace_back(map.at(x, y, 0), map.at(x, y, 1), map.at(x, y, 2), map.at(x, y, 3));
        }
    }
    const reference::DropWay way(surface, gravity,
                                 {.mobility_per_mm_s = 1060.0 * 9.80665 / 20.0,
                                  .strength = 9.0 / 9.80665,
                                  .trail_mm = 0.002,
                                  .life_s = 600.0,
                                  .smallest_mm3 = 0.01});
    int step = 1;
    int crossings = 0;
    double worst_px = 0.0;
    double worst_volume = 0.0;
    for (const int until : {2, 60, 120, 180, 240, 300, 360}) {
        for (; step < until; ++step) {
            const reference::DropStep next = way.step(drop, 1.0 / rate);
            drop = next.drop;
            crossings += next.across_seam ? 1 : 0;
        }
        const reference::Drop found = watched.drop(until / rate);
        const double off_px = 96.0 * glm::length(found.uv - drop.uv);
        worst_px = std::max(worst_px, off_px);
        worst_volume = std::max(worst_volume, std::abs(found.volume_mm3 / drop.volume_mm3 - 1.0));
        std::printf("  step %3d: at (%.3f, %.3f) px, off by %.1e px, volume %.4f mm^3, off by %+.1e\n", until,
                    96.0 * drop.uv.x, 96.0 * drop.uv.y, off_px, drop.volume_mm3,
                    found.volume_mm3 / drop.volume_mm3 - 1.0);
        EXPECT_NEAR(found.age_s, drop.age_s, 1e-4);
    }
    EXPECT_GE(crossings, 1);
    EXPECT_LT(worst_px, 2e-4);
    EXPECT_LT(worst_volume, 5e-6);
}

/// Drops run down a wall and are spent on the way: few of all that have come are drawn, all that live are,
/// and none comes back, in a ring in which each has a place of its own and in one that goes round several
/// times.
TEST(BloodDropReference, WhatHasGoneIsDrawnNoMore) {
    for (const int max_drops : {4096, 512}) {
        BloodStage stage(96);
        const SurfaceChart chart{.high = {80.0, 80.0},
                                 .origin_px = {8.0, 8.0},
                                 .a_px = {1.0, 0.0},
                                 .b_px = {0.0, 1.0},
                                 .cells = {2, 2}};
        stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p.x, 0.0, p.y); });
        stage.gravity = {{"gravity_m_s2", {0.0, 0.0, -9.80665}}};
        stage.blood = {{"liquid", {{"drop_mm3", 0.5}, {"max_drops", max_drops}}},
                       {"wounds",
                        {{{"position_mm", {20.0, 0.0, 60.0}}, {"rate_mm3_s", 150.0}},
                         {{"position_mm", {60.0, 0.0, 60.0}}, {"rate_mm3_s", 20.0}}}}};
        Watched watched(stage.scene());
        std::int64_t most_listed = 0;
        std::int64_t most_alive = 0;
        // A step in each frame, so that either of the two textures that take turns is seen.
        for (int frame = 0; frame <= 720; ++frame) {
            watched.renderer->render(watched.renderer->still(frame / 120.0));
            const std::shared_ptr<tissue::BloodState> state = watched.state.lock();
            if (frame % 15 != 0 || state == nullptr || state->gpu == nullptr) {
                continue;
            }
            const Image ring = watched.renderer->read("test.drops");
            const std::span<const std::uint16_t> lives = state->ring.lives();
            std::int64_t alive = 0;
            for (int y = 0; y < std::max(max_drops / 256, 4); ++y) {
                for (int x = 0; x < 256; ++x) {
                    if (ring.at(x, y, 2) > 0.0F) {
                        ++alive;
                        const auto group = static_cast<std::size_t>(y / 4 * 64 + x / 4);
                        EXPECT_TRUE((lives[group] >> (y % 4 * 4 + x % 4) & 1) != 0) << x << ' ' << y;
                    }
                }
            }
            most_alive = std::max(most_alive, alive);
            std::int64_t listed = 0;
            for (const std::uint16_t of_group : lives) {
                listed += std::popcount(of_group);
            }
            most_listed = std::max(most_listed, listed);
        }
        const std::int64_t came = watched.state.lock()->ring.head();
        const BloodAccount account = account_of(watched.renderer->read("tissue.blood_account"));
        std::printf("  %d drops came, at most %d lived, at most %d are drawn; kept / given - 1 = %.1e\n",
                    static_cast<int>(came), static_cast<int>(most_alive), static_cast<int>(most_listed),
                    account.kept() / account.given - 1.0);
        EXPECT_GT(came, 1500);
        EXPECT_GT(most_alive, 10);
        EXPECT_LT(most_listed, came / 10);
        EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-5);
    }
}

}  // namespace
}  // namespace viscera::test
