#include <array>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/io/file_info.h"
#include "engine/io/volume.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class VolumeShapeKeys : public testing::Test {
  protected:
    static Volume make(const VolumeShape& shape, const glm::ivec3& dims = {4, 3, 2}) {
        Volume volume{.grid = {.dims = dims, .spacing_mm = {0.5, 2.0, 3.0}, .origin_mm = {7, -8, 9}},
                      .type = ScalarType::u8,
                      .voxels = {}};
        volume.grid.direction = glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1});
        volume.grid.shape = shape;
        for (std::size_t i = 0; i < volume.grid.voxel_count(); ++i) {
            volume.voxels.push_back(static_cast<std::byte>(i));
        }
        return volume;
    }
    static VolumeShape cylinder() {
        return {.kind = VolumeKind::cylindrical,
                .r_min_mm = 0.35,
                .r_max_mm = 4.1,
                .first_angle_rad = glm::radians(-37.5),
                .angle_rad = glm::radians(360.0),
                .wrap = true,
                .height_mm = 25.0};
    }
    static VolumeShape sphere() {
        return {.kind = VolumeKind::spherical,
                .r_min_mm = 0.0,
                .r_max_mm = 120.0,
                .first_angle_rad = -0.7,  // no whole number of degrees
                .angle_rad = 1.4,
                .latitude_rad = glm::radians(70.0)};
    }
    [[nodiscard]] Volume load(const std::filesystem::path& file, const io::VolumeOptions& options = {}) {
        return io::load_volume(file, options, log_);
    }
    /// A small file with more lines in its header.
    [[nodiscard]] std::filesystem::path with_keys(const std::string& lines) const {
        return folder_.write(
            "keys.nrrd",
            "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
            "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
            "encoding: raw\n" +
                lines + "\n12345678");
    }

    TempFolder folder_;
    Log log_;
};

TEST_F(VolumeShapeKeys, WrittenFilesReadBackTheSame) {
    for (const VolumeShape& shape : {cylinder(), sphere()}) {
        const Volume volume = make(shape);
        io::write_volume(volume, folder_ / "a.nrrd");
        const Volume back = load(folder_ / "a.nrrd");
        EXPECT_EQ(back.grid.shape, shape);
        EXPECT_EQ(back.grid.dims, volume.grid.dims);
        EXPECT_EQ(back.grid.origin_mm, volume.grid.origin_mm);
        EXPECT_EQ(back.grid.direction, volume.grid.direction);
        EXPECT_EQ(back.voxels, volume.voxels);
        for (const glm::dvec3 index : {glm::dvec3(0), glm::dvec3(3, 2, 1), glm::dvec3(1.5, 0.25, 0.75)}) {
            EXPECT_EQ(back.grid.world_of_index(index), volume.grid.world_of_index(index));
        }
    }
}

TEST_F(VolumeShapeKeys, FilesSayThemInDegreesAndMillimetres) {
    io::write_volume(make(cylinder()), folder_ / "a.nrrd");
    const std::string text = slurp(folder_ / "a.nrrd");
    for (const char* line :
         {"\nviscera_geometry:=cylindrical\n", "\nviscera_r_min_mm:=0.35\n", "\nviscera_r_max_mm:=4.1\n",
          "\nviscera_first_angle_deg:=-37.5\n", "\nviscera_angle_deg:=360\n", "\nviscera_height_mm:=25\n",
          "\nviscera_wrap:=true\n"}) {
        EXPECT_THAT(text, HasSubstr(line));
    }
    EXPECT_THAT(text, Not(HasSubstr("latitude")));
    io::write_volume(make({}), folder_ / "b.nrrd");
    EXPECT_THAT(slurp(folder_ / "b.nrrd"), Not(HasSubstr("viscera_")));
    EXPECT_FALSE(load(folder_ / "b.nrrd").grid.curvilinear());
}

TEST_F(VolumeShapeKeys, WhatIsLeftOutHasADefault) {
    const VolumeGrid grid =
        load(with_keys("viscera_geometry:=spherical\nviscera_r_max_mm:=5\nviscera_angle_deg:=90\n"
                       "viscera_latitude_deg:=30\nother_programs_key:=7\n"))
            .grid;
    EXPECT_EQ(grid.shape, (VolumeShape{.kind = VolumeKind::spherical,
                                       .r_max_mm = 5.0,
                                       .angle_rad = glm::radians(90.0),
                                       .latitude_rad = glm::radians(30.0)}));
    EXPECT_FALSE(load(with_keys("viscera_geometry:=cartesian\n")).grid.curvilinear());
}

