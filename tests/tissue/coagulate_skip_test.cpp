#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/io/exr.h"
#include "engine/runtime/frame_writer.h"
#include "tests/core/error_of.h"
#include "tests/tissue/energy_stage.h"

namespace viscera::test {
namespace {

using reference::Action;
using HostContact = EnergyStage::HostContact;

std::vector<HostContact> moving(int i) {
    return {{10.0 + 0.5 * i, 12.0, 0.0, 3.0, 1.2, Action::coagulate},
            {32.0, 32.0 - 0.4 * i, 0.0, 4.0, 1.0, i < 8 ? Action::dissect : Action::coagulate}};
}

TEST(CoagulateSkip, WhatContactsReachIsAllThatIsDrawnAndThePictureIsTheSame) {
    for (const bool seam : {false, true}) {
        Plane plane;
        plane.seam = seam;
        EnergyStage parts({}, plane, "parts");
        EnergyStage whole(nlohmann::json{{"mesh", nullptr}}, plane, "parts");
        for (int i = 0; i < 16; ++i) {
            for (EnergyStage* stage : {&parts, &whole}) {
                stage->stage.make_current();
                stage->contacts(i == 5 ? std::vector<HostContact>{} : moving(i));
                const PassReport report = stage->frame(i / 60.0);
                const bool idle = i == 0 || i == 5;
                EXPECT_EQ(report.status, idle              ? PassStatus::idle
                                         : stage == &parts ? PassStatus::reduced
                                                           : PassStatus::run);
                if (stage == &parts && !idle) {
                    EXPECT_EQ(report.reason, "only what contacts reach");
                }
            }
            parts.stage.make_current();
            const Image in_parts = parts.energy();
            whole.stage.make_current();
            EXPECT_TRUE(in_parts.data == whole.energy().data) << "frame " << i;
        }
        parts.stage.make_current();
    }
}

TEST(CoagulateSkip, WithoutContactsThereIsNothingToDo) {
    EnergyStage stage;
    stage.frame(0.0);
    EXPECT_EQ(stage.frame(0.1).status, PassStatus::idle);
    stage.contacts({{20, 20, 0, 2.0, 2.0}});
    EXPECT_EQ(stage.frame(0.2).status, PassStatus::reduced);
    const Image burnt = stage.energy();
    stage.contacts({});
    PassReport report = stage.frame(0.3);
    EXPECT_EQ(report.status, PassStatus::idle);
    EXPECT_EQ(report.reason, "nothing touches the tissue");
    EXPECT_TRUE(stage.energy().data == burnt.data) << "it stays";
    stage.contacts({{20, 20, 0, 2.0, 2.0}});
    EXPECT_EQ(stage.frame(0.3).reason, "no time has passed");
    EXPECT_TRUE(stage.energy().data == burnt.data);
    // In the air, off, or as wide as nothing.
    stage.contacts({{20, 20, 500, 2.0, 2.0}, {20, 20, 0, 0.0, 2.0}, {20, 20, 0, 1.0, 0.0}});
    report = stage.frame(0.4);
    EXPECT_EQ(report.status, PassStatus::idle);
    EXPECT_EQ(report.reason, "no contact reaches the tissue");
    EXPECT_TRUE(stage.energy().data == burnt.data);
}

TEST(CoagulateSkip, ALongPauseIsNotADose) {
    EnergyStage stage;
    stage.frame(0.0);
    stage.frame(10.0);
    stage.contacts({{20, 20, 0, 0.4, 2.0}});
    stage.frame(10.5);
    double highest = 0.0;
    stage.each_texel([&](const glm::dvec3&, double e) { highest = std::max(highest, e); });
    EXPECT_LE(highest, 0.2 + 1e-6);
    EXPECT_GE(highest, 0.19);
}

TEST(CoagulateSkip, TimeThatGoesBackBeginsAnew) {
    EnergyStage stage;
    stage.contacts({{20, 20, 0, 1.0, 2.0}});
    stage.frame(0.0);
    stage.frame(0.25);
    const Image once = stage.energy();
    stage.frame(0.5);
    EXPECT_FALSE(stage.energy().data == once.data);
    stage.frame(0.0);
    stage.each_texel([](const glm::dvec3&, double e) { ASSERT_EQ(e, 0.0); });
    stage.frame(0.25);
    EXPECT_TRUE(stage.energy().data == once.data);
}

TEST(CoagulateSkip, AParameterChangedOnTheWayKeepsWhatIsBurnt) {
    EnergyStage stage;
    stage.contacts({{20, 20, 0, 1.0, 2.0}});
    stage.frame(0.0);
    stage.frame(0.25);
    const Image before = stage.energy();
    stage.stage.renderer().set_parameter("coagulate", "/max_energy", 2.0);
    stage.frame(0.5);
    EXPECT_TRUE(stage.energy().data == before.data) << "its first frame has no time";
    stage.frame(0.75);
    EXPECT_FALSE(stage.energy().data == before.data);
}

TEST(CoagulateSkip, LimitsConfineWhatChanges) {
    EnergyStage stage(nlohmann::json{{"limit_to", {{"point_mm", {20, 20, 0}}, {"radius_mm", 3.0}}}});
    stage.contacts({{21, 20, 0, 2.0, 4.0}});
    stage.frame(0.0);
    stage.frame(0.25);
    const auto expect_within = [&](double radius) {
        stage.each_texel([&](const glm::dvec3& p, double e) {
            const double d = glm::distance(p, glm::dvec3(20, 20, 0));
            if (std::abs(d - radius) > 1e-4) {
                ASSERT_EQ(e > 0.0, d < radius) << d;
            }
        });
    };
    expect_within(3.0);
    stage.values.set("tissue.limit_to", std::vector<float>{20, 20, 0, 5});
    stage.frame(0.5);
    expect_within(5.0);
    // What is no ball is left out: the scene's holds.
    const std::vector<std::vector<float>> odd{
        {20, 20, 0, std::nanf("")}, {std::nanf(""), 20, 0, 5}, {20, 20, 0, -5}, {20, 20, 0}};
    for (std::size_t i = 0; i < odd.size(); ++i) {
        EnergyStage other(nlohmann::json{{"limit_to", {{"point_mm", {20, 20, 0}}, {"radius_mm", 3.0}}}});
        other.contacts({{21, 20, 0, 2.0, 4.0}});
        other.frame(0.0);
        other.values.set("tissue.limit_to", odd[i]);
        other.frame(0.25);
        other.each_texel([&](const glm::dvec3& p, double e) {
            const double d = glm::distance(p, glm::dvec3(20, 20, 0));
            if (std::abs(d - 3.0) > 1e-4) {
                ASSERT_EQ(e > 0.0, d < 3.0) << i << ": " << d;
            }
        });
        EXPECT_EQ(other.stage.renderer().log().faults().at("tissue.limit_to"), 1U) << i;
        EXPECT_EQ(other.stage.complaints().size(), 1U) << i;
    }
    stage.stage.make_current();
}

/// Frames 0 to 5, saved, loaded by another renderer, and on to 10: as if there had been no pause.
void expect_resumed(const std::string& format, PixelFormat stored) {
    const auto folder = process_folder() / ("saved_" + format);
    std::filesystem::create_directories(folder);
    const nlohmann::json contacts{{{"from_mm", {10, 12, 0}},
                                   {"to_mm", {30, 25, 0}},
                                   {"begin_s", 0.02},
                                   {"end_s", 0.15},
                                   {"power", 6.0},
                                   {"sigma_mm", 1.7}},
                                  {{"from_mm", {25, 15, 0}}, {"power", 3.0}, {"action", "dissect"}}};
    EnergyStage through(nlohmann::json{{"contacts", contacts}}, {}, "plane", 128, format);
    const auto render = [](EnergyStage& stage, std::uint64_t index) {
        Frame frame = stage.stage.renderer().frame(index);
        frame.values = &stage.values;
        stage.stage.renderer().render(frame);
    };
    for (std::uint64_t i = 0; i <= 10; ++i) {
        if (i == 5) {
            FrameWriter writer({.folder = folder}, {});
            through.stage.renderer().set_dump(
                {.kind = DumpRequest::Kind::names, .names = {"tissue.energy"}},
                [&](CapturedFrame&& frame) { writer.submit(std::move(frame)); });
            render(through, i);
            through.stage.renderer().finish_captures();
            through.stage.renderer().set_dump({}, {});
            writer.finish();
            continue;
        }
        render(through, i);
    }
    const Image expected = through.energy();
    const auto file = folder / "0005.tissue.energy.exr";
    ASSERT_TRUE(std::filesystem::exists(file));

    EnergyStage resumed(nlohmann::json{{"contacts", contacts}, {"load", {{"file", file.string()}}}}, {},
                        "plane", 128, format);
    for (std::uint64_t i = 6; i <= 10; ++i) {
        render(resumed, i);
    }
    EXPECT_EQ(expected.format, stored);
    EXPECT_TRUE(resumed.energy().data == expected.data);
    EXPECT_TRUE(io::read_exr(file).front().image.format == stored);
}

TEST(CoagulateSkip, ASavedStateGoesOnAsIfNothingHadHappened) {
    expect_resumed("r32f", PixelFormat::r32f);
}

TEST(CoagulateSkip, AHalfFloatStateIsSavedAndLoadedToTheBit) {
    expect_resumed("r16f", PixelFormat::r16f);
}

std::filesystem::path saved_file(const std::string& name) {
    return process_folder() / name;
}

Image picture_of(int size, PixelFormat format, float value) {
    Image image = make_image(size, size, format);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, value);
            }
        }
    }
    return image;
}

