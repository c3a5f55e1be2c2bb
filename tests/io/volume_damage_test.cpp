#include <algorithm>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/io/volume.h"
#include "tests/io/temp_folder.h"
#include "tests/io/volume_files.h"

namespace viscera::io {
namespace {

struct VolumeSample {
    const char* name;
    std::string bytes;
};

std::vector<VolumeSample> volume_samples() {
    const std::string shorts = test::bytes_of(test::ramp<std::int16_t>());
    const std::string packed = test::deflated(shorts, 15);
    const std::string gzipped = test::deflated(shorts, 31);
    const test::Nifti nifti(4, 16);
    test::Nifti sheared = nifti;
    sheared.sform({-0.5F, 0, 0, 10}, {0, 0.75F, 0.6F, 20}, {0, 0, 1.8F, 30});
    const std::string array = R"(<DataArray type="Int16" Name="density" format=)";
    const std::string wide = test::bytes_of(std::uint64_t{48}) + shorts;
    return {
        {"raw.mha", test::mha("MET_SHORT", shorts)},
        {"zlib.mha", test::mha("MET_SHORT", packed, "CompressedData = True\n")},
        {"raw.nrrd", test::nrrd("short", "raw", shorts)},
        {"gzip.nrrd", test::nrrd("short", "gzip", gzipped)},
        {"text.nrrd", test::nrrd("short", "ascii", test::ramp_text<int>())},
        {"a.nii", nifti.bytes + shorts},
        {"sheared.nii", sheared.bytes + shorts},
        {"a.nii.gz", test::deflated(nifti.bytes + shorts, 31)},
        {"text.vtk", test::legacy_vtk("ASCII", "short", test::ramp_text<int>())},
        {"binary.vtk", test::legacy_vtk("BINARY", "double", test::big_endian(test::ramp<double>()))},
        {"text.vti", test::vti(array + "\"ascii\">" + test::ramp_text<int>() + "</DataArray>")},
        {"binary.vti", test::vti(array + "\"binary\">" +
                                 test::base64(test::bytes_of(std::uint32_t{48}) + shorts) + "</DataArray>")},
        {"appended.vti", test::vti(array + "\"appended\" offset=\"0\"/>", "header_type=\"UInt64\"",
                                   "<AppendedData encoding=\"raw\">_" + wide + "</AppendedData>")},
        {"a.csv", test::csv()},
        {"a.json", R"({"file":"beside.raw","dims":[4,3,2],"type":"i16","spacing_mm":[1,1,2],"axes":"RAS"})"},
        {"a.plist",
         "<plist><dict><key>modality</key><string>CT</string><key>matrix</key><dict><key>dtype</key>"
         "<string>int16</string><key>filename</key><string>beside.raw</string><key>shape</key><array>"
         "<integer>2</integer><integer>3</integer><integer>4</integer></array></dict><key>spacing</key>"
         "<array><real>1</real><real>1</real><real>2</real></array></dict></plist>"},
        {"a.dcm", test::dicom({})},
        {"big.dcm", test::dicom({.coding = test::DicomCoding::big})},
        {"deflated.dcm", test::dicom({.coding = test::DicomCoding::deflated})}};
}

class VolumeDamage : public testing::TestWithParam<std::size_t> {
  protected:
    VolumeDamage() {
        static_cast<void>(folder_.write("beside.raw", test::bytes_of(test::ramp<std::int16_t>())));
    }

    /// A damaged file gives a sound volume or Error that names it; whatever else escapes fails.
    void expect_survived(const std::string& bytes) {
        const std::filesystem::path file = folder_.write(sample_.name, bytes);
        Log log;
        try {
            const Volume volume = load_volume(file, {.memory_limit = most_bytes}, log);
            EXPECT_NO_THROW(volume.validate());
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == ErrorCode::file || error.code() == ErrorCode::limit) << error.what();
            EXPECT_EQ(error.where(), file.string());
            EXPECT_FALSE(error.message().empty());
        }
    }

