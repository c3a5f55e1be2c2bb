#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/io/file_info.h"
#include "engine/io/png.h"
#include "engine/io/volume.h"
#include "tests/io/temp_folder.h"
#include "tests/io/volume_files.h"

namespace viscera::io {
namespace {

using test::TempFolder;

/// The ramp of 4 x 3 x 2 voxels at (10, 20, 30) with spacing 0.5, 0.75 and 2 mm, in the axes of the world.
void expect_ramp(const Volume& volume, ScalarType type) {
    EXPECT_EQ(volume.grid.dims, glm::ivec3(4, 3, 2));
    EXPECT_EQ(volume.grid.spacing_mm, glm::dvec3(0.5, 0.75, 2.0));
    EXPECT_EQ(volume.grid.origin_mm, glm::dvec3(10.0, 20.0, 30.0));
    EXPECT_EQ(volume.grid.direction, glm::dmat3(1.0));
    EXPECT_EQ(volume.type, type);
    ASSERT_EQ(volume.channels, 1);
    ASSERT_NO_THROW(volume.validate());
    for (int i = 0; i < 24; ++i) {
        EXPECT_EQ(volume.stored({i % 4, i / 4 % 3, i / 12}), i);
    }
}

class VolumeFormat : public testing::Test {
  protected:
    [[nodiscard]] Volume load(std::string_view name, const VolumeOptions& options = {}) {
        return load_volume(folder_ / name, options, log_);
    }
    [[nodiscard]] Volume load_bytes(std::string_view name, std::string_view bytes,
                                    const VolumeOptions& options = {}) {
        return load_volume(folder_.write(name, bytes), options, log_);
    }
    void expect_error(std::string_view name, std::string_view bytes, std::string_view words) {
        const std::filesystem::path file = folder_.write(name, bytes);
        try {
            static_cast<void>(load_volume(file, {}, log_));
            ADD_FAILURE() << name << " is taken: " << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_EQ(error.where(), file.string());
            EXPECT_NE(error.message().find(words), std::string_view::npos) << error.what();
        }
    }

    void put(std::string_view name, std::string_view bytes) const {
        static_cast<void>(folder_.write(name, bytes));
    }

