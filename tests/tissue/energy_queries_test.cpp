#include "effects/tissue/energy_queries.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include "tests/tissue/energy_stage.h"

namespace viscera::test {
namespace {

using tissue::EnergyQueries;

/// A plane of 128 x 128 texels, 0.5 mm each, with a cone of energy in its middle.
class FlatSurface : public testing::Test {
  protected:
    FlatSurface() {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                const glm::dvec2 p = 0.5 * (glm::dvec2(x, y) + 0.5);
                position_.set(x, y, 0, static_cast<float>(p.x));
                position_.set(x, y, 1, static_cast<float>(p.y));
                position_.set(x, y, 2, 7.0F);
                position_.set(x, y, 3, x < 100 ? 1.0F : (x < 105 ? 0.5F : 0.0F));
                metric_.set(x, y, 3, 0.25F);
                energy_.set(x, y, 0, static_cast<float>(energy(p)));
            }
        }
        queries_.take_surface(position_, metric_);
        queries_.take_energy(energy_);
    }
    static double energy(const glm::dvec2& p) { return 1.0 - glm::distance(p, glm::dvec2(25, 30)) / 10.0; }

    static constexpr int n = 128;
    Image position_ = make_image(n, n, PixelFormat::rgba32f);
    Image metric_ = make_image(n, n, PixelFormat::rgba32f);
    Image energy_ = make_image(n, n, PixelFormat::r32f);
    EnergyQueries queries_;
};

TEST_F(FlatSurface, EnergyAtUvIsInterpolated) {
    for (const glm::dvec2 uv : {glm::dvec2(0.3, 0.4), glm::dvec2(0.501, 0.77), glm::dvec2(0.001, 0.999)}) {
        const auto e = queries_.energy_at(uv);
        ASSERT_TRUE(e);
        EXPECT_NEAR(*e, energy(uv * 64.0), 0.04) << uv.x;  // within half a texel of the edge
    }
    EXPECT_FALSE(queries_.energy_at(glm::dvec2(0.8, 0.5))) << "a gutter";
    EXPECT_FALSE(queries_.energy_at(glm::dvec2(0.95, 0.5)));
    EXPECT_FALSE(queries_.energy_at(glm::dvec2(-0.1, 0.5)));
    EXPECT_FALSE(queries_.energy_at(glm::dvec2(std::nan(""), 0.5)));
    EXPECT_FALSE(EnergyQueries().energy_at(glm::dvec2(0.5, 0.5)));
}

TEST_F(FlatSurface, EnergyAtAPointIsThatOfTheNearestTexel) {
    for (int i = 0; i < 50; ++i) {
        const glm::dvec3 p(0.305 + 0.97 * i, 63.03 - 1.2 * i, 7.0 + 0.01 * i);
        const auto e = queries_.energy_at(p, 1.0);
        ASSERT_TRUE(e) << i;
        const int x = std::clamp(static_cast<int>(p.x / 0.5), 0, 99);
        const int y = std::clamp(static_cast<int>(p.y / 0.5), 0, n - 1);
        EXPECT_EQ(*e, static_cast<double>(energy_.at(x, y, 0))) << i;
    }
    EXPECT_FALSE(queries_.energy_at(glm::dvec3(20, 20, 9.0), 1.0));
    EXPECT_FALSE(queries_.energy_at(glm::dvec3(std::nan(""), 20, 7.0), 1.0));
    EXPECT_TRUE(queries_.energy_at(glm::dvec3(20, 20, 9.0), 3.0));
}

TEST_F(FlatSurface, AreasAreInSquareMillimetres) {
    // Discs of the cone; a texel counts whole, which over a circle evens out.
    for (const double threshold : {0.2, 0.5, 0.9}) {
        const double radius = 10.0 * (1.0 - threshold);
        EXPECT_NEAR(queries_.coagulated_area(threshold), std::numbers::pi * radius * radius, 0.5 * radius);
    }
    EXPECT_NEAR(queries_.coagulated_area(0.0) + queries_.dissected_area(), 50.0 * 64.0, 0.5);
    EXPECT_EQ(queries_.coagulated_area(5.0), 0.0);
}