    static constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20U;
    VolumeSample sample_ = volume_samples()[GetParam()];
    test::TempFolder folder_;
};

TEST_P(VolumeDamage, TheWholeFileLoads) {
    Log log;
    const Volume volume = load_volume(folder_.write(sample_.name, sample_.bytes), {}, log);
    EXPECT_EQ(volume.stored({3, 2, 0}), 11.0);
}

TEST_P(VolumeDamage, TruncationIsSurvived) {
    const std::size_t step = std::max<std::size_t>(1, sample_.bytes.size() / 100);
    for (std::size_t size = 0; size < sample_.bytes.size(); size += step) {
        expect_survived(sample_.bytes.substr(0, size));
    }
}

TEST_P(VolumeDamage, FlippedBytesAreSurvived) {
    std::mt19937 random(20240607U);
    std::uniform_int_distribution<std::size_t> place(0, sample_.bytes.size() - 1);
    std::uniform_int_distribution<int> value(0, 255);
    for (int round = 0; round < 150; ++round) {
        std::string bytes = sample_.bytes;
        for (int flips = 0; flips <= round % 4; ++flips) {
            bytes[place(random)] = static_cast<char>(value(random));
        }
        expect_survived(bytes);
    }
}

/// Digits are where headers keep sizes, spacings and offsets.
TEST_P(VolumeDamage, OtherDigitsAreSurvived) {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < sample_.bytes.size(); ++i) {
        if (sample_.bytes[i] >= '0' && sample_.bytes[i] <= '9') {
            places.push_back(i);
        }
    }
    const std::size_t step = std::max<std::size_t>(1, places.size() / 20);
    for (std::size_t i = 0; i < places.size(); i += step) {
        for (const char* text : {"0", "9999999", "-1", "nan", "1e300", "99999999999999999999"}) {
            std::string bytes = sample_.bytes;
            expect_survived(bytes.replace(places[i], 1, text));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Files, VolumeDamage, testing::Range(std::size_t{0}, volume_samples().size()),
                         [](const testing::TestParamInfo<std::size_t>& info) {
                             std::string name = volume_samples()[info.param].name;
                             std::ranges::replace(name, '.', '_');
                             return name;
                         });

/// Damage behind a stream that is sound: what is unpacked is walked as closely as what is not packed.
/// VISCERA_FUZZ_ROUNDS: how many inputs (default 300).
TEST(VolumeDamageOfDeflatedDicom, ElementsAreWalkedUnpacked) {
    const std::string whole = test::dicom({.coding = test::DicomCoding::deflated});
    const std::string plain = test::dicom({});
    const std::string first_element("\x08\0\x16\0", 4);
    const std::string elements = plain.substr(plain.find(first_element));
    const std::size_t packed = whole.size() - test::deflated(elements, -15).size();
    const char* wanted = std::getenv("VISCERA_FUZZ_ROUNDS");
    const int rounds = wanted == nullptr ? 300 : std::atoi(wanted);
    std::mt19937 random(20240608U);
    std::uniform_int_distribution<std::size_t> place(0, elements.size() - 1);
    std::uniform_int_distribution<int> value(0, 255);
    const test::TempFolder folder;
    int refused = 0;
    for (int round = 0; round < rounds; ++round) {
        std::string damaged = elements;
        for (int flips = 0; flips < round % 4; ++flips) {
            damaged[place(random)] = static_cast<char>(value(random));
        }
        if (round % 5 == 4) {
            damaged.resize(place(random));
        }
        const std::filesystem::path file =
            folder.write("a.dcm", whole.substr(0, packed) + test::deflated(damaged, -15));
        Log log;
        try {
            const Volume volume = load_volume(file, {}, log);
            EXPECT_NO_THROW(volume.validate());
        } catch (const Error& error) {
            EXPECT_EQ(error.where(), file.string());
            ++refused;
        }
    }
    EXPECT_GT(refused, rounds / 5);
    EXPECT_LT(refused, rounds);
}

struct Lie {
    const char* name;
    std::string bytes;
    const char* words;
};

std::string changed(std::string bytes, std::string_view from, std::string_view to) {
    return bytes.replace(bytes.find(from), from.size(), to);
}

TEST(VolumeLies, AreToldByFileAndField) {
    const std::string shorts = test::bytes_of(test::ramp<std::int16_t>());
    const std::string mha = test::mha("MET_SHORT", shorts);
    const std::string zlib = test::mha("MET_SHORT", test::deflated(shorts, 15), "CompressedData = True\n");
    const std::string nrrd = test::nrrd("short", "raw", shorts);
    const std::string vtk = test::legacy_vtk("BINARY", "short", shorts);
    test::Nifti huge(4, 16);
    huge.set(42, std::int16_t{32767});
    huge.set(44, std::int16_t{32767});
    test::Nifti flat(4, 16);
    flat.set(80, 0.0F);
    const std::vector<Lie> lies{
        {"a.mha", changed(mha, "4 3 2", "40000 30000 20000"), "size"},
        {"a.mha", changed(zlib, "4 3 2", "40000 30000 20000"), "size"},
        {"a.mha", changed(mha, "0.5 0.75 2", "0.5 0 2"), "spacing"},
        {"a.mha", changed(mha, "0.5 0.75 2", "0.5 nan 2"), "spacing"},
        {"a.mha", changed(mha, "0 1 0 -1 0 0 0 0 1", "0 1 0 0 1 0 0 0 1"), "direction"},
        {"a.mha", changed(mha, "MET_SHORT", "MET_STRING"), "ElementType"},
        {"a.mha", changed(mha, "4 3 2", "4 -3 2"), "DimSize"},
        {"a.mha", mha.substr(0, mha.size() - 1), "truncated"},
        {"a.mha", zlib.substr(0, zlib.size() - 8), "truncated"},
        {"a.nrrd", changed(nrrd, "4 3 2", "40000 30000 20000"), "size"},
        {"a.nrrd", changed(nrrd, "(0,0,2)", "(0,0,0)"), ""},
        {"a.nrrd", nrrd.substr(0, nrrd.size() - 1), "truncated"},
        {"a.nii", huge.bytes + shorts, "size"},
        {"a.nii.gz", test::deflated(huge.bytes + shorts, 31), "size"},
        {"a.nii", flat.bytes + shorts, "spacing"},
        {"a.vtk", changed(vtk, "4 3 2", "40000 30000 20000"), "POINT_DATA"},
        {"a.vtk", changed(vtk, "0.5 0.75 2", "0.5 0.75 0"), "spacing"},
        {"a.vtk", vtk.substr(0, vtk.size() - 1), "truncated"},
        {"a.vti",
         changed(changed(test::vti("<DataArray type=\"UInt8\" format=\"ascii\">1 2</DataArray>"),
                         "0 3 0 2 0 1", "0 39999 0 2 0 1"),
                 "0 3 0 2 0 1", "0 39999 0 2 0 1"),
         "bytes"},
        {"a.vti",
         changed(test::vti("<DataArray type=\"UInt8\" format=\"ascii\">1 2</DataArray>"), "0.75", "0"),
         "spacing"},
        {"a.dcm", test::dicom({.orientation = R"(1\0\0\1\0\0)"}), ""}};
    const test::TempFolder folder;
    for (const Lie& lie : lies) {
        const std::filesystem::path file = folder.write(lie.name, lie.bytes);
        Log log;
        try {
            static_cast<void>(load_volume(file, {}, log));
            ADD_FAILURE() << lie.name << " is taken: " << lie.words;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file) << error.what();
            EXPECT_EQ(error.where(), file.string());
            EXPECT_NE(error.message().find(lie.words), std::string_view::npos) << error.what();
        }
    }
}

/// What ITK's readers do not survive: patterns for printf, steps of 0, and lines longer than its messages.
TEST(VolumeLies, NamesOfSlicesAndLongLinesAreReadBeforeALibraryDoes) {
    const test::TempFolder folder;
    const std::string half = test::bytes_of(test::ramp<std::int16_t>(12));
    static_cast<void>(folder.write("s0.raw", half));
    static_cast<void>(folder.write("s1.raw", half));
    const auto meta = [](const std::string& names) {
        const std::string whole = test::mha("MET_SHORT", "");
        return whole.substr(0, whole.find("ElementDataFile")) + "ElementDataFile = " + names + "\n";
    };
    const auto numbered = [](const std::string& names) {
        return test::nrrd("short", "raw", "", "left-posterior-superior", "data file: " + names + "\n");
    };
    Log log;
    EXPECT_EQ(load_volume(folder.write("a.mhd", meta("s%d.raw 0 1 1")), {}, log).stored({3, 2, 1}), 11.0);
    EXPECT_EQ(load_volume(folder.write("a.nhdr", numbered("s%01d.raw 0 1 1")), {}, log).stored({3, 2, 1}),
              11.0);
    for (const char* names : {"s%d.raw 0 1", "s%d.raw 0 1 0", "s%d.raw 0 1 -1", "s%d.raw 1 0 1",
                              "s%s.raw 0 1 1", "s%d%n.raw 0 1 1", "s%999999d.raw 0 1 1", "s%", "s%d.raw"}) {
        for (const auto& [name, bytes] :
             {std::pair("b.mhd", meta(names)), std::pair("b.nhdr", numbered(names))}) {
            EXPECT_THROW(static_cast<void>(load_volume(folder.write(name, bytes), {}, log)), Error) << names;
        }
    }
    EXPECT_EQ(load_volume(folder.write("c.mhd", meta("LIST\ns0.raw\ns1.raw")), {}, log).stored({3, 2, 1}),
              11.0);
    for (const char* names : {"LIST\ns0.raw\ns7.raw", "LIST\ns0.raw", "s%d.raw 1 2 1", "s%d.raw 0 0 1"}) {
        EXPECT_THROW(static_cast<void>(load_volume(folder.write("b.mhd", meta(names)), {}, log)), Error)
            << names;
    }
    const std::string lines = test::nrrd("short", "raw", half + half, "left-posterior-superior",
                                         "key " + std::string(5000, 'x') + "\n");
    EXPECT_THROW(static_cast<void>(load_volume(folder.write("long.nrrd", lines), {}, log)), Error);
}

TEST(VolumeDamageOfSlices, DamagedAndUnlikePicturesAreNamed) {
    for (const char* name : {"b.png", "b.tif", "b.jpg"}) {
        const test::TempFolder folder;
        static_cast<void>(folder.write(name, "no picture"));
        Log log;
        try {
            static_cast<void>(load_volume(folder.path(), {}, log));
            FAIL() << name << " is taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_EQ(error.where(), folder.path().string());
            EXPECT_NE(error.message().find(name), std::string_view::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace viscera::io
