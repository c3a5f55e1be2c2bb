#include "effects/tissue/saved_energy.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "engine/io/exr.h"
#include "tests/tissue/energy_stage.h"

namespace viscera::test {
namespace {

/// What `viscera render --dump` wrote once more while the program runs: same path, size and time.
TEST(SavedEnergy, AFileThatIsWrittenAnewIsReadAnew) {
    const auto file = process_folder() / "anew.exr";
    const auto save = [&](float value) {
        io::ExrPart part{.name = "tissue.energy", .image = make_image(128, 128, PixelFormat::r32f)};
        part.image.set(40, 50, 0, value);
        io::write_exr(file, std::span(&part, 1), io::ExrCompression::none);
    };
    const nlohmann::json load{{"load", {{"file", file.string()}, {"time_s", 0.0}}}};
    save(0.25F);
    EnergyStage stage(load);
    stage.frame(0.0);
    EXPECT_EQ(stage.energy().at(40, 50, 0), 0.25F);
    const auto written = std::filesystem::last_write_time(file);
    save(0.75F);
    std::filesystem::last_write_time(file, written + std::chrono::seconds(1));
    stage.frame(0.1);
    EXPECT_EQ(stage.energy().at(40, 50, 0), 0.25F) << "frames look at no files";
    stage.stage.load(EnergyStage::scene(load));
    stage.frame(0.0);
    EXPECT_EQ(stage.energy().at(40, 50, 0), 0.75F);
}

}  // namespace
}  // namespace viscera::test