TEST_F(FlatSurface, PicturesThatDoNotFitAreRefused) {
    EXPECT_THROW(queries_.take_energy(make_image(64, 64, PixelFormat::r32f)), Error);
    EXPECT_THROW(queries_.take_energy(position_), Error);
    EXPECT_THROW(queries_.take_surface(position_, energy_), Error);
}

/// While a contact moves: the answers of the logic against a read that waits.
TEST(EnergyQueriesOnTheGpu, AgreeWithABlockingReadOfTheFrameTheyAreFrom) {
    EnergyStage stage;
    stage.stage.renderer().watch(EnergyQueries::targets());
    EnergyQueries queries;
    std::vector<Image> energies;
    std::size_t answers = 0;
    for (int i = 0; i < 30; ++i) {
        stage.contacts({{10.0 + 0.6 * i, 18.0, 0.0, 8.0, 2.0}});
        stage.frame(i / 60.0);
        const bool answer = queries.update(stage.stage.renderer());
        energies.push_back(stage.energy());
        if (!answer) {
            continue;
        }
        // The copy is of this frame or of one before; what a read that waited gave then says the same.
        const auto frame = static_cast<std::size_t>(std::lround(queries.time_s() * 60.0));
        ASSERT_LT(frame, energies.size());
        EnergyQueries blocking;
        blocking.take_surface(stage.position(), stage.stage.renderer().read("tissue.metric"));
        blocking.take_energy(energies[frame]);
        EXPECT_EQ(queries.coagulated_area(0.3), blocking.coagulated_area(0.3));
        EXPECT_EQ(queries.energy_at(glm::dvec2(0.4, 0.45)), blocking.energy_at(glm::dvec2(0.4, 0.45)));
        EXPECT_EQ(queries.energy_at(glm::dvec3(15, 18, 0), 1.0),
                  blocking.energy_at(glm::dvec3(15, 18, 0), 1.0));
        EXPECT_EQ(queries.frames_behind(), static_cast<std::uint64_t>(i) - frame);
        EXPECT_LE(queries.frames_behind(), 1U);
        ++answers;
    }
    EXPECT_GT(answers, 10U);
    // Once nothing moves, the answers are those of the last frame.
    for (int i = 0; i < 2000 && !(queries.update(stage.stage.renderer()) && queries.frames_behind() == 0);
         ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EnergyQueries blocking;
    blocking.take_surface(stage.position(), stage.stage.renderer().read("tissue.metric"));
    blocking.take_energy(stage.energy());
    EXPECT_EQ(queries.frames_behind(), 0U);
    EXPECT_EQ(queries.coagulated_area(0.3), blocking.coagulated_area(0.3));
    EXPECT_GT(queries.coagulated_area(0.3), 20.0);
}

/// A still contact burns a disc whose radius the closed form gives.
TEST(EnergyQueriesOnTheGpu, AreaIsMeasuredOnTheOrgan) {
    Plane stretched;
    stretched.stretch = 2.0;
    EnergyStage stage(nlohmann::json::object(), stretched, "stretched", 256);
    stage.stage.renderer().watch(EnergyQueries::targets());
    stage.contacts({{20, 20, 0, 1.6, 4.0}});
    stage.frame(0.0);
    stage.frame(0.25);
    EnergyQueries queries;
    for (int i = 0; i < 2000 && !(queries.update(stage.stage.renderer()) && queries.frames_behind() == 0);
         ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    const double radius2 = 2.0 * 16.0 * std::log(0.4 / 0.1);
    EXPECT_NEAR(queries.coagulated_area(0.1), std::numbers::pi * radius2, 0.01 * std::numbers::pi * radius2);
}

}  // namespace
}  // namespace viscera::test
