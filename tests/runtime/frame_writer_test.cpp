#include "engine/runtime/frame_writer.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <future>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/io/png.h"
#include "tests/core/error_of.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

Image filled(float value, int width = 8, int height = 4, PixelFormat format = PixelFormat::r16f) {
    Image image = make_image(width, height, format);
    for (int i = 0; i < width * height; ++i) {
        image.set(i % width, i / width, 0, value);
    }
    return image;
}

CapturedFrame frame(std::uint64_t index, float value = 0.5F) {
    CapturedFrame captured;
    captured.report.index = index;
    captured.report.time_s = 0.25 * static_cast<double>(index);
    captured.targets.push_back({"contrast.main", filled(value)});
    captured.targets.push_back({"final", filled(value + 0.25F, 8, 4, PixelFormat::r32f)});
    return captured;
}

std::vector<std::string> files_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        names.push_back(entry.path().filename().string());
    }
    return names;
}

/// Files of this process may not grow beyond a few bytes while it lives: what a full disk looks like.
class SmallFiles {
  public:
    explicit SmallFiles(rlim_t most_bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit small{most_bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
    }
    SmallFiles(const SmallFiles&) = delete;
    SmallFiles& operator=(const SmallFiles&) = delete;
    ~SmallFiles() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit before_{};
    void (*handler_)(int);
};

class Writer : public testing::Test {
  protected:
    FrameWriterOptions options() const { return {.folder = folder_.path(), .png = {"final"}}; }
    TempFolder folder_;
    std::vector<FrameReport> reports_;
    std::function<void(FrameReport&&)> done_ = [this](FrameReport&& report) {
        reports_.push_back(std::move(report));
    };
};

TEST_F(Writer, NamesFilesByFrameAndTarget) {
    FrameWriter writer(options(), done_);
    writer.submit(frame(0));
    writer.submit(frame(12345));
    writer.finish();
    EXPECT_THAT(files_in(folder_.path()),
                UnorderedElementsAre("0000.contrast.main.exr", "0000.final.exr", "0000.final.png",
                                     "12345.contrast.main.exr", "12345.final.exr", "12345.final.png"));
    ASSERT_EQ(reports_.size(), 2U);
    EXPECT_EQ(reports_[0].index, 0U);
    EXPECT_EQ(reports_[1].index, 12345U);
    EXPECT_EQ(reports_[0].targets[0].file, (folder_ / "0000.contrast.main.exr").string());
}

TEST_F(Writer, FilesHoldTheTargetsInTheirOwnPrecisionWithTheirAttributes) {
    FrameWriterOptions wanted = options();
    wanted.attributes = {
        {"viscera:scene_hash", "0123"}, {"viscera:camera", "{}"}, {"viscera:renderer", "none"}};
    FrameWriter writer(wanted, done_);
    writer.submit(frame(3));
    writer.finish();
    const std::vector<io::ExrPart> half = io::read_exr(folder_ / "0003.contrast.main.exr");
    ASSERT_EQ(half.size(), 1U);
    EXPECT_EQ(half[0].image.format, PixelFormat::r16f);
    EXPECT_EQ(half[0].image.data, filled(0.5F).data);
    for (const io::ExrAttribute& expected :
         {wanted.attributes[0], wanted.attributes[1], wanted.attributes[2],
          io::ExrAttribute{"viscera:time_s", 0.75F}, io::ExrAttribute{"viscera:frame", 3.0F}}) {
        EXPECT_THAT(half[0].attributes, testing::Contains(expected)) << expected.name;
    }
    const std::vector<io::ExrPart> full = io::read_exr(folder_ / "0003.final.exr");
    EXPECT_EQ(full.at(0).image.format, PixelFormat::r32f);
    EXPECT_EQ(full.at(0).image.data, filled(0.75F, 8, 4, PixelFormat::r32f).data);
    EXPECT_EQ(io::read_image(folder_ / "0003.final.png").at(0, 0, 0), 191.0F / 255.0F);
}

TEST_F(Writer, OneFileCanHoldAllTargets) {
    FrameWriterOptions wanted = options();
    wanted.multipart = true;
    wanted.compression = io::ExrCompression::piz;
    FrameWriter writer(wanted, done_);
    writer.submit(frame(7));
    writer.finish();
    EXPECT_THAT(files_in(folder_.path()), UnorderedElementsAre("0007.exr", "0007.final.png"));
    const std::vector<io::ExrPart> parts = io::read_exr(folder_ / "0007.exr");
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].name, "contrast.main");
    EXPECT_EQ(parts[1].name, "final");
    EXPECT_EQ(parts[0].compression, "piz");
    EXPECT_EQ(reports_.at(0).targets.at(1).file, (folder_ / "0007.exr").string());
}

TEST_F(Writer, EveryCompressionKeepsThePicture) {
    for (std::size_t i = 0; i < io::choice_names(io::ExrCompression::none).size(); ++i) {
        FrameWriterOptions wanted = options();
        wanted.compression = static_cast<io::ExrCompression>(i);
        FrameWriter writer(wanted, done_);
        writer.submit(frame(i));
        writer.finish();
        const auto parts = io::read_exr(folder_ / ("000" + std::to_string(i) + ".contrast.main.exr"));
        EXPECT_EQ(parts.at(0).image.at(3, 2, 0), 0.5F);
    }
}