/// What contacts did before the state was saved is in it: frames on the way there add nothing.
TEST(CoagulateSkip, FramesBeforeTheSavedOneAddNothingToIt) {
    const auto file = saved_file("later.exr");
    const io::ExrPart part{.name = "tissue.energy",
                           .image = picture_of(128, PixelFormat::r32f, 0.25F),
                           .attributes = {{"viscera:time_s", 1.0F}}};
    io::write_exr(file, std::span(&part, 1));
    const nlohmann::json contacts{{{"from_mm", {20, 20, 0}}, {"power", 1.0}, {"sigma_mm", 2.0}}};
    EnergyStage stage(nlohmann::json{{"contacts", contacts}, {"load", {{"file", file.string()}}}});
    stage.frame(0.0);
    EXPECT_TRUE(stage.energy().data == part.image.data);
    const PassReport on_the_way = stage.frame(0.5);
    EXPECT_EQ(on_the_way.status, PassStatus::idle);
    EXPECT_EQ(on_the_way.reason, "the loaded state is of a later time");
    EXPECT_TRUE(stage.energy().data == part.image.data);
    // Half of the step from 0.5 s to 1.25 s lies behind the state's own time.
    stage.frame(1.25);
    double most = 0.0;
    stage.each_texel([&](const glm::dvec3&, double e) { most = std::max(most, e); });
    EXPECT_NEAR(most, 0.25 + 0.25, 5e-3);
}