    TempFolder folder_;
    std::vector<std::string> messages_;
    Log log_{[this](LogLevel, std::string_view message) { messages_.emplace_back(message); }};
};

TEST_F(VolumeFormat, NrrdOfEveryType) {
    expect_ramp(load_bytes("a.nrrd", test::nrrd("uchar", "raw", test::bytes_of(test::ramp<std::uint8_t>()))),
                ScalarType::u8);
    expect_ramp(load_bytes("a.nrrd", test::nrrd("int8", "raw", test::bytes_of(test::ramp<std::int8_t>()))),
                ScalarType::i8);
    expect_ramp(
        load_bytes("a.nrrd", test::nrrd("ushort", "gzip",
                                        test::deflated(test::bytes_of(test::ramp<std::uint16_t>()), 31))),
        ScalarType::u16);
    expect_ramp(load_bytes("a.nrrd", test::nrrd("short", "ascii", test::ramp_text<int>())), ScalarType::i16);
    expect_ramp(load_bytes("a.nrrd", test::nrrd("float", "raw", test::bytes_of(test::ramp<float>()))),
                ScalarType::f32);
    for (const char* type : {"int", "uint32"}) {
        expect_ramp(load_bytes("a.nrrd", test::nrrd(type, "raw", test::bytes_of(test::ramp<std::int32_t>()))),
                    ScalarType::f32);
    }
    expect_ramp(load_bytes("a.nrrd", test::nrrd("double", "raw", test::bytes_of(test::ramp<double>()))),
                ScalarType::f32);
}

TEST_F(VolumeFormat, NrrdSpacesEndInLps) {
    const std::string voxels = test::bytes_of(test::ramp<std::uint8_t>());
    const Volume ras = load_bytes("a.nrrd", test::nrrd("uchar", "raw", voxels, "right-anterior-superior"));
    EXPECT_EQ(ras.grid.origin_mm, glm::dvec3(-10.0, -20.0, 30.0));
    EXPECT_EQ(ras.grid.direction, glm::dmat3({-1, 0, 0}, {0, -1, 0}, {0, 0, 1}));
    const Volume las = load_bytes("a.nrrd", test::nrrd("uchar", "raw", voxels, "LAS"));
    EXPECT_EQ(las.grid.origin_mm, glm::dvec3(10.0, -20.0, 30.0));
    EXPECT_EQ(las.grid.direction, glm::dmat3({1, 0, 0}, {0, -1, 0}, {0, 0, 1}));
}

TEST_F(VolumeFormat, NrrdLengthsInOtherUnitsBecomeMillimetres) {
    const std::string voxels = test::bytes_of(test::ramp<std::uint8_t>());
    const auto with = [&](std::string_view units) {
        return load_bytes("a.nrrd", test::nrrd("uchar", "raw", voxels, "left-posterior-superior",
                                               "space units: " + std::string(units) + "\n"));
    };
    expect_ramp(with(R"("mm" "mm" "mm")"), ScalarType::u8);
    EXPECT_TRUE(messages_.empty());
    const Volume metres = with(R"("m" "m" "m")");
    EXPECT_EQ(metres.grid.spacing_mm, glm::dvec3(500.0, 750.0, 2000.0));
    EXPECT_EQ(metres.grid.origin_mm, glm::dvec3(1e4, 2e4, 3e4));
    EXPECT_EQ(with(R"("Micron" "um" "um")").grid.spacing_mm, glm::dvec3(0.5, 0.75, 2.0) * 1e-3);
    const Volume plain = load_bytes("b.nrrd",
                                    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\n"
                                    "spacings: 1 2 3\nunits: \"cm\" \"cm\" \"cm\"\n"
                                    "encoding: raw\n\n" +
                                        voxels);
    EXPECT_EQ(plain.grid.spacing_mm, glm::dvec3(10.0, 20.0, 30.0));
    EXPECT_TRUE(messages_.empty());
    expect_ramp(with(R"("furlong" "mm" "mm")"), ScalarType::u8);
    expect_ramp(with(R"("m" "mm" "mm")"), ScalarType::u8);
    ASSERT_EQ(messages_.size(), 2U);
    EXPECT_NE(messages_[0].find("furlong"), std::string::npos) << messages_[0];
    // A description of the file says so, too.
    std::vector<std::string> told;
    const auto tell = [&](LogLevel, std::string_view message) { told.emplace_back(message); };
    EXPECT_EQ(describe(folder_ / "a.nrrd", tell)["kind"], "volume");
    EXPECT_EQ(told, std::vector{messages_[1]});
}

TEST_F(VolumeFormat, NrrdDetachedSkippedAndWithKeys) {
    const auto payload = folder_.write("a.raw", "two\nlines\n" + test::bytes_of(test::ramp<std::int16_t>()));
    const Volume volume = load_bytes(
        "a.nhdr",
        test::nrrd("short", "raw", "", "left-posterior-superior",
                   "line skip: 2\ndata file: a.raw\nrescale_slope:=2\nrescale_intercept:=-5\nunit:=HU\n"));
    expect_ramp(volume, ScalarType::i16);
    EXPECT_EQ(volume.slope, 2.0);
    EXPECT_EQ(volume.intercept, -5.0);
    EXPECT_EQ(volume.unit, "HU");
    expect_ramp(load_bytes("a.nhdr", test::nrrd("short", "raw", "", "left-posterior-superior",
                                                "byte skip: -1\ndata file: a.raw\n")),
                ScalarType::i16);
}

TEST_F(VolumeFormat, MetaImageHonoursItsMatrix) {
    const std::string voxels = test::bytes_of(test::ramp<std::uint16_t>());
    const auto expect = [](const Volume& volume) {
        EXPECT_EQ(volume.type, ScalarType::u16);
        EXPECT_EQ(volume.grid.direction, glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}));
        EXPECT_EQ(volume.grid.origin_mm, glm::dvec3(10.0, 20.0, 30.0));
        EXPECT_EQ(volume.grid.spacing_mm, glm::dvec3(0.5, 0.75, 2.0));
        EXPECT_EQ(volume.stored({3, 2, 1}), 23.0);
    };
    expect(load_bytes("a.mha", test::mha("MET_USHORT", voxels)));
    const std::string packed = test::deflated(voxels, 15);
    expect(load_bytes("b.mha", test::mha("MET_USHORT", packed,
                                         "CompressedData = True\nCompressedDataSize = " +
                                             std::to_string(packed.size()) + "\n")));
    put("c.raw", "head" + voxels);
    std::string header = test::mha("MET_USHORT", "", "HeaderSize = -1\n");
    header.replace(header.find("LOCAL"), 5, "c.raw");
    expect(load_bytes("c.mhd", header));
    EXPECT_TRUE(messages_.empty());
    static_cast<void>(load_bytes("d.mha", test::mha("MET_USHORT", voxels, "AnatomicalOrientation = RAI\n")));
    ASSERT_EQ(messages_.size(), 1U);
    EXPECT_NE(messages_[0].find("AnatomicalOrientation"), std::string::npos);
}

