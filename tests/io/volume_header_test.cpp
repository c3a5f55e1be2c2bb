#include <gtest/gtest.h>

#include <tiffio.h>

#include "engine/core/error.h"
#include "engine/io/volume.h"
#include "tests/io/temp_folder.h"
#include "tests/io/volume_files.h"

namespace viscera::io {
namespace {

using test::TempFolder;

class VolumeHeader : public testing::Test {
  protected:
    [[nodiscard]] Volume load(std::string_view name, std::string_view bytes) {
        return load_volume(folder_.write(name, bytes), {}, log_);
    }
    [[nodiscard]] Volume load_folder(const VolumeOptions& options = {}) {
        return load_volume(folder_.path(), options, log_);
    }

    void put(std::string_view name, std::string_view bytes) const {
        static_cast<void>(folder_.write(name, bytes));
    }

    TempFolder folder_;
    std::vector<std::string> messages_;
    Log log_{[this](LogLevel, std::string_view message) { messages_.emplace_back(message); }};
};

void expect_near(const glm::dvec3& is, const glm::dvec3& due, double within = 1e-6) {
    EXPECT_LT(glm::length(is - due), within) << is.x << " " << is.y << " " << is.z;
}

TEST_F(VolumeHeader, NiftiTurnsRasToLpsAndKeepsTheRescale) {
    test::Nifti nifti(4, 16);
    nifti.set(112, 2.0F);
    nifti.set(116, -1000.0F);
    const std::string voxels = test::bytes_of(test::ramp<std::int16_t>());
    put("c.img", voxels);
    test::Nifti pair = nifti;
    pair.bytes.replace(344, 4, std::string("ni1\0", 4));
    pair.set(108, 0.0F);
    for (const Volume& volume :
         {load("a.nii", nifti.bytes + voxels), load("b.nii.gz", test::deflated(nifti.bytes + voxels, 31)),
          load("c.hdr", pair.bytes), load_volume(folder_ / "c.img", {}, log_)}) {
        EXPECT_EQ(volume.type, ScalarType::i16);
        EXPECT_EQ(volume.grid.dims, glm::ivec3(4, 3, 2));
        expect_near(volume.grid.spacing_mm, {0.5, 0.75, 2.0});
        expect_near(volume.grid.origin_mm, {-10.0, -20.0, 30.0});
        expect_near(volume.grid.direction[0], {-1, 0, 0});
        expect_near(volume.grid.direction[1], {0, -1, 0});
        expect_near(volume.grid.direction[2], {0, 0, 1});
        EXPECT_EQ(volume.value_of(volume.stored({3, 2, 1})), -954.0);
    }
}

TEST_F(VolumeHeader, ShearedNiftiKeepsItsAxes) {
    test::Nifti nifti(2, 8);
    // The gantry is tilted: k leans towards the front.
    nifti.sform({-0.5F, 0, 0, 10}, {0, 0.75F, 0.6F, 20}, {0, 0, 1.8F, 30});
    const Volume volume = load("a.nii", nifti.bytes + test::bytes_of(test::ramp<std::uint8_t>()));
    const double length = std::sqrt(0.6 * 0.6 + 1.8 * 1.8);
    expect_near(volume.grid.spacing_mm, {0.5, 0.75, length});
    expect_near(volume.grid.direction[0], {1, 0, 0});
    expect_near(volume.grid.direction[1], {0, -1, 0});
    expect_near(volume.grid.direction[2], {0, -0.6 / length, 1.8 / length});
    expect_near(volume.grid.origin_mm, {-10.0, -20.0, 30.0});
    EXPECT_NEAR(glm::dot(volume.grid.direction[1], volume.grid.direction[2]), 0.6 / length, 1e-6);
    EXPECT_EQ(messages_.size(), 1U);
}

TEST_F(VolumeHeader, NiftiByQuaternionInColours) {
    test::Nifti nifti(128, 24);
    nifti.set(254, std::int16_t{0});
    nifti.set(252, std::int16_t{1});
    nifti.set(264, 1.0F);  // half a turn about the third axis: d = 1
    nifti.set(268, 10.0F);
    nifti.set(272, 20.0F);
    nifti.set(276, 30.0F);
    const Volume volume = load("a.nii", nifti.bytes + test::bytes_of(test::ramp<std::uint8_t>(72)));
    expect_near(volume.grid.direction[0], {1, 0, 0});
    expect_near(volume.grid.direction[1], {0, 1, 0});
    expect_near(volume.grid.origin_mm, {-10.0, -20.0, 30.0});
    EXPECT_EQ(volume.channels, 3);
    EXPECT_EQ(volume.stored({1, 0, 0}, 2), 5.0);
}

TEST_F(VolumeHeader, DicomSeriesIsSortedByPlaceAndKeepsStoredNumbers) {
    const std::vector<std::string> names{"I2", "I10", "I1"};
    for (std::size_t i = 0; i < 3; ++i) {
        test::DicomSlice slice{.position = R"(10\20\)" + std::to_string(30 + 2 * static_cast<int>(i)),
                               .instance = 3 - static_cast<int>(i)};
        slice.pixels[0] = static_cast<std::uint16_t>(100 * (i + 1));
        put(names[i], test::dicom(slice));
    }
    for (const Volume& volume : {load_folder(), load_volume(folder_ / "I10", {}, log_)}) {
        EXPECT_EQ(volume.grid.dims, glm::ivec3(4, 3, 3));
        expect_near(volume.grid.spacing_mm, {0.5, 0.75, 2.0});
        expect_near(volume.grid.origin_mm, {10, 20, 30});
        expect_near(volume.grid.direction[2], {0, 0, 1});
        EXPECT_EQ(volume.type, ScalarType::u16);
        EXPECT_EQ(volume.intercept, -1024.0);
        EXPECT_EQ(volume.unit, "HU");
        EXPECT_EQ(volume.stored({0, 0, 0}), 100.0);
        EXPECT_EQ(volume.stored({0, 0, 1}), 200.0);
        EXPECT_EQ(volume.stored({0, 0, 2}), 300.0);
        EXPECT_EQ(volume.stored({3, 2, 1}), 11.0);
    }
    EXPECT_TRUE(log_.faults().empty());
}

TEST_F(VolumeHeader, TiltedDicomSeriesIsSheared) {
    for (int i = 0; i < 3; ++i) {
        const test::DicomSlice slice{
            .position = R"(10\)" + std::to_string(20 + i) + R"(\)" + std::to_string(30 + 2 * i),
            .instance = i};
        put("s" + std::to_string(i) + ".dcm", test::dicom(slice));
    }
    const Volume volume = load_folder();
    expect_near(volume.grid.direction[2], glm::normalize(glm::dvec3(0, 1, 2)));
    EXPECT_NEAR(volume.grid.spacing_mm.z, std::sqrt(5.0), 1e-6);
}

TEST_F(VolumeHeader, OneOfSeveralDicomSeriesIsChosen) {
    for (int i = 0; i < 5; ++i) {
        const test::DicomSlice slice{.series = i < 2 ? "1.2.7" : "1.2.8",
                                     .position = R"(10\20\)" + std::to_string(2 * i),
                                     .instance = i};
        put("s" + std::to_string(i), test::dicom(slice));
    }
    EXPECT_EQ(load_folder().grid.dims.z, 3);
    ASSERT_FALSE(messages_.empty());
    EXPECT_NE(messages_[0].find("1.2.8 with 3 slices"), std::string::npos) << messages_[0];
    EXPECT_EQ(load_folder({.series = "1.2.7"}).grid.dims.z, 2);
    EXPECT_THROW(static_cast<void>(load_folder({.series = "1.2.9"})), Error);
}

TEST_F(VolumeHeader, DicomSlicesWithRescalesOfTheirOwnAreRescaled) {
    for (int i = 0; i < 2; ++i) {
        const test::DicomSlice slice{.position = R"(0\0\)" + std::to_string(2 * i),
                                     .slope = i == 0 ? "0.5" : "0.25",
                                     .intercept = "1",
                                     .instance = i};
        put("s" + std::to_string(i), test::dicom(slice));
    }
    const Volume volume = load_folder();
    EXPECT_EQ(volume.type, ScalarType::f32);
    EXPECT_EQ(volume.value_of(volume.stored({3, 2, 0})), 6.5);
    EXPECT_EQ(volume.value_of(volume.stored({3, 2, 1})), 3.75);
}

TEST_F(VolumeHeader, TiffSlices) {
    for (const int bits : {8, 16}) {
        const TempFolder folder;
        for (const char* name : {"a1.tif", "a2.tif"}) {
            TIFF* tiff = TIFFOpen((folder / name).c_str(), "w");
            TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 4);
            TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 3);
            TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
            TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 2);
            TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
            for (std::uint32_t y = 0; y < 3; ++y) {
                std::vector<std::uint8_t> row8{static_cast<std::uint8_t>(y), 1, 2, 3};
                std::vector<std::uint16_t> row16{static_cast<std::uint16_t>(1000 * y), 1, 2, 3};
                TIFFWriteScanline(tiff, bits == 8 ? static_cast<void*>(row8.data()) : row16.data(), y);
            }
            TIFFClose(tiff);
        }
        const Volume volume = load_volume(folder.path(), {}, log_);
        EXPECT_EQ(volume.grid.dims, glm::ivec3(4, 3, 2));
        EXPECT_EQ(volume.type, bits == 8 ? ScalarType::u8 : ScalarType::u16);
        EXPECT_EQ(volume.stored({0, 2, 1}), bits == 8 ? 2.0 : 2000.0);
    }
}

}  // namespace
}  // namespace viscera::io
