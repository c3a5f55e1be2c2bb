#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/io/file_info.h"
#include "engine/io/volume.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

class RealVolume : public testing::Test {
  protected:
    void SetUp() override {
        if (folder_.empty() || !std::filesystem::is_directory(folder_)) {
            GTEST_SKIP() << "VISCERA_DATA_DIR names no folder with real data";
        }
    }
    [[nodiscard]] Volume load(const char* name) {
        Volume volume = load_volume(folder_ / name, {}, log_);
        EXPECT_TRUE(log_.faults().empty()) << name;
        EXPECT_EQ(volume.narrowing_error, 0.0) << name;
        return volume;
    }

    const std::filesystem::path folder_ = VISCERA_DATA_DIR;
    Log log_;
};

/// Mean place in the world of the voxels whose value passes.
glm::dvec3 centre_of(const Volume& volume, const std::function<bool(double)>& passes) {
    const glm::dmat4 to_world = volume.grid.index_to_world();
    glm::dvec3 sum{};
    double count = 0.0;
    const glm::ivec3 dims = volume.grid.dims;
    for (int k = 0; k < dims.z; k += 2) {
        for (int j = 0; j < dims.y; j += 2) {
            for (int i = 0; i < dims.x; i += 2) {
                if (passes(volume.value_of(volume.stored({i, j, k})))) {
                    sum += glm::dvec3(to_world * glm::dvec4(i, j, k, 1.0));
                    ++count;
                }
            }
        }
    }
    return sum / count;
}

glm::dvec3 middle_of(const VolumeGrid& grid) {
    return glm::dvec3(grid.texture_to_world() * glm::dvec4(0.5, 0.5, 0.5, 1.0));
}

TEST_F(RealVolume, ChestStandsUpright) {
    const Volume chest = load("volumes/LIDC2.mha");
    EXPECT_EQ(chest.grid.dims, glm::ivec3(256, 256, 133));
    EXPECT_EQ(chest.type, ScalarType::u8);
    EXPECT_NEAR(chest.grid.spacing_mm.z, 2.5, 1e-9);
    // j runs to the front, k to the feet.
    EXPECT_LT(glm::length(chest.grid.direction[1] - glm::dvec3(0, -1, 0)), 1e-9);
    EXPECT_LT(glm::length(chest.grid.direction[2] - glm::dvec3(0, 0, -1)), 1e-9);
    EXPECT_NEAR(chest.grid.origin_mm.z, 332.5, 1e-9);
    // The spine makes the back brighter than the front, and the shoulders' bones lie above the middle.
    EXPECT_GT(centre_of(chest, [](double v) { return v >= 200.0; }).y, middle_of(chest.grid).y - 20.0);
    const VolumeStatistics values = statistics(chest);
    EXPECT_EQ(values.min, 0.0);
    EXPECT_EQ(values.max, 255.0);
    EXPECT_NEAR(static_cast<double>(values.histogram[0]) / static_cast<double>(chest.voxels.size()), 0.836,
                5e-4);
}

TEST_F(RealVolume, AortaLiesWhereItsMeshDoes) {
    const Volume aorta = load("volumes/aorta.mha");
    EXPECT_EQ(aorta.type, ScalarType::f32);
    EXPECT_EQ(aorta.grid.dims, glm::ivec3(157, 393, 34));
    EXPECT_NEAR(statistics(aorta).max, 2570.2, 0.05);
    // The meshes are in RAS: x = 156.445 + 0.878906 i, y = 24.6094 + 0.878906 j, z = 1.50009 k.
    const glm::dvec4 place = aorta.grid.index_to_world() * glm::dvec4(10, 20, 30, 1);
    EXPECT_NEAR(-place.x, 156.445 + 0.878906 * 10, 1e-4);
    EXPECT_NEAR(-place.y, 24.6094 + 0.878906 * 20, 1e-4);
    EXPECT_NEAR(place.z, 1.50009 * 30, 1e-4);
}