TEST_F(VolumeFormat, LegacyVtkTextAndBigEndian) {
    expect_ramp(load_bytes("a.vtk", test::legacy_vtk("ASCII", "float", test::ramp_text<int>())),
                ScalarType::f32);
    expect_ramp(load_bytes("a.vtk", test::legacy_vtk("ASCII", "unsigned_char", test::ramp_text<int>("\n"))),
                ScalarType::u8);
    const auto binary = [this](const char* type, const std::string& voxels, ScalarType kept) {
        expect_ramp(load_bytes("b.vtk", test::legacy_vtk("BINARY", type, voxels)), kept);
    };
    binary("unsigned_char", test::big_endian(test::ramp<std::uint8_t>()), ScalarType::u8);
    binary("char", test::big_endian(test::ramp<std::int8_t>()), ScalarType::i8);
    binary("unsigned_short", test::big_endian(test::ramp<std::uint16_t>()), ScalarType::u16);
    binary("short", test::big_endian(test::ramp<std::int16_t>()), ScalarType::i16);
    binary("unsigned_int", test::big_endian(test::ramp<std::uint32_t>()), ScalarType::f32);
    binary("int", test::big_endian(test::ramp<std::int32_t>()), ScalarType::f32);
    binary("unsigned_long", test::big_endian(test::ramp<std::uint64_t>()), ScalarType::f32);
    binary("long", test::big_endian(test::ramp<std::int64_t>()), ScalarType::f32);
    binary("float", test::big_endian(test::ramp<float>()), ScalarType::f32);
    binary("double", test::big_endian(test::ramp<double>()), ScalarType::f32);
}

TEST_F(VolumeFormat, VtiHoweverItsArrayIsStored) {
    const std::string voxels = test::bytes_of(test::ramp<std::uint16_t>());
    const auto array = [](std::string_view how, std::string_view inside) {
        return "<DataArray type=\"UInt16\" Name=\"density\" " + std::string(how) + ">" + std::string(inside) +
               "</DataArray>";
    };
    const std::string plain = test::bytes_of(std::uint32_t{48}) + voxels;
    expect_ramp(load_bytes("a.vti", test::vti(array("format=\"ascii\"", test::ramp_text<int>()))),
                ScalarType::u16);
    expect_ramp(load_bytes("b.vti", test::vti(array("format=\"binary\"", test::base64(plain)))),
                ScalarType::u16);
    const std::string wide = test::bytes_of(std::uint64_t{48}) + voxels;
    expect_ramp(
        load_bytes("c.vti", test::vti(array("format=\"appended\" offset=\"0\"", ""), "header_type=\"UInt64\"",
                                      "<AppendedData encoding=\"raw\">_" + wide + "</AppendedData>")),
        ScalarType::u16);
    expect_ramp(load_bytes("d.vti", test::vti(array("format=\"appended\" offset=\"0\"", ""), "",
                                              "<AppendedData encoding=\"base64\">_" + test::base64(plain) +
                                                  "</AppendedData>")),
                ScalarType::u16);
    const std::string packed = test::deflated(voxels, 15);
    const std::string head =
        test::bytes_of(std::vector<std::uint32_t>{1, 48, 0, static_cast<std::uint32_t>(packed.size())});
    expect_ramp(
        load_bytes("e.vti", test::vti(array("format=\"binary\"", test::base64(head) + test::base64(packed)),
                                      "compressor=\"vtkZLibDataCompressor\"")),
        ScalarType::u16);
    const std::string big =
        test::big_endian(std::vector<std::uint32_t>{48}) + test::big_endian(test::ramp<std::uint16_t>());
    expect_ramp(load_bytes("f.vti", test::vti(array("format=\"binary\"", test::base64(big)),
                                              "byte_order=\"BigEndian\"")),
                ScalarType::u16);
}