TEST_F(Writer, CountsWhatIsNotFinite) {
    Image image = filled(0.5F);
    image.set(0, 0, 0, std::numeric_limits<float>::quiet_NaN());
    image.set(1, 0, 0, std::numeric_limits<float>::infinity());
    image.set(2, 0, 0, -std::numeric_limits<float>::infinity());
    image.set(3, 0, 0, -2.0F);
    const TargetReport report = summarise("t", image);
    EXPECT_EQ(report.nan, 1U);
    EXPECT_EQ(report.inf, 2U);
    EXPECT_EQ(report.min, -2.0);
    EXPECT_EQ(report.max, 0.5);
    const TargetReport nothing = summarise("t", filled(std::numeric_limits<float>::quiet_NaN()));
    EXPECT_EQ(nothing.nan, 32U);
    EXPECT_EQ(nothing.min, 0.0);
    EXPECT_EQ(nothing.max, 0.0);
}

TEST_F(Writer, MakesItsFolder) {
    FrameWriterOptions wanted = options();
    wanted.folder = folder_ / "a/b/c";
    FrameWriter writer(wanted, done_);
    writer.submit(frame(0));
    writer.finish();
    EXPECT_TRUE(std::filesystem::exists(wanted.folder / "0000.final.exr"));
}

TEST_F(Writer, AFolderThatCannotBeMadeIsATypedError) {
    (void)folder_.write("file", "x");
    for (const std::filesystem::path& place :
         {folder_ / "file", folder_ / "file/below", std::filesystem::path("/proc/viscera")}) {
        FrameWriterOptions wanted = options();
        wanted.folder = place;
        const auto error = error_of([&] { FrameWriter(wanted, done_).finish(); });
        ASSERT_TRUE(error) << place;
        EXPECT_EQ(error->code(), ErrorCode::file);
        EXPECT_EQ(error->where(), place.string());
    }
}

TEST_F(Writer, AFolderThatCannotBeWrittenIsRefusedAtOnce) {
    if (::geteuid() == 0) {
        GTEST_SKIP() << "root may write everywhere";
    }
    std::filesystem::permissions(folder_.path(),
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    const auto error = error_of([&] { const FrameWriter writer(options(), done_); });
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::file);
    EXPECT_EQ(error->where(), folder_.path().string());
}

TEST_F(Writer, AFullDiskIsATypedErrorAndLeavesNoTornFile) {
    const SmallFiles limit(100);
    FrameWriter writer(options(), done_);
    writer.submit(frame(0));
    const auto error = error_of([&] { writer.finish(); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::file);
    EXPECT_THAT(error->what(), testing::HasSubstr("0000."));
    EXPECT_TRUE(files_in(folder_.path()).empty()) << files_in(folder_.path()).front();
    EXPECT_TRUE(reports_.empty());
}

TEST_F(Writer, AnErrorReachesSubmitTooAndAgainEachTime) {
    const SmallFiles limit(100);
    FrameWriter writer(options(), done_);
    const auto error = error_of([&] {
        for (std::uint64_t i = 0; i < 1000; ++i) {
            writer.submit(frame(i));
        }
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::file);
    EXPECT_TRUE(error_of([&] { writer.finish(); }));
    EXPECT_TRUE(error_of([&] { writer.submit(frame(0)); }));
}

TEST_F(Writer, AFolderThatVanishesIsATypedError) {
    FrameWriter writer(options(), done_);
    writer.submit(frame(0));
    writer.finish();
    std::filesystem::remove_all(folder_.path());
    writer.submit(frame(1));
    const auto error = error_of([&] { writer.finish(); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::file);
}

TEST_F(Writer, AnExceptionOfTheReceiverReachesTheCaller) {
    FrameWriter writer(options(), [](FrameReport&&) { throw std::runtime_error("receiver"); });
    writer.submit(frame(0));
    EXPECT_THROW(writer.finish(), std::runtime_error);
}

TEST_F(Writer, NoMoreFramesWaitThanTheQueueHolds) {
    FrameWriterOptions wanted = options();
    wanted.queue = 2;
    std::promise<void> gate;
    std::shared_future<void> opened = gate.get_future().share();
    FrameWriter writer(wanted, [&](FrameReport&& report) {
        opened.wait();
        reports_.push_back(std::move(report));
    });
    std::atomic<int> submitted = 0;
    std::thread producer([&] {
        for (std::uint64_t i = 0; i < 8; ++i) {
            writer.submit(frame(i));
            ++submitted;
        }
    });
    // One in the writer's hands, two in the queue; the fourth submit() waits for the gate.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_LE(submitted, 3);
    gate.set_value();
    producer.join();
    writer.finish();
    ASSERT_EQ(reports_.size(), 8U);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(reports_[i].index, i);
    }
}

TEST_F(Writer, WhatIsQueuedIsWrittenWhenItGoes) {
    {
        FrameWriter writer(options(), done_);
        writer.submit(frame(0));
        writer.submit(frame(1));
    }
    EXPECT_EQ(reports_.size(), 2U);
}

TEST_F(Writer, TargetsWithNamesThatAreNoFileNamesStayInTheFolder) {
    CapturedFrame captured = frame(0);
    captured.targets[0].name = "../escape";
    FrameWriter writer(options(), done_);
    writer.submit(std::move(captured));
    (void)error_of([&] { writer.finish(); });
    EXPECT_FALSE(std::filesystem::exists(folder_.path().parent_path() / "escape.exr"));
}

}  // namespace
}  // namespace viscera::test
