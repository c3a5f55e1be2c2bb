#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "assets/generate/generate.h"
#include "assets/generate/volume_angiogram.h"
#include "assets/generate/volume_files.h"
#include "assets/generate/volume_head.h"

namespace viscera::assets {
namespace {

namespace fs = std::filesystem;

constexpr int coarser = 4;

const HeadVolumes& head() {
    static const HeadVolumes made = make_head(default_seed, coarser);
    return made;
}

template <typename T>
std::vector<T> values_of(const Volume& volume) {
    std::vector<T> values(volume.voxels.size() / sizeof(T));
    std::memcpy(values.data(), volume.voxels.data(), volume.voxels.size());
    return values;
}

/// Calls act(index, position in mm) for each voxel.
void for_each(const VolumeGrid& grid, const auto& act) {
    std::size_t i = 0;
    for (int z = 0; z < grid.dims.z; ++z) {
        for (int y = 0; y < grid.dims.y; ++y) {
            for (int x = 0; x < grid.dims.x; ++x) {
                act(i++, grid.origin_mm + grid.spacing_mm * glm::dvec3(x, y, z));
            }
        }
    }
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// CT values of each label.
std::map<int, std::vector<double>> values_by_label() {
    const auto ct = values_of<std::int16_t>(head().ct);
    const auto labels = values_of<std::uint8_t>(head().labels);
    std::map<int, std::vector<double>> values;
    for (std::size_t i = 0; i < ct.size(); ++i) {
        values[labels[i]].push_back(ct[i]);
    }
    return values;
}

/// Middle of the voxels with a label [mm].
glm::dvec3 centre_of(HeadLabel label) {
    const auto labels = values_of<std::uint8_t>(head().labels);
    glm::dvec3 sum(0.0);
    double count = 0.0;
    for_each(head().labels.grid, [&](std::size_t i, const glm::dvec3& p) {
        if (labels[i] == label) {
            sum += p;
            count += 1.0;
        }
    });
    return sum / count;
}

TEST(HeadVolumes, fill_one_box_whatever_their_voxels) {
    const VolumeGrid& grid = head().ct.grid;
    EXPECT_EQ(grid.dims, glm::ivec3(48, 56, 48));
    EXPECT_EQ(grid.spacing_mm, glm::dvec3(4.0, 4.0, 5.0));
    EXPECT_EQ(head().labels.grid, grid);
    EXPECT_EQ(head().perfusion.grid.dims, glm::ivec3(8));
    const auto corner = [](const VolumeGrid& g) { return g.origin_mm - 0.5 * g.spacing_mm; };
    EXPECT_EQ(corner(head().perfusion.grid), corner(grid));
    EXPECT_EQ(head().perfusion.grid.spacing_mm * 8.0, grid.spacing_mm * glm::dvec3(grid.dims));
    EXPECT_EQ(head().ct.type, ScalarType::i16);
    EXPECT_EQ(head().labels.type, ScalarType::u8);
    EXPECT_EQ(head().perfusion.type, ScalarType::f32);
    EXPECT_EQ(head().ct.unit, "HU");
}

TEST(HeadVolumes, show_tissues_in_their_hounsfield_units) {
    const auto values = values_by_label();
    EXPECT_NEAR(median(values.at(no_label)), -1000.0, 1.0);
    EXPECT_GT(median(values.at(skull)), 600.0);
    EXPECT_GT(median(values.at(mandible)), 500.0);
    EXPECT_GT(median(values.at(teeth)), 900.0);
    EXPECT_GT(median(values.at(vertebrae)), 300.0);
    EXPECT_NEAR(median(values.at(brain)), 33.0, 6.0);
    EXPECT_NEAR(median(values.at(cerebellum)), 34.0, 6.0);
    EXPECT_NEAR(median(values.at(ventricles)), 12.0, 8.0);
    EXPECT_NEAR(median(values.at(bleed)), 66.0, 8.0);
    EXPECT_NEAR(median(values.at(eyes)), 15.0, 15.0);
    const auto ct = values_of<std::int16_t>(head().ct);
    const auto [least, greatest] = std::minmax_element(ct.begin(), ct.end());
    EXPECT_GT(*least, -1040);
    EXPECT_GT(*greatest, 1300);
    EXPECT_LT(*greatest, 2700);
}

TEST(HeadVolumes, have_noise_of_six_units_in_the_air) {
    const auto ct = values_of<std::int16_t>(head().ct);
    double squares = 0.0;
    double sum = 0.0;
    double count = 0.0;
    for_each(head().ct.grid, [&](std::size_t i, const glm::dvec3& p) {
        if (std::abs(p.x) > 84.0 && p.z > 20.0) {
            sum += ct[i] + 1000.0;
            squares += (ct[i] + 1000.0) * (ct[i] + 1000.0);
            count += 1.0;
        }
    });
    EXPECT_GT(count, 3000.0);
    EXPECT_NEAR(sum / count, 0.0, 0.5);
    EXPECT_NEAR(std::sqrt(squares / count), 6.0, 0.3);
}

TEST(HeadVolumes, lie_in_patient_axes_face_forward) {
    const auto labels = values_of<std::uint8_t>(head().labels);
    glm::dvec3 nose(0.0, 1e9, 0.0);
    double crown = -1e9;
    for_each(head().labels.grid, [&](std::size_t i, const glm::dvec3& p) {
        if (labels[i] != no_label) {
            nose = p.y < nose.y ? p : nose;
            crown = std::max(crown, p.z);
        }
    });
    EXPECT_NEAR(nose.x, 0.0, 9.0);
    EXPECT_NEAR(nose.y, -103.0, 6.0);
    EXPECT_NEAR(nose.z, -36.0, 12.0);
    EXPECT_NEAR(crown, 103.0, 6.0);
    EXPECT_LT(centre_of(eyes).y, -55.0);
    EXPECT_GT(centre_of(cerebellum).y, 30.0);
    EXPECT_LT(centre_of(cerebellum).z, centre_of(brain).z);
    EXPECT_LT(centre_of(mandible).z, centre_of(teeth).z);
    EXPECT_LT(centre_of(teeth).z, centre_of(eyes).z);
    EXPECT_LT(centre_of(vertebrae).z, -50.0);
    EXPECT_LT(centre_of(bleed).x, -15.0);  // on the patient's right
}

TEST(HeadVolumes, are_enclosed_by_air) {
    const auto labels = values_of<std::uint8_t>(head().labels);
    const glm::ivec3 dims = head().labels.grid.dims;
    std::size_t i = 0;
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            for (int x = 0; x < dims.x; ++x, ++i) {
                if (x == 0 || y == 0 || x + 1 == dims.x || y + 1 == dims.y || z + 1 == dims.z) {
                    ASSERT_EQ(labels[i], no_label) << x << ' ' << y << ' ' << z;
                }
            }
        }
    }
}

TEST(HeadVolumes, have_sparse_label_ids) {
    const auto labels = values_of<std::uint8_t>(head().labels);
    EXPECT_EQ(std::set<int>(labels.begin(), labels.end()),
              (std::set<int>{0, 1, 2, 3, 10, 11, 20, 30, 40, 50, 200}));
}

TEST(HeadVolumes, perfusion_fails_around_the_bleed) {
    const Volume map = make_head(default_seed, 2).perfusion;
    const auto flow = values_of<float>(map);
    double bleeding = 0.0;
    double sound = 0.0;
    for_each(map.grid, [&](std::size_t i, const glm::dvec3& p) {
        EXPECT_GE(flow[i], 0.0F);
        EXPECT_LT(flow[i], 110.0F);
        if (glm::distance(glm::abs(p), glm::dvec3(26.0, 0.0, 22.0)) < 14.0 && p.z > 0.0) {
            (p.x < 0.0 ? bleeding : sound) += flow[i];
        }
        if (p.z > 110.0 || p.z < -60.0) {
            EXPECT_EQ(flow[i], 0.0F);
        }
    });
    EXPECT_GT(sound, 0.0);
    EXPECT_LT(bleeding, 0.6 * sound);
}

TEST(HeadVolumes, are_the_same_each_time_and_others_with_another_seed) {
    const HeadVolumes again = make_head(default_seed, coarser);
    EXPECT_TRUE(again.ct.voxels == head().ct.voxels);
    EXPECT_TRUE(again.labels.voxels == head().labels.voxels);
    EXPECT_TRUE(again.perfusion.voxels == head().perfusion.voxels);
    const HeadVolumes other = make_head(default_seed + 1, coarser);
    EXPECT_FALSE(other.ct.voxels == head().ct.voxels);
    EXPECT_FALSE(other.labels.voxels == head().labels.voxels);
}

TEST(Angiogram, shows_bright_arteries_in_dim_tissue) {
    const Volume angiogram = make_angiogram(default_seed, coarser);
    EXPECT_EQ(angiogram.grid.dims, glm::ivec3(48));
    EXPECT_NEAR(angiogram.grid.spacing_mm.x, 3.2, 1e-12);
    ASSERT_EQ(angiogram.type, ScalarType::u16);
    const auto values = values_of<std::uint16_t>(angiogram);
    double bright = 0.0;
    std::vector<double> aorta;
    for_each(angiogram.grid, [&](std::size_t i, const glm::dvec3& p) {
        bright += values[i] > 600 ? 1.0 : 0.0;
        if (std::abs(p.x - 3.0) < 3.0 && std::abs(p.y - 11.0) < 3.0 && std::abs(p.z - 10.0) < 20.0) {
            aorta.push_back(values[i]);
        }
    });
    EXPECT_GT(*std::min_element(aorta.begin(), aorta.end()), 700.0);
    bright /= static_cast<double>(values.size());
    EXPECT_GT(bright, 0.005);
    EXPECT_LT(bright, 0.05);
    EXPECT_LT(median({values.begin(), values.end()}), 200.0);
    EXPECT_TRUE(make_angiogram(default_seed, coarser).voxels == angiogram.voxels);
}

TEST(Angiogram, has_arteries_from_the_aorta_down_to_a_voxel) {
    const VesselTree tree = grow_abdominal_arteries(default_seed);
    double thinnest = 1e9;
    double thickest = 0.0;
    for (const CentrelineGraph::Node& node : tree.graph.nodes) {
        thinnest = std::min(thinnest, static_cast<double>(node.radius_mm));
        thickest = std::max(thickest, static_cast<double>(node.radius_mm));
    }
    EXPECT_NEAR(thickest, 8.0, 0.1);
    EXPECT_GT(thinnest, 0.3);
    EXPECT_LT(thinnest, 0.6);
    EXPECT_GT(tree.branches.size(), 200U);
}

class VolumeFiles : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    /// Splits a file behind `end_of_header` and unpacks what follows.
    void expect_content(const fs::path& path, const std::string& end_of_header, const Volume& volume,
                        int window_bits) {
        std::ifstream file(path, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        const std::size_t at = bytes.find(end_of_header) + end_of_header.size();
        header_ = bytes.substr(0, at);
        std::vector<std::byte> unpacked(volume.voxels.size() + 1);
        z_stream stream{};
        ASSERT_EQ(inflateInit2(&stream, window_bits), Z_OK);
        std::string packed = bytes.substr(at);
        stream.next_in = reinterpret_cast<Bytef*>(packed.data());
        stream.avail_in = static_cast<uInt>(packed.size());
        stream.next_out = reinterpret_cast<Bytef*>(unpacked.data());
        stream.avail_out = static_cast<uInt>(unpacked.size());
        EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
        unpacked.resize(stream.total_out);
        inflateEnd(&stream);
        EXPECT_TRUE(unpacked == volume.voxels);
    }

    // One folder a test: they run side by side.
    fs::path folder_ =
        fs::path(testing::TempDir()) /
        (std::string("viscera_assets_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::string header_;
};

TEST_F(VolumeFiles, meta_image_says_where_the_voxels_lie) {
    write_volume(head().ct, folder_ / "head.mha");
    expect_content(folder_ / "head.mha", "ElementDataFile = LOCAL\n", head().ct, MAX_WBITS);
    EXPECT_THAT(header_, testing::HasSubstr("\nDimSize = 48 56 48\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nElementSpacing = 4 4 5\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nOffset = -94 -110 -120.5\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nElementType = MET_SHORT\n"));
}

TEST_F(VolumeFiles, nrrd_says_where_the_voxels_lie) {
    write_volume(head().labels, folder_ / "labels.nrrd");
    expect_content(folder_ / "labels.nrrd", "\n\n", head().labels, MAX_WBITS + 16);
    EXPECT_THAT(header_, testing::StartsWith("NRRD0004\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nspace: left-posterior-superior\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nsizes: 48 56 48\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nspace directions: (4,0,0) (0,4,0) (0,0,5)\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\nspace origin: (-94,-110,-120.5)\n"));
    EXPECT_THAT(header_, testing::HasSubstr("\ntype: uint8\n"));
}

}  // namespace
}  // namespace viscera::assets