TEST_F(VolumeFormat, VtiDirectionIsByRows) {
    const Volume volume =
        load_bytes("a.vti", test::vti(R"(<DataArray type="UInt8" Name="density" format="ascii">)" +
                                          test::ramp_text<int>() + "</DataArray>",
                                      "", "", R"(Direction="0 -1 0 1 0 0 0 0 1")"));
    EXPECT_EQ(volume.grid.direction, glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}));
}

TEST_F(VolumeFormat, CsvFindsTheGrid) {
    Volume volume = load_bytes("a.csv", test::csv());
    EXPECT_NEAR(volume.grid.spacing_mm.y, 0.75, 1e-12);
    volume.grid.spacing_mm.y = 0.75;
    expect_ramp(volume, ScalarType::f32);
    std::string text = test::csv();
    text.erase(text.find("10.500000,20.750000,30"), 31);
    expect_error("b.csv", text, "missing");
    expect_error("c.csv", test::csv() + "10,20,30,5\n", "line 26");
    expect_error("d.csv", test::csv() + "10,20,thirty,5\n", "line 26");
    expect_error("e.csv", "", "no points");
}

TEST_F(VolumeFormat, RawWithSidecar) {
    put("a.raw", "skip" + test::big_endian(test::ramp<std::int16_t>()));
    const Volume volume = load_bytes(
        "a.json", R"({"file":"a.raw","dims":[4,3,2],"type":"i16","byte_order":"big","offset":4,"axes":"RSA",
        "spacing_mm":[0.5,0.75,2],"origin_mm":[10,20,30],"slope":2,"intercept":-1000,"unit":"HU"})");
    EXPECT_EQ(volume.grid.direction, glm::dmat3({-1, 0, 0}, {0, 0, 1}, {0, -1, 0}));
    EXPECT_EQ(volume.value_of(volume.stored({3, 2, 1})), -954.0);
    EXPECT_EQ(volume.unit, "HU");
    put("b.raw.gz", test::deflated(test::bytes_of(test::ramp<float>()), 31));
    expect_ramp(load_bytes("b.json", R"({"file":"b.raw.gz","dims":[4,3,2],"type":"f32",
        "direction":[[1,0,0],[0,1,0],[0,0,1]],"spacing_mm":[0.5,0.75,2],"origin_mm":[10,20,30]})"),
                ScalarType::f32);
    expect_error("c.json", R"({"file":"a.raw","dims":[4,3,2],"type":"i16"})", "bytes");
    expect_error("d.json", R"({"file":"none.raw","dims":[4,3,2],"type":"i16"})", "none.raw");
    expect_error("e.json", R"({"file":"a.raw","dims":[4,3],"type":"i16"})", "dims");
    expect_error("f.json", R"({"file":"a.raw","dims":[4,3,2],"type":"i16","offset":4,"axes":"LRS"})", "axes");
    expect_error("g.json", R"({"file":"a.raw","dims":[4,3,2],"type":"i16","size":4})", "size");
    expect_error("h.json", R"({"file":"a.raw","dims":[4,3,2],"type":"i16","offset":4,"spacing_mm":[1,0,1]})",
                 "spacing");
}

TEST_F(VolumeFormat, SlicesInNaturalOrderTopRowFirst) {
    for (const int n : {1, 2, 10}) {
        Image image = make_image(3, 2, PixelFormat::r8);
        for (int i = 0; i < 6; ++i) {
            image.set(i % 3, i / 3, 0, static_cast<float>(10 * n + i) / 255.0F);
        }
        write_png(folder_ / ("s" + std::to_string(n) + ".png"), image);
    }
    const Volume volume = load_volume(folder_.path(), {}, log_);
    EXPECT_EQ(volume.grid.dims, glm::ivec3(3, 2, 3));
    EXPECT_EQ(volume.type, ScalarType::u8);
    EXPECT_EQ(volume.stored({0, 1, 0}), 10.0);  // Image keeps the bottom row first
    EXPECT_EQ(volume.stored({0, 0, 1}), 23.0);
    EXPECT_EQ(volume.stored({2, 0, 2}), 105.0);
}

