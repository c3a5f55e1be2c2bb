#include "effects/tissue/energy_queries.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <thread>

#include "tests/embed/recorder.h"
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
    // What a line between texels misses of the cone, 5 mm and more from its tip. The texel itself is off by
    // up to 0.035.
    for (const glm::dvec2 uv : {glm::dvec2(0.3, 0.4), glm::dvec2(0.501, 0.77), glm::dvec2(32.0, 90.0) / 128.0,
                                glm::dvec2(64.97, 12.03) / 128.0}) {
        const auto e = queries_.energy_at(uv);
        ASSERT_TRUE(e);
        EXPECT_NEAR(*e, energy(uv * 64.0), 1e-3) << uv.x;
    }
    EXPECT_EQ(queries_.energy_at(glm::dvec2(0.001, 0.999)), static_cast<double>(energy_.at(0, n - 1, 0)))
        << "within half a texel of the edge";
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
    EXPECT_EQ(queries_.energy_at(glm::dvec3(20.25, 33.25, 7.0), 0.0),
              static_cast<double>(energy_.at(40, 66, 0)));
    EXPECT_EQ(queries_.energy_at(glm::dvec3(20.25, 33.25, 7.5), 0.5),
              static_cast<double>(energy_.at(40, 66, 0)));
    EXPECT_FALSE(queries_.energy_at(glm::dvec3(20.25, 33.26, 7.0), 0.0));
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

/// What pictures that were read say, worked out anew.
struct Read {
    explicit Read(EnergyStage& stage, const std::string& prefix = "tissue")
        : energy(stage.stage.renderer().read(prefix + ".energy")),
          position(stage.stage.renderer().read(prefix + ".position")),
          metric(stage.stage.renderer().read(prefix + ".metric")) {}

