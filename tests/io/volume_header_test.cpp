#include <gtest/gtest.h>

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

TEST_F(VolumeHeader, DicomInEitherByteOrderAndDeflatedIsOneVolume) {
    const std::vector<std::uint16_t> wide{0,      1,      255,    256,    4095,   0x7fff,
                                          0x8000, 0x8001, 0xff00, 0xfffe, 0xffff, 2};
    const std::vector<std::uint16_t> narrow{0, 1, 2, 3, 127, 128, 129, 200, 250, 251, 254, 255};
    struct Kind {
        const char* name;
        bool bytes;
        bool is_signed;
        std::string_view pixel_type;
    };
    for (const Kind& kind : {Kind{"u16", false, false, "OW"}, Kind{"i16", false, true, "OW"},
                             Kind{"u8 in words", true, false, "OW"}, Kind{"u8", true, false, "OB"}}) {
        for (const auto coding :
             {test::DicomCoding::little, test::DicomCoding::big, test::DicomCoding::deflated}) {
            SCOPED_TRACE(std::string(kind.name) + " " + std::to_string(static_cast<int>(coding)));
            test::DicomSlice slice{.pixels = kind.bytes ? narrow : wide,
                                   .coding = coding,
                                   .pixel_type = kind.pixel_type,
                                   .bytes = kind.bytes,
                                   .is_signed = kind.is_signed};
            if (!kind.bytes && !kind.is_signed) {
                std::ranges::for_each(slice.pixels, [](std::uint16_t& value) { value &= 0xfff; });
            }
            const Volume volume = load("one.dcm", test::dicom(slice));
            EXPECT_EQ(volume.type, kind.bytes       ? ScalarType::u8
                                   : kind.is_signed ? ScalarType::i16
                                                    : ScalarType::u16);
            EXPECT_EQ(volume.intercept, -1024.0);
            expect_near(volume.grid.origin_mm, {10, 20, 30});
            expect_near(volume.grid.spacing_mm, {0.5, 0.75, 1.0});
            for (int i = 0; i < 12; ++i) {
                const std::uint16_t due = slice.pixels.at(static_cast<std::size_t>(i));
                EXPECT_EQ(volume.stored({i % 4, i / 4, 0}),
                          kind.is_signed ? static_cast<double>(static_cast<std::int16_t>(due)) : due)
                    << i;
            }
        }
    }
    EXPECT_TRUE(log_.faults().empty());
}

TEST_F(VolumeHeader, SeriesMayMixDicomCodings) {
    for (int i = 0; i < 3; ++i) {
        test::DicomSlice slice{.position = R"(10\20\)" + std::to_string(30 + 2 * i),
                               .instance = i,
                               .coding = static_cast<test::DicomCoding>(i)};
        slice.pixels[0] = static_cast<std::uint16_t>(0x301 * (i + 1));
        put("s" + std::to_string(i), test::dicom(slice));
    }
    const Volume volume = load_folder();
    ASSERT_EQ(volume.grid.dims, glm::ivec3(4, 3, 3));
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(volume.stored({0, 0, i}), 0x301 * (i + 1));
        EXPECT_EQ(volume.stored({3, 2, i}), 11.0);
    }
}

/// A few bytes that unpack to many times the memory that may be taken.
TEST_F(VolumeHeader, DeflatedDicomIsUnpackedWithinMemory) {
    std::string bytes = test::dicom({.coding = test::DicomCoding::deflated});
    const std::size_t packed = test::dicom({}).find(std::string("\x08\0\x16\0", 4));
    bytes.resize(packed + 2);
    bytes += test::deflated(std::string(std::size_t{8} << 20U, '\0'), -15);
    try {
        static_cast<void>(
            load_volume(folder_.write("a.dcm", bytes), {.memory_limit = std::uint64_t{1} << 20U}, log_));
        FAIL() << "is taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::limit);
        EXPECT_NE(error.message().find("1 MiB"), std::string_view::npos) << error.what();
    }
}

}  // namespace
}  // namespace viscera::io