TEST_F(VolumeFormat, SlicesOfColourGreyAndSixteenBits) {
    Image image = make_image(2, 2, PixelFormat::rgba8);
    for (int c = 0; c < 3; ++c) {
        image.set(1, 1, c, 200.0F / 255.0F);
    }
    const TempFolder grey;
    write_png(grey / "a.png", image);
    write_png(grey / "b.png", image);
    EXPECT_EQ(load_volume(grey.path(), {}, log_).channels, 1);
    image.set(0, 0, 1, 1.0F);
    write_png(grey / "c.png", image);
    const Volume colour = load_volume(grey.path(), {}, log_);
    EXPECT_EQ(colour.channels, 3);
    EXPECT_EQ(colour.stored({0, 1, 2}, 1), 255.0);

    Image deep = make_image(2, 1, PixelFormat::r32f);
    deep.set(0, 0, 0, 12345.0F / 65535.0F);
    const TempFolder wide;
    write_png(wide / "a.png", deep, {.sixteen_bit = true});
    const Volume sixteen = load_volume(wide.path(), {}, log_);
    EXPECT_EQ(sixteen.type, ScalarType::u16);
    EXPECT_EQ(sixteen.stored({0, 0, 0}), 12345.0);
}

TEST_F(VolumeFormat, NarrowingIsReportedAndNonFiniteCounted) {
    std::vector<double> values = test::ramp<double>();
    values[1] = 0.1;
    values[2] = std::numeric_limits<double>::quiet_NaN();
    values[3] = std::numeric_limits<double>::infinity();
    const Volume volume = load_bytes("a.nrrd", test::nrrd("double", "raw", test::bytes_of(values)));
    EXPECT_DOUBLE_EQ(volume.narrowing_error, std::abs(0.1 - static_cast<double>(0.1F)));
    EXPECT_TRUE(std::isnan(volume.stored({2, 0, 0})));
    EXPECT_EQ(log_.faults().at("volume.non_finite"), 2U);
    std::vector<std::int64_t> large(24, 0);
    large[5] = (std::int64_t{1} << 62U) + 1;
    EXPECT_EQ(load_bytes("b.nrrd", test::nrrd("int64", "raw", test::bytes_of(large))).narrowing_error, 1.0);
}

TEST_F(VolumeFormat, ReducedWhileReadingIsTheSameAsAfter) {
    std::vector<std::int16_t> values(61 * 47 * 33);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<std::int16_t>(i * 7919 % 4001);
    }
    const std::string file =
        "ObjectType = Image\nNDims = 3\nDimSize = 61 47 33\nElementType = MET_SHORT\nElementDataFile = "
        "LOCAL\n" +
        test::bytes_of(values);
    const Volume whole = load_bytes("a.mha", file);
    for (const bool labels : {false, true}) {
        const Volume part = load("a.mha", {.reduce = 4, .labels = labels});
        const Volume due = reduced(whole, 4, labels);
        EXPECT_EQ(part.grid, due.grid);
        EXPECT_EQ(part.voxels, due.voxels);
    }
}

TEST_F(VolumeFormat, MemoryLimitSaysWhatWouldDo) {
    const std::string file =
        "ObjectType = Image\nNDims = 3\nDimSize = 256 256 64\nElementType = MET_UCHAR\n"
        "ElementDataFile = LOCAL\n" +
        std::string(std::size_t{256} * 256 * 64, 'x');
    put("a.mha", file);
    VolumeOptions options{.memory_limit = 1U << 20U};
    try {
        static_cast<void>(load("a.mha", options));
        FAIL() << "limit ignored";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::limit);
        const std::string_view text = error.message();
        EXPECT_NE(text.find("4 MiB"), std::string_view::npos) << text;
        EXPECT_NE(text.find("1 MiB"), std::string_view::npos) << text;
        const std::size_t at = text.find("reduce = ");
        ASSERT_NE(at, std::string_view::npos) << text;
        options.reduce = std::stoi(std::string(text.substr(at + 9)));
    }
    EXPECT_NO_THROW(static_cast<void>(load("a.mha", options)));
}