TEST_F(VolumeShapeKeys, WhatDoesNotHoldIsRefusedByNameOfFileAndKey) {
    const std::string good =
        "viscera_geometry:=cylindrical\nviscera_r_max_mm:=5\nviscera_angle_deg:=90\nviscera_height_mm:=3\n";
    EXPECT_TRUE(load(with_keys(good)).grid.curvilinear());
    struct Bad {
        std::string lines;
        const char* said;
    };
    const std::array bad{
        Bad{"viscera_geometry:=conical\n", "viscera_geometry: 'conical' is none of"},
        Bad{"viscera_geometry:=\n", "viscera_geometry: '' is none of"},
        Bad{"viscera_geometry:=cylindrical\n", "viscera_r_max_mm is missing"},
        Bad{"viscera_geometry:=cylindrical\nviscera_r_max_mm:=5\nviscera_angle_deg:=90\n",
            "viscera_height_mm is missing"},
        Bad{"viscera_geometry:=spherical\nviscera_r_max_mm:=5\nviscera_angle_deg:=90\n",
            "viscera_latitude_deg is missing"},
        Bad{"viscera_r_max_mm:=5\n", "viscera_r_max_mm needs viscera_geometry"},
        Bad{"viscera_geometry:=cartesian\nviscera_wrap:=true\n", "viscera_wrap does not belong"},
        Bad{good + "viscera_latitude_deg:=5\n", "viscera_latitude_deg does not belong"},
        Bad{good + "viscera_rmin_mm:=5\n", "viscera_rmin_mm is no key of a geometry"},
        Bad{good + "viscera_r_min_mm:=6\n", "viscera_r_max_mm is less than viscera_r_min_mm"},
        Bad{good + "viscera_r_min_mm:=-1\n", "viscera_r_min_mm: '-1' is not between 0 and"},
        Bad{good + "viscera_r_min_mm:=nan\n", "viscera_r_min_mm"},
        Bad{good + "viscera_r_min_mm:=\n", "viscera_r_min_mm is missing"},
        Bad{good + "viscera_r_min_mm:=1 2\n", "viscera_r_min_mm: '1 2' is not one number"},
        Bad{good + "viscera_r_min_mm:=1mm\n", "viscera_r_min_mm: '1mm' is no number"},
        Bad{good + "viscera_angle_deg:=361\n", "viscera_angle_deg: '361' is not between 0 and 360"},
        Bad{good + "viscera_first_angle_deg:=-1000\n", "viscera_first_angle_deg"},
        Bad{good + "viscera_wrap:=yes\n", "viscera_wrap: 'yes' is neither true nor false"},
        Bad{good + "viscera_wrap:=true\n", "viscera_wrap needs a viscera_angle_deg of 360"}};
    for (const Bad& one : bad) {
        const std::filesystem::path file = with_keys(one.lines);
        try {
            static_cast<void>(load(file));
            ADD_FAILURE() << one.lines;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_EQ(error.where(), file.string());
            EXPECT_THAT(error.what(), HasSubstr(one.said));
        }
    }
}

TEST_F(VolumeShapeKeys, FormatsThatCannotHoldThemAreNotWritten) {
    for (const char* name : {"a.mha", "a.nii.gz"}) {
        try {
            io::write_volume(make(sphere()), folder_ / name);
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_THAT(error.what(), HasSubstr("spherical is written as .nrrd"));
        }
        EXPECT_FALSE(std::filesystem::exists(folder_ / name));
    }
}

TEST_F(VolumeShapeKeys, InfoTellsThem) {
    io::write_volume(make(cylinder()), folder_ / "a.nrrd");
    const nlohmann::json told = io::describe(folder_ / "a.nrrd").at("volume").at("geometry");
    EXPECT_EQ(told, nlohmann::json::parse(R"({"kind": "cylindrical", "r_min_mm": 0.35, "r_max_mm": 4.1,
                                              "first_angle_deg": -37.5, "angle_deg": 360.0, "wrap": true,
                                              "height_mm": 25.0})"));
    io::write_volume(make({}), folder_ / "b.nrrd");
    EXPECT_FALSE(io::describe(folder_ / "b.nrrd").at("volume").contains("geometry"));
}

TEST_F(VolumeShapeKeys, ReducedFilesAreWhatReducedVolumesAre) {
    const Volume volume = make(cylinder(), {9, 13, 6});
    io::write_volume(volume, folder_ / "a.nrrd");
    for (const int factor : {2, 3}) {
        const Volume due = reduced(volume, factor);
        const Volume back = load(folder_ / "a.nrrd", {.reduce = factor});
        EXPECT_EQ(back.grid.shape, volume.grid.shape);
        EXPECT_EQ(back.grid.dims, due.grid.dims);
        EXPECT_EQ(back.voxels, due.voxels);
    }
}

TEST_F(VolumeShapeKeys, AGeometryGivenFromOutsideComesBeforeVoxelsAreReduced) {
    const Volume plain = make({}, {9, 13, 6});
    io::write_volume(plain, folder_ / "a.mha");
    Volume due = plain;
    due.grid.shape = cylinder();
    const auto regrid = [](VolumeGrid grid) {
        grid.shape = cylinder();
        return grid;
    };
    EXPECT_EQ(load(folder_ / "a.mha", {.reduce = 2, .regrid = regrid}).voxels, reduced(due, 2).voxels);
    const auto wrong = [](VolumeGrid grid) {
        grid.shape = cylinder();
        grid.shape.r_max_mm = -1.0;
        return grid;
    };
    EXPECT_THROW(static_cast<void>(load(folder_ / "a.mha", {.regrid = wrong})), Error);
}

TEST_F(VolumeShapeKeys, NoReductionIsOfferedThatWouldNotFit) {
    io::write_volume(make(sphere(), {20, 20, 20}), folder_ / "curved.nrrd");
    io::write_volume(make({}, {20, 20, 20}), folder_ / "box.nrrd");
    const auto said = [&](const char* name) -> std::string {
        try {
            static_cast<void>(load(folder_ / name, {.memory_limit = 4000}));
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::limit);
            return error.what();
        }
        return "";
    };
    EXPECT_THAT(said("box.nrrd"), HasSubstr("reduce = 2 would do"));
    EXPECT_THAT(said("curved.nrrd"), HasSubstr("no reduction makes it fit"));
}

}  // namespace
}  // namespace viscera::test
