#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "effects/register_all.h"
#include "engine/context/context.h"
#include "engine/runtime/renderer.h"
#include "tests/core/allocation_counter.h"

namespace viscera::test {
namespace {

/// The default scene, small, in a renderer as an app has it.
class WarmFrameTest : public testing::TestWithParam<HostStatePolicy> {
  protected:
    WarmFrameTest() : context_(create_context(Backend::osmesa)) {
        register_all(registry_);
        renderer_.emplace(context_->proc_address(), registry_);
        const auto scenes = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes";
        const std::vector<SceneOverride> small{{"/resolution", {256, 256}}};
        renderer_->set_scene(load_scene(scenes / "angiography.json", small));
    }

    /// Allocations of one frame.
    std::size_t allocations(double time_s) {
        Frame frame = renderer_->still(time_s);
        frame.host_state = GetParam();
        const std::size_t before = allocation_count();
        report_ = &renderer_->render(frame);
        return allocation_count() - before;
    }
    [[nodiscard]] std::size_t drawn() const {
        return static_cast<std::size_t>(std::ranges::count_if(report_->passes, [](const PassReport& pass) {
            return pass.status == PassStatus::run || pass.status == PassStatus::reduced;
        }));
    }

  private:
    std::unique_ptr<Context> context_;
    Registry registry_;
    std::optional<Renderer> renderer_;
    const FrameReport* report_ = nullptr;
};

TEST_P(WarmFrameTest, TheMovingBolusAllocatesNothing) {
    double time_s = 1.5;
    for (int i = 0; i < 3; ++i) {
        (void)allocations(time_s += 0.01);
    }
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(allocations(time_s += 0.01), 0U) << "at " << time_s << " s";
        EXPECT_GE(drawn(), 7U) << "the frame was to be a full one";
    }
}

TEST_P(WarmFrameTest, ACachedFrameAllocatesNothing) {
    (void)allocations(1.5);
    (void)allocations(1.5);
    EXPECT_EQ(allocations(1.5), 0U);
    EXPECT_EQ(drawn(), 0U);
}

INSTANTIATE_TEST_SUITE_P(HostState, WarmFrameTest,
                         testing::Values(HostStatePolicy::restore, HostStatePolicy::host_resets),
                         [](const auto& info) {
                             return info.param == HostStatePolicy::restore ? "Restored" : "HostResets";
                         });

}  // namespace
}  // namespace viscera::test