TEST_F(VolumeFormat, ProgressRisesAndCancels) {
    put("a.nrrd", test::nrrd("uchar", "raw", test::bytes_of(test::ramp<std::uint8_t>())));
    std::vector<double> fractions;
    static_cast<void>(load("a.nrrd", {.progress = [&](double fraction) {
                               fractions.push_back(fraction);
                               return true;
                           }}));
    ASSERT_GE(fractions.size(), 2U);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1.0);
    try {
        static_cast<void>(load("a.nrrd", {.progress = [](double) { return false; }}));
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_EQ(error.message(), "cancelled");
    }
}

TEST_F(VolumeFormat, WrittenFilesReadBackTheSame) {
    Volume volume{.type = ScalarType::i16, .slope = 0.5, .intercept = -1024.0, .unit = "HU"};
    volume.grid = {.dims = {4, 3, 2}, .spacing_mm = {0.5, 0.75, 2.0}, .origin_mm = {10.0, -20.0, 30.0}};
    volume.grid.direction = glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0.6, 0.8});  // sheared
    const std::string voxels = test::bytes_of(test::ramp<std::int16_t>());
    volume.voxels.assign(reinterpret_cast<const std::byte*>(voxels.data()),
                         reinterpret_cast<const std::byte*>(voxels.data() + voxels.size()));
    for (const char* name : {"a.nrrd", "a.mha", "a.nii.gz"}) {
        write_volume(volume, folder_ / name);
        const Volume back = load(name);
        EXPECT_EQ(back.grid.dims, volume.grid.dims) << name;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LT(glm::length(back.grid.direction[axis] - volume.grid.direction[axis]), 1e-6) << name;
            EXPECT_NEAR(back.grid.spacing_mm[axis], volume.grid.spacing_mm[axis], 1e-6) << name;
            EXPECT_NEAR(back.grid.origin_mm[axis], volume.grid.origin_mm[axis], 1e-5) << name;
        }
        EXPECT_EQ(back.type, volume.type) << name;
        EXPECT_EQ(back.slope, 0.5) << name;
        EXPECT_EQ(back.intercept, -1024.0) << name;
        EXPECT_EQ(back.voxels, volume.voxels) << name;
        EXPECT_EQ(back.unit, std::string_view(name) == "a.nii.gz" ? "" : "HU");
    }
    volume.type = ScalarType::u8;
    volume.channels = 2;
    for (const char* name : {"b.nrrd", "b.mha"}) {
        write_volume(volume, folder_ / name);
        const Volume back = load(name);
        EXPECT_EQ(back.channels, 2) << name;
        EXPECT_EQ(back.voxels, volume.voxels) << name;
    }
    EXPECT_THROW(write_volume(volume, folder_ / "b.nii.gz"), Error);
    EXPECT_THROW(write_volume(volume, folder_ / "b.png"), Error);
}

TEST_F(VolumeFormat, WhatIsAVolumeIsToldByNameAndContent) {
    EXPECT_TRUE(is_volume(folder_.write("a.nrrd", "NRRD0004\n")));
    EXPECT_TRUE(is_volume(folder_.write("a.vtk", test::legacy_vtk("ASCII", "float", ""))));
    EXPECT_FALSE(
        is_volume(folder_.write("b.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\n")));
    EXPECT_TRUE(is_volume(folder_.write("a.hdr", test::Nifti(2, 8).bytes)));
    EXPECT_FALSE(is_volume(folder_.write("b.hdr", "#?RADIANCE\n")));
    EXPECT_FALSE(is_volume(folder_.write("a.json", R"({"unit":"mm","nodes":[],"edges":[]})")));
    EXPECT_TRUE(is_volume(folder_.write("b.json", R"({"file":"x","dims":[1,1,1],"type":"u8"})")));
    EXPECT_TRUE(is_volume(folder_.write("noextension", test::dicom({}))));
    EXPECT_FALSE(is_volume(folder_ / "missing.nrrd"));
    EXPECT_FALSE(is_volume(folder_.write("a.png", "")));
    const TempFolder empty;
    EXPECT_FALSE(is_volume(empty.path()));
}

}  // namespace
}  // namespace viscera::io
