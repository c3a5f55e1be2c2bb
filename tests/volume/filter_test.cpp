#include <cmath>

#include <gtest/gtest.h>

#include "tests/volume/filter_kinds.h"

namespace viscera::test {
namespace {

using reference::Field;
using volume::GradientKind;
using volume::ReconstructionParams;
using volume::Storage;

/// Whether a place lies so near to a face between cells that rounding decides which cell it is in.
bool near_face(const glm::dvec3& place, const glm::ivec3& dims, double shift) {
    const glm::dvec3 p = place * glm::dvec3(dims) + shift;
    const glm::dvec3 away = glm::abs(p - glm::round(p));
    return std::min({away.x, away.y, away.z}) < 1e-4;
}

double largest(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Of what a field interpolates: voxels or coefficients.
double range_of(const Field& field) {
    double low = field.sample({0, 0, 0});
    double high = low;
    glm::ivec3 i;
    for (i.z = 0; i.z < field.dims().z; ++i.z) {
        for (i.y = 0; i.y < field.dims().y; ++i.y) {
            for (i.x = 0; i.x < field.dims().x; ++i.x) {
                low = std::min(low, field.sample(i));
                high = std::max(high, field.sample(i));
            }
        }
    }
    return high - low;
}

class FilterTest : public testing::Test {
  protected:
    VolumeSampler sampler_;
};

TEST_F(FilterTest, EachFilterIsItsDoublePrecisionReference) {
    const std::vector<glm::vec3> places = places_in(0.6, 4096);
    for (const ScalarType type :
         {ScalarType::u8, ScalarType::i8, ScalarType::u16, ScalarType::i16, ScalarType::f32}) {
        const volume::Source source = make_source(make_noise({12, 9, 7}, type));
        const Volume& volume = source.volume();
        const double voxel_range = source.statistics.max - source.statistics.min;
        for (const FilterKind& kind : all_filter_kinds()) {
            for (const GradientKind gradient : {GradientKind::analytic, GradientKind::central}) {
                SCOPED_TRACE(std::string(to_string(type)) + " " + kind.name +
                             (gradient == GradientKind::central ? " central" : " analytic"));

                const bool central = gradient == GradientKind::central;
                const Field field(volume, kind.reference);
                ReconstructionParams reconstruction = kind.reconstruction;
                reconstruction.gradient = gradient;
                const auto samples = sampler_.sample(source, reconstruction, Storage::texture_3d, places);
                double value_error = 0.0;
                double gradient_error = 0.0;
                for (std::size_t i = 0; i < places.size(); ++i) {
                    const glm::dvec3 place(places[i]);
                    const bool nearest = kind.reference == reference::Filter::nearest;
                    if (near_face(place, volume.grid.dims, nearest ? 0.0 : 0.5)) {
                        continue;
                    }
                    const glm::dvec3 expected =
                        central ? field.central_difference(place) : field.gradient(place);
                    value_error = std::max(value_error, std::abs(samples[i].value - field.value(place)));
                    gradient_error = std::max(gradient_error, largest((samples[i].gradient - expected) /
                                                                      glm::dvec3(volume.grid.dims)));
                }
                // The texture unit's weights are as good as the coordinate; they weigh what the texture
                // holds.
                const double range = kind.full_precision ? voxel_range : range_of(field);
                EXPECT_LE(value_error / range, 2e-6);
                EXPECT_LE(gradient_error / range, 2e-6);
            }
        }
    }
}

TEST_F(FilterTest, InterpolatingFiltersPassThroughTheVoxels) {
    const volume::Source source = make_source(make_noise({9, 5, 6}, ScalarType::f32));
    const glm::ivec3 dims = source.volume().grid.dims;
    std::vector<glm::vec3> centres;
    std::vector<double> voxels;
    glm::ivec3 i;
    for (i.z = 0; i.z < dims.z; ++i.z) {
        for (i.y = 0; i.y < dims.y; ++i.y) {
            for (i.x = 0; i.x < dims.x; ++i.x) {
                centres.emplace_back((glm::dvec3(i) + 0.5) / glm::dvec3(dims));
                voxels.push_back(source.volume().stored(i));
            }
        }
    }
    for (const FilterKind& kind : all_filter_kinds()) {
        const auto samples = sampler_.sample(source, kind.reconstruction, Storage::texture_3d, centres);
        double error = 0.0;
        for (std::size_t k = 0; k < voxels.size(); ++k) {
            error = std::max(error, std::abs(samples[k].value - voxels[k]));
        }
        if (kind.reference == reference::Filter::bspline) {
            EXPECT_GT(error, 0.1) << kind.name;  // smooths
        } else {
            EXPECT_LE(error, 4e-6) << kind.name;  // of a range of 2
        }
    }
}

TEST_F(FilterTest, ConstantsComeOutAsTheyAre) {
    const std::vector<glm::vec3> places = places_in(0.7, 1024);
    for (const glm::ivec3 dims : {glm::ivec3(7, 6, 5), glm::ivec3(1, 5, 3), glm::ivec3(1)}) {
        const volume::Source source = make_source(make_volume(dims, [](const glm::ivec3&) { return 0.7F; }));
        for (const FilterKind& kind : all_filter_kinds()) {
            for (const Storage storage : {Storage::texture_3d, Storage::atlas}) {
                for (const auto& sample : sampler_.sample(source, kind.reconstruction, storage, places)) {
                    ASSERT_EQ(sample.value, static_cast<double>(0.7F)) << kind.name;
                    ASSERT_EQ(sample.gradient, glm::dvec3(0.0)) << kind.name;
                }
            }
        }
    }
}

TEST_F(FilterTest, RampsAreNotShifted) {
    const glm::dvec3 slope(1.0, -2.0, 0.5);
    const volume::Source source = make_source(
        make_volume(glm::ivec3(32), [&](const glm::ivec3& i) { return dot(slope, glm::dvec3(i)); }));
    const std::vector<glm::vec3> places = places_in(0.1, 1024);  // far from where edges end the ramp
    for (const FilterKind& kind : all_filter_kinds()) {
        if (kind.reference == reference::Filter::nearest) {
            continue;
        }
        const auto samples = sampler_.sample(source, kind.reconstruction, Storage::texture_3d, places);
        for (std::size_t k = 0; k < places.size(); ++k) {
            const double expected = dot(slope, 32.0 * glm::dvec3(places[k]) - 0.5);
            ASSERT_NEAR(samples[k].value, expected, 112.0 * 2e-6) << kind.name;  // range 112
            ASSERT_LE(largest(samples[k].gradient / 32.0 - slope), 112.0 * 2e-6) << kind.name;
        }
    }
}

}  // namespace
}  // namespace viscera::test