    [[nodiscard]] double area(double threshold) const {
        double sum = 0.0;
        for (int y = 0; y < energy.height; ++y) {
            for (int x = 0; x < energy.width; ++x) {
                const bool counts =
                    position.at(x, y, 3) == 1.0F && static_cast<double>(energy.at(x, y, 0)) >= threshold;
                sum += counts ? static_cast<double>(metric.at(x, y, 3)) : 0.0;
            }
        }
        return sum;
    }
    /// Away from the texture's edge.
    [[nodiscard]] double at(const glm::dvec2& uv) const {
        const glm::dvec2 place = uv * glm::dvec2(energy.width, energy.height);
        double sum = 0.0;
        for (int y = 0; y < energy.height; ++y) {
            for (int x = 0; x < energy.width; ++x) {
                const glm::dvec2 weight =
                    glm::max(1.0 - glm::abs(place - glm::dvec2(x, y) - 0.5), glm::dvec2(0.0));
                sum += weight.x * weight.y * static_cast<double>(energy.at(x, y, 0));
            }
        }
        return sum;
    }
    [[nodiscard]] double at(const glm::dvec3& point) const {
        double least = 1e30;
        double nearest = 0.0;
        for (int y = 0; y < energy.height; ++y) {
            for (int x = 0; x < energy.width; ++x) {
                const glm::dvec3 place(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
                if (position.at(x, y, 3) == 1.0F && glm::distance(place, point) < least) {
                    least = glm::distance(place, point);
                    nearest = static_cast<double>(energy.at(x, y, 0));
                }
            }
        }
        return nearest;
    }

    Image energy;
    Image position;
    Image metric;
};

void expect_equal(const EnergyQueries& queries, const Read& read) {
    EXPECT_NEAR(queries.coagulated_area(0.3), read.area(0.3), 1e-9);
    const glm::dvec2 uv(0.4012, 0.4507);
    ASSERT_TRUE(queries.energy_at(uv));
    EXPECT_NEAR(*queries.energy_at(uv), read.at(uv), 1e-9);
    const glm::dvec3 point(15.03, 18.07, 0.1);
    ASSERT_TRUE(queries.energy_at(point, 1.0));
    EXPECT_EQ(*queries.energy_at(point, 1.0), read.at(point));
}

/// Polls until the answers are those of the last frame.
void catch_up(EnergyQueries& queries, Renderer& renderer) {
    for (int i = 0; i < 2000 && !(queries.update(renderer) && queries.frames_behind() == 0); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(queries.frames_behind(), 0U);
}

/// While a contact moves: the answers of the logic against a read that waits, where it polls and where it
/// waits.
TEST(EnergyQueriesOnTheGpu, AgreeWithABlockingReadOfTheFrameTheyAreFrom) {
    for (const bool waits : {false, true}) {
        EnergyStage stage;
        Renderer& renderer = stage.stage.renderer();
        renderer.watch(EnergyQueries::targets());
        renderer.keep({"tissue.metric"});
        EnergyQueries queries;
        std::vector<Read> reads;
        std::size_t answers = 0;
        for (int i = 0; i < 30; ++i) {
            stage.contacts({{10.0 + 0.6 * i, 18.0, 0.0, 8.0, 2.0}});
            stage.frame(i / 60.0);
            const bool answer = waits ? queries.update(renderer, 1) : queries.update(renderer);
            reads.emplace_back(stage);
            EXPECT_TRUE(answer || !waits) << "frame " << i;
            if (!answer) {
                continue;
            }
            // The copy is of this frame or of one before; what a read that waited gave then says the same.
            const auto frame = static_cast<std::size_t>(std::lround(queries.time_s() * 60.0));
            ASSERT_LT(frame, reads.size());
            expect_equal(queries, reads[frame]);
            EXPECT_EQ(queries.frames_behind(), static_cast<std::uint64_t>(i) - frame);
            EXPECT_LE(queries.frames_behind(), 1U);
            ++answers;
        }
        EXPECT_GT(answers, 10U);
        // Once nothing moves, the answers are those of the last frame.
        catch_up(queries, renderer);
        expect_equal(queries, Read(stage));
        EXPECT_GT(queries.coagulated_area(0.3), 20.0);
    }
}

/// A renderer whose GPU is done when the test says so.
class SlowGpu : public testing::Test {
  protected:
    static nlohmann::json moved_scene() {
        nlohmann::json scene = EnergyStage::scene();
        for (nlohmann::json& pass : scene["passes"]) {
            pass["parameters"]["mesh"]["host_positions"] = "organ";
        }
        return scene;
    }
    /// The plane, so high.
    void lift(float z) {
        const Plane plane;
        std::vector<float> places;
        for (int y = 0; y <= plane.cells; ++y) {
            for (int x = 0; x <= plane.cells; ++x) {
                places.push_back(static_cast<float>(plane.side_mm * x / plane.cells));
                places.push_back(static_cast<float>(plane.side_mm * y / plane.cells));
                places.push_back(z);
            }
        }
        stage_.values.set("organ", places);
    }

    std::optional<Recorder> recorder_;
    EnergyStage stage_{nlohmann::json::object(), Plane(), "plane", 128, "r32f", [this](ProcAddress real) {
                           recorder_.emplace(real);
                           return recorder_->proc();
                       }};
    Renderer& renderer_ = stage_.stage.renderer();
    EnergyQueries queries_;
};

TEST_F(SlowGpu, UpdatesDoNotWaitForIt) {
    renderer_.watch(EnergyQueries::targets());
    stage_.contacts({{20.0, 18.0, 0.0, 8.0, 2.0}});
    stage_.frame(0.0);
    stage_.frame(0.1);
    catch_up(queries_, renderer_);
    const double area = queries_.coagulated_area(0.3);
    EXPECT_GT(area, 1.0);
    recorder_->hold_fences();
    const std::size_t waits = recorder_->waits();
    for (std::uint64_t i = 1; i < 8; ++i) {
        stage_.frame(0.1 + 0.1 * static_cast<double>(i));
        EXPECT_TRUE(queries_.update(renderer_));
        EXPECT_EQ(queries_.frames_behind(), i);
        EXPECT_EQ(queries_.coagulated_area(0.3), area);
    }
    EXPECT_EQ(recorder_->waits(), waits);
    EXPECT_TRUE(queries_.update(renderer_, 1));
    EXPECT_LE(queries_.frames_behind(), 1U);
    EXPECT_GT(recorder_->waits(), waits);
    // The last frames come though none follows.
    recorder_->hold_fences(false);
    catch_up(queries_, renderer_);
    expect_equal(queries_, Read(stage_));
    EXPECT_GT(queries_.coagulated_area(0.3), area);
}

TEST_F(SlowGpu, AnswersAreAsOldAsTheOldestCopy) {
    stage_.stage.load(moved_scene());
    renderer_.watch(EnergyQueries::targets());
    lift(0.0F);
    stage_.frame(0.0);
    stage_.frame(0.1);
    catch_up(queries_, renderer_);
    recorder_->hold_fences();
    for (int i = 1; i < 4; ++i) {
        lift(static_cast<float>(i));
        stage_.frame(0.1 + 0.1 * i);
        EXPECT_TRUE(queries_.update(renderer_));
        EXPECT_EQ(renderer_.watched("tissue.energy")->frames_behind, 0U) << "nothing burns";
        EXPECT_EQ(queries_.frames_behind(), static_cast<std::uint64_t>(i));
        EXPECT_EQ(queries_.time_s(), 0.1);
        EXPECT_TRUE(queries_.energy_at(glm::dvec3(20, 18, 0), 0.5));
    }
    recorder_->hold_fences(false);
    catch_up(queries_, renderer_);
    EXPECT_FALSE(queries_.energy_at(glm::dvec3(20, 18, 0), 0.5));
    EXPECT_TRUE(queries_.energy_at(glm::dvec3(20, 18, 3), 0.5));
}

TEST_F(SlowGpu, AnswersOfAnotherSceneAreForgotten) {
    const auto load = [&](double side_mm, int size) {
        Plane plane;
        plane.side_mm = side_mm;
        stage_.stage.load(EnergyStage::scene(nlohmann::json::object(), plane, "other", size));
    };
    renderer_.watch(EnergyQueries::targets());
    stage_.contacts({{20.0, 18.0, 0.0, 8.0, 2.0}});
    for (const double time_s : {0.0, 0.1, 0.2}) {
        stage_.frame(time_s);
    }
    catch_up(queries_, renderer_);
    EXPECT_GT(queries_.coagulated_area(0.3), 1.0);
    EXPECT_FALSE(queries_.energy_at(glm::dvec3(70, 70, 0), 1.0));
    // Of the same size, then of another.
    for (const int size : {128, 64}) {
        load(size == 128 ? 80.0 : 160.0, size);
        recorder_->hold_fences();
        for (int i = 0; i < 2; ++i) {
            EXPECT_FALSE(queries_.update(renderer_));
            EXPECT_FALSE(queries_.energy_at(glm::dvec2(0.5, 0.5)));
            EXPECT_FALSE(queries_.energy_at(glm::dvec3(20, 18, 0), 1.0));
            EXPECT_EQ(queries_.coagulated_area(0.3), 0.0);
            EXPECT_EQ(queries_.frames_behind(), 0U);
            EXPECT_EQ(queries_.time_s(), 0.0);
            stage_.frame(0.0);
        }
        recorder_->hold_fences(false);
        catch_up(queries_, renderer_);
        EXPECT_TRUE(queries_.energy_at(glm::dvec3(70, 70, 0), 2.0)) << "the new organ's places";
        EXPECT_EQ(queries_.energy_at(glm::dvec3(150, 70, 0), 2.0).has_value(), size == 64);
        EXPECT_EQ(queries_.coagulated_area(0.3), 0.0) << "the old organ was burnt, not this one";
    }
    renderer_.set_parameter("coagulate", "/size", 32);
    EXPECT_FALSE(queries_.update(renderer_)) << "other sizes make another scene";
}

TEST(EnergyQueriesOnTheGpu, TargetsMayHaveOtherNames) {
    nlohmann::json scene = EnergyStage::scene();
    scene["passes"][0]["targets"] = {{"position", "liver.position"}, {"metric", "liver.metric"}};
    scene["passes"][1]["targets"] = {
        {"position", "liver.position"}, {"last", "liver.energy"}, {"energy", "liver.energy"}};
    scene["targets"] = {{"liver.energy", {{"format", "r32f"}}}};
    scene["outputs"] = {"liver.energy", "liver.position", "liver.metric"};
    EnergyStage stage;
    stage.stage.load(scene);
    const tissue::EnergyTargets names{"liver.energy", "liver.position", "liver.metric"};
    stage.stage.renderer().watch(EnergyQueries::targets(names));
    stage.contacts({{20.0, 18.0, 0.0, 8.0, 2.0}});
    stage.frame(0.0);
    stage.frame(0.1);
    EnergyQueries queries(names);
    catch_up(queries, stage.stage.renderer());
    expect_equal(queries, Read(stage, "liver"));
    EXPECT_GT(queries.coagulated_area(0.3), 1.0);
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
    catch_up(queries, stage.stage.renderer());
    const double radius2 = 2.0 * 16.0 * std::log(0.4 / 0.1);
    EXPECT_NEAR(queries.coagulated_area(0.1), std::numbers::pi * radius2, 0.01 * std::numbers::pi * radius2);
}

}  // namespace
}  // namespace viscera::test