TEST_F(RealVolume, BrainTemplateEndsInLps) {
    const Volume brain = load("volumes/MNI152_2009_template.nii.gz");
    EXPECT_EQ(brain.type, ScalarType::i16);
    EXPECT_EQ(brain.grid.dims, glm::ivec3(193, 229, 193));
    EXPECT_EQ(brain.grid.origin_mm, glm::dvec3(96.0, 132.0, -78.0));
    EXPECT_LT(glm::length(brain.grid.direction[0] - glm::dvec3(-1, 0, 0)), 1e-9);
    EXPECT_LT(glm::length(brain.grid.direction[1] - glm::dvec3(0, -1, 0)), 1e-9);
    EXPECT_EQ(statistics(brain).max, 1570.0);
    // The origin is the anterior commissure, below the middle of the brain.
    const glm::dvec3 centre = centre_of(brain, [](double v) { return v > 300.0; });
    EXPECT_NEAR(centre.x, 0.0, 2.0);
    EXPECT_GT(centre.z, 5.0);
    EXPECT_GT(centre.y, 5.0);
}

TEST_F(RealVolume, DicomSeriesIsSortedAndInHounsfieldUnits) {
    for (const char* name : {"volumes/dicom_head_phantom", "volumes/dicom_head_phantom/I100"}) {
        const Volume head = load(name);
        EXPECT_EQ(head.type, ScalarType::u16);
        EXPECT_EQ(head.unit, "HU");
        EXPECT_EQ(head.intercept, -1024.0);
        EXPECT_EQ(head.grid.dims, glm::ivec3(512, 512, 28));
        EXPECT_NEAR(head.grid.spacing_mm.x, 0.451171875, 1e-9);
        EXPECT_NEAR(head.grid.spacing_mm.z, 5.0, 1e-6);
        EXPECT_NEAR(head.grid.origin_mm.z, 696.21, 1e-6);
        EXPECT_LT(glm::length(head.grid.direction[2] - glm::dvec3(0, 0, 1)), 1e-9);
        const VolumeStatistics values = statistics(head);
        EXPECT_EQ(values.min, -1024.0);
        EXPECT_EQ(values.max, 782.0);
    }
}

TEST_F(RealVolume, LegacyVtk) {
    const Volume tooth = load("volumes/tooth_u16_vtk91_binary.vtk");
    EXPECT_EQ(tooth.type, ScalarType::u16);
    EXPECT_EQ(tooth.grid.dims, glm::ivec3(103, 94, 161));
    EXPECT_EQ(statistics(tooth).max, 1300.0);
    const Volume heart = load("volumes/heart.vtk");
    EXPECT_EQ(heart.type, ScalarType::f32);
    EXPECT_EQ(heart.grid.dims, glm::ivec3(32, 32, 12));
    EXPECT_EQ(heart.grid.spacing_mm, glm::dvec3(1.0, 1.0, 4.0));
    EXPECT_EQ(heart.stored({0, 0, 0}), 16.0);
    EXPECT_EQ(statistics(heart).max, 255.0);
}