TEST(CoagulateSkip, OfAFileWithSeveralPicturesTheEnergyIsLoaded) {
    const auto file = saved_file("parts.exr");
    std::vector<io::ExrPart> parts{
        {.name = "tissue.blood_height", .image = picture_of(128, PixelFormat::r32f, 99.0F)},
        {.name = "tissue.energy", .image = picture_of(128, PixelFormat::r32f, 0.5F)}};
    io::write_exr(file, parts);
    EnergyStage stage(nlohmann::json{{"load", {{"file", file.string()}}}});
    stage.frame(0.0);
    EXPECT_TRUE(stage.energy().data == parts[1].image.data);
    parts[1].name = "tissue.spare";
    io::write_exr(file, parts);
    EnergyStage refused(nlohmann::json{{"load", {{"file", file.string()}}}});
    EXPECT_THAT(error_of([&] { refused.frame(0.0); }).value().what(),
                testing::HasSubstr("none is named 'tissue.energy'"));
}

TEST(CoagulateSkip, APictureOfAnotherKindIsRefused) {
    const auto file = saved_file("colours.exr");
    const io::ExrPart part{.name = "organ.color", .image = picture_of(128, PixelFormat::rgba16f, 0.5F)};
    io::write_exr(file, std::span(&part, 1));
    EnergyStage stage(nlohmann::json{{"load", {{"file", file.string()}}}});
    EXPECT_THAT(error_of([&] { stage.frame(0.0); }).value().what(), testing::HasSubstr("an energy has one"));
}

/// Increments that a half float cannot hold must leave it alone, not wear it down.
TEST(CoagulateSkip, AHalfFloatStateDoesNotCreep) {
    EnergyStage stage(nlohmann::json::object(), {}, "plane", 64, "r16f");
    stage.frame(0.0);
    stage.contacts({{20, 20, 0, 3.0, 2.0, Action::dissect}});
    stage.frame(0.25);
    const Image cut = stage.energy();
    ASSERT_EQ(cut.format, PixelFormat::r16f);
    for (int i = 0; i < 40; ++i) {
        stage.contacts({{20, 20, 9, 0.01, 3.0, Action::ultrasound}});  // at most 2e-6 a frame
        EXPECT_EQ(stage.frame(0.25 + (i + 1) / 60.0).status, PassStatus::reduced);
    }
    const Image after = stage.energy();
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if (cut.at(x, y, 0) < -0.1F) {
                EXPECT_EQ(after.at(x, y, 0), cut.at(x, y, 0));
            }
        }
    }
}

TEST(CoagulateSkip, AStateOfAnotherSizeIsRefused) {
    const auto file = process_folder() / "small.exr";
    const io::ExrPart part{.name = "tissue.energy", .image = make_image(16, 16, PixelFormat::r32f)};
    io::write_exr(file, std::span(&part, 1));
    EnergyStage stage(nlohmann::json{{"load", {{"file", file.string()}}}});
    const std::string said = error_of([&] { stage.frame(0.0); }).value().what();
    EXPECT_THAT(said, testing::HasSubstr("small.exr"));
    EXPECT_THAT(said, testing::HasSubstr("16 x 16"));
    EXPECT_THAT(said, testing::StartsWith("pass 'coagulate', "));
}

}  // namespace
}  // namespace viscera::test