void expect_upright_head(const Volume& head) {
    EXPECT_EQ(head.grid.dims, glm::ivec3(256, 256, 108));
    EXPECT_EQ(head.type, ScalarType::i16);
    EXPECT_EQ(head.unit, "HU");
    EXPECT_NEAR(head.grid.spacing_mm.x, 0.9570312, 1e-9);
    const VolumeStatistics values = statistics(head);
    EXPECT_EQ(values.min, -1024.0);
    EXPECT_EQ(values.max, 2986.0);
    // The scan begins below the nose and ends at the crown, and the bones of the face lie in front of the
    // vault's.
    const auto between = [&](double from, double to, double threshold) {
        const glm::dmat4 to_world = head.grid.index_to_world();
        glm::dvec4 sum{};
        for (int k = 0; k < head.grid.dims.z; ++k) {
            for (int j = 0; j < head.grid.dims.y; ++j) {
                for (int i = 0; i < head.grid.dims.x; ++i) {
                    const glm::dvec4 place = to_world * glm::dvec4(i, j, k, 1.0);
                    if (place.z >= from && place.z < to &&
                        head.value_of(head.stored({i, j, k})) > threshold) {
                        sum += place;
                    }
                }
            }
        }
        return sum;
    };
    constexpr double height_mm = 108 * 1.5;
    EXPECT_GT(between(0.0, 3.0, -300.0).w, 2.0 * between(height_mm - 4.0, height_mm, -300.0).w);
    const glm::dvec4 face = between(0.0, height_mm / 3.0, 226.0);
    const glm::dvec4 vault = between(height_mm * 2.0 / 3.0, height_mm, 226.0);
    EXPECT_LT(face.y / face.w, vault.y / vault.w - 5.0);
}

TEST_F(RealVolume, HeadFromItsProjectAndFromASidecar) {
    const Volume head = load("volumes/head_ct_cranium/main.plist");
    expect_upright_head(head);
    const test::TempFolder folder;
    const nlohmann::json sidecar = {
        {"file", (std::filesystem::absolute(folder_) / "volumes/head_ct_cranium/matrix.dat.gz").string()},
        {"dims", {256, 256, 108}},
        {"type", "i16"},
        {"spacing_mm", {0.9570312, 0.9570312, 1.5}},
        {"axes", "LAS"},
        {"unit", "HU"}};
    const Volume same = load_volume(folder.write("head.json", sidecar.dump()), {}, log_);
    expect_upright_head(same);
    EXPECT_EQ(same.grid, head.grid);
    EXPECT_EQ(same.voxels, head.voxels);
}

TEST_F(RealVolume, UltrasoundFramesAsTheyAreStored) {
    const Volume frames = load("ultrasound/UltrasonixCurvilinearBrightnessData.igs.mha");
    EXPECT_EQ(frames.grid.dims, glm::ivec3(3640, 96, 5));
    EXPECT_EQ(frames.type, ScalarType::u8);
    EXPECT_EQ(statistics(frames).max, 255.0);
}

TEST_F(RealVolume, DescriptionSaysWhatTheVolumeIs) {
    const nlohmann::json info = describe(folder_ / "volumes/dicom_head_phantom");
    EXPECT_EQ(info["kind"], "volume");
    const nlohmann::json& volume = info["volume"];
    EXPECT_EQ(volume["dims"], nlohmann::json({512, 512, 28}));
    EXPECT_EQ(volume["type"], "u16");
    EXPECT_EQ(volume["unit"], "HU");
    EXPECT_EQ(volume["channels"][0]["min"], -1024.0);
    EXPECT_EQ(volume["channels"][0]["non_finite"], 0);
    EXPECT_EQ(volume["channels"][0]["histogram"].size(), 32U);
    EXPECT_EQ(describe(folder_ / "volumes/heart.vtk")["kind"], "volume");
}

TEST_F(RealVolume, RealFilesSurviveBeingCutOff) {
    for (const char* name : {"volumes/LIDC2.mha", "volumes/MNI152_2009_template.nii.gz",
                             "volumes/dicom_head_phantom/I10", "volumes/tooth_u16_vtk91_binary.vtk"}) {
        const std::string bytes = test::slurp(folder_ / name);
        const test::TempFolder folder;
        for (const std::size_t size : {bytes.size() / 1000, bytes.size() / 2, bytes.size() - 20}) {
            const auto file =
                folder.write(std::filesystem::path(name).filename().string(), bytes.substr(0, size));
            try {
                static_cast<void>(load_volume(file, {}, log_));
                ADD_FAILURE() << name << " cut to " << size << " bytes is taken";
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::file) << error.what();
                EXPECT_EQ(error.where(), file.string());
            }
        }
    }
}

}  // namespace
}  // namespace viscera::io
