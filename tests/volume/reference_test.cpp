// Reconstruction filters and rays of the reference.

#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "engine/core/camera.h"
#include "tests/reference/volume_field.h"
#include "tests/reference/volume_forms.h"
#include "tests/reference/volume_profile.h"
#include "tests/reference/volume_ray.h"

namespace viscera::reference {
namespace {

std::vector<double> noise(const glm::ivec3& dims, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<double> samples(static_cast<std::size_t>(dims.x * dims.y * dims.z));
    for (double& sample : samples) {
        sample = unit(random);
    }
    return samples;
}

/// A function of whole voxel places, on a cube of n voxels, in index coordinates.
template <class F>
Field sampled(int n, Filter filter, const F& f) {
    std::vector<double> samples;
    for (int z = 0; z < n; ++z) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                samples.push_back(f(glm::dvec3(x, y, z)));
            }
        }
    }
    return {glm::ivec3(n), std::move(samples), filter};
}

double rms_of_marschner_lobb(int n, Filter filter) {
    const Field field(glm::ivec3(n), marschner_lobb_samples(n), filter);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-0.8, 0.8);
    double sum = 0.0;
    constexpr int count = 60000;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 p(unit(random), unit(random), unit(random));
        const glm::dvec3 index = (p + 1.0) * (0.5 * (n - 1));
        const double error = field.value((index + 0.5) / static_cast<double>(n)) - marschner_lobb(p);
        sum += error * error;
    }
    return std::sqrt(sum / count);
}

TEST(Filters, MarschnerLobb) {
    struct Row {
        Filter filter;
        double at_41;
        double at_81;
    };
    for (const auto& [filter, at_41, at_81] :
         {Row{Filter::trilinear, 3.16e-2, 9.14e-3}, Row{Filter::catmull_rom, 2.19e-2, 2.17e-3},
          Row{Filter::bspline, 4.40e-2, 1.58e-2}, Row{Filter::bspline_prefiltered, 1.32e-2, 3.38e-4}}) {
        EXPECT_NEAR(rms_of_marschner_lobb(41, filter) / at_41, 1.0, 0.02);
        EXPECT_NEAR(rms_of_marschner_lobb(81, filter) / at_81, 1.0, 0.02);
    }
}

TEST(Filters, BiasOnASquare) {
    const int n = 40;
    const glm::dvec3 middle(19.3, 20.1, 18.8);
    const auto f = [&](const glm::dvec3& x) { return glm::dot(x - middle, x - middle); };
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(15.0, 24.0);
    for (const Filter filter :
         {Filter::trilinear, Filter::bspline, Filter::bspline_prefiltered, Filter::catmull_rom}) {
        const Field field = sampled(n, filter, f);
        const Bounds bias = square_bias(filter, 1.0);
        double greatest = -1.0;
        for (int i = 0; i < 2000; ++i) {
            const glm::dvec3 x(unit(random), unit(random), unit(random));
            const double error = field.value((x + 0.5) / static_cast<double>(n)) - f(x);
            // The prefilter feels the edge as (2 - sqrt 3)^distance: 1e-6 here, times the slope there.
            const double slack = filter == Filter::bspline_prefiltered ? 1e-6 : 1e-11;
            EXPECT_GE(error, bias.low - slack);
            EXPECT_LE(error, bias.high + slack);
            greatest = std::max(greatest, error);
        }
        EXPECT_GT(greatest, 0.9 * bias.high - 1e-6);
    }
}

TEST(Filters, PassThroughTheVoxels) {
    for (const glm::ivec3& dims : {glm::ivec3(7, 5, 6), glm::ivec3(1, 2, 3), glm::ivec3(1)}) {
        const std::vector<double> samples = noise(dims);
        for (const Edge edge : {Edge::clamp, Edge::mirror}) {
            for (const Filter filter : all_filters) {
                const Field field(dims, samples, filter, glm::dmat4(1.0), edge);
                double worst = 0.0;
                std::size_t i = 0;
                for (int z = 0; z < dims.z; ++z) {
                    for (int y = 0; y < dims.y; ++y) {
                        for (int x = 0; x < dims.x; ++x) {
                            const glm::dvec3 t = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(dims);
                            worst = std::max(worst, std::abs(field.value(t) - samples[i++]));
                        }
                    }
                }
                if (filter == Filter::bspline && dims.x > 1) {
                    EXPECT_GT(worst, 0.1);
                } else if (filter != Filter::bspline) {
                    EXPECT_LE(worst, 1e-14);
                }
            }
        }
    }
}

TEST(Filters, ClampToTheEdge) {
    const Field field(glm::ivec3(4), noise(glm::ivec3(4)), Filter::trilinear);
    EXPECT_DOUBLE_EQ(field.value({0.0, 0.4, 0.6}), field.value({0.125, 0.4, 0.6}));
    EXPECT_DOUBLE_EQ(field.value({1e30, 0.4, 0.6}), field.value({0.875, 0.4, 0.6}));
    EXPECT_DOUBLE_EQ(field.value({-0.3, 0.4, 0.6}), field.value({0.125, 0.4, 0.6}));
}

TEST(Filters, GradientsAreTheSlopeOfTheValue) {
    const glm::ivec3 dims(6, 9, 7);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.1, 0.9);
    for (const Filter filter : all_filters) {
        const Field field(dims, noise(dims), filter);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 t(unit(random), unit(random), unit(random));
            const glm::dvec3 g = field.gradient(t);
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 h(0.0);
                h[axis] = 1e-6;
                const double cell =
                    std::floor(t[axis] * dims[axis] - (filter == Filter::nearest ? 0.0 : 0.5));
                const double there =
                    std::floor((t + h)[axis] * dims[axis] - (filter == Filter::nearest ? 0.0 : 0.5));
                const double here =
                    std::floor((t - h)[axis] * dims[axis] - (filter == Filter::nearest ? 0.0 : 0.5));
                if (cell == there && cell == here) {  // not across a kink
                    EXPECT_NEAR(g[axis], (field.value(t + h) - field.value(t - h)) / 2e-6, 1e-7);
                }
            }
        }
    }
}

TEST(Filters, CentralDifferenceOfALinearFieldIsExactInTheWorld) {
    VolumeGrid grid;
    grid.dims = {8, 6, 10};
    grid.spacing_mm = {0.5, 2.0, 1.25};
    grid.origin_mm = {3.0, -1.0, 7.0};
    grid.direction = glm::dmat3(0.0, -1.0, 0.0, 0.6, 0.0, 0.8, 0.2, 0.0, 1.0);  // turned, mirrored, sheared
    const glm::dmat4 to_world = texture_to_world_of(grid);
    const glm::dvec3 slope(0.3, -0.7, 1.1);
    std::vector<double> samples;
    for (int z = 0; z < grid.dims.z; ++z) {
        for (int y = 0; y < grid.dims.y; ++y) {
            for (int x = 0; x < grid.dims.x; ++x) {
                const glm::dvec3 t = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(grid.dims);
                samples.push_back(glm::dot(slope, glm::dvec3(to_world * glm::dvec4(t, 1.0))));
            }
        }
    }
    // Voxel 0's centre is the origin, and voxel i + 1 lies a spacing along direction's column i.
    const glm::dvec3 first(to_world * glm::dvec4(0.5 / glm::dvec3(grid.dims), 1.0));
    EXPECT_LE(glm::length(first - grid.origin_mm), 1e-14);
    const Field field(grid.dims, samples, Filter::trilinear, to_world);
    const glm::dvec3 t(0.41, 0.52, 0.37);
    EXPECT_LE(glm::length(field.to_world_gradient(field.gradient(t)) - slope), 1e-12);
    EXPECT_LE(glm::length(field.to_world_gradient(field.central_difference(t)) - slope), 1e-12);
    const glm::dmat4 model = glm::scale(glm::dmat4(1.0), {2.0, -3.0, 0.5});
    const Field moved = field.moved(model);
    EXPECT_LE(glm::length(moved.to_world_gradient(moved.gradient(t)) - slope / glm::dvec3(2.0, -3.0, 0.5)),
              1e-12);
}

TEST(Fields, DecodeEveryScalarType) {
    Volume volume;
    volume.grid.dims = {3, 1, 1};
    volume.slope = 2.0;
    volume.intercept = -1000.0;
    const auto store = [&](auto... values) {
        const std::array data{values...};
        volume.voxels.resize(sizeof(data));
        std::memcpy(volume.voxels.data(), data.data(), sizeof(data));
    };
    volume.type = ScalarType::i16;
    store(std::int16_t{-3}, std::int16_t{0}, std::int16_t{3000});
    EXPECT_EQ(decoded(volume), (std::vector<double>{-1006.0, -1000.0, 5000.0}));
    volume.type = ScalarType::u8;
    store(std::uint8_t{255}, std::uint8_t{0}, std::uint8_t{7});
    EXPECT_EQ(decoded(volume), (std::vector<double>{-490.0, -1000.0, -986.0}));
    volume.type = ScalarType::f32;
    store(0.5F, std::nanf(""), 1.0F);
    EXPECT_EQ(decoded(volume), (std::vector<double>{-999.0, -999.0, -998.0}));
    EXPECT_EQ(decoded(volume, 0, -7.0)[1], -7.0);
    volume.channels = 3;
    volume.grid.dims = {1, 1, 1};
    EXPECT_EQ(decoded(volume, 2), (std::vector<double>{-998.0}));
}

TEST(Profiles, PiecesAreTheFieldWithoutGaps) {
    const glm::ivec3 dims(9, 6, 7);
    glm::dmat4 to_world = glm::scale(glm::dmat4(1.0), {9.0, 12.0, 3.5});
    to_world[1][0] = 2.0;  // shear
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const Filter filter : all_filters) {
        const Field field(dims, noise(dims), filter, to_world);
        for (int i = 0; i < 60; ++i) {
            glm::dvec3 direction(unit(random), unit(random), unit(random));
            direction[i % 3] *= i % 4 == 0 ? 0.0 : 1.0;  // some parallel to a face
            const glm::dvec3 aim(to_world * glm::dvec4(0.5 + 0.4 * unit(random), 0.5, 0.5, 1.0));
            Ray ray{aim, glm::normalize(direction)};
            ray.origin_mm -= 30.0 * ray.direction;
            const Interval interval = *intersect(ray, to_world);
            double last = interval.begin;
            visit_pieces(field, ray, interval, [&](const Piece& piece) {
                EXPECT_EQ(piece.s.begin, last);
                last = piece.s.end;
                for (const double u : {-0.9, -0.2, 0.55, 0.93}) {
                    if (piece.s.length() > 1e-6) {
                        EXPECT_NEAR(piece.value(u), value_at(field, ray, piece.s_of(u)), 1e-12);
                    }
                }
                return true;
            });
            EXPECT_EQ(last, interval.end);
        }
    }
}

TEST(Rays, MeetTheBox) {
    const glm::dmat4 box = glm::scale(glm::translate(glm::dmat4(1.0), {1.0, 2.0, 3.0}), {4.0, -5.0, 6.0});
    const Ray ray{{-2.0, 0.0, 4.0}, {1.0, 0.0, 0.0}};
    const Interval whole = *intersect(ray, box);
    EXPECT_DOUBLE_EQ(whole.begin, 3.0);
    EXPECT_DOUBLE_EQ(whole.end, 7.0);
    Limits limits;
    limits.crop_min = {0.25, 0.0, 0.0};
    limits.clip_planes.emplace_back(-2.0, 0.0, 0.0, 8.0);  // x <= 4
    const Interval cut = *intersect(ray, box, limits);
    EXPECT_DOUBLE_EQ(cut.begin, 4.0);
    EXPECT_DOUBLE_EQ(cut.end, 6.0);
    limits.far_mm = 5.0;
    EXPECT_DOUBLE_EQ(intersect(ray, box, limits)->end, 5.0);
    EXPECT_DOUBLE_EQ(intersect({{2.0, 0.0, 4.0}, {1.0, 0.0, 0.0}}, box)->begin, 0.0);  // eye inside
    EXPECT_FALSE(intersect({{-2.0, 2.5, 4.0}, {1.0, 0.0, 0.0}}, box));                 // parallel, outside
    EXPECT_TRUE(intersect({{-2.0, 2.0, 4.0}, {1.0, 0.0, 0.0}}, box));                  // in a face
    EXPECT_FALSE(intersect({{8.0, 0.0, 4.0}, {1.0, 0.0, 0.0}}, box));                  // behind
    limits.crop_max.x = 0.25;
    EXPECT_FALSE(intersect(ray, box, limits));
}

TEST(Rays, GoThroughTheirPixels) {
    CameraParams camera;
    camera.eye_mm = {120.0, -300.0, 80.0};
    camera.target_mm = {5.0, 3.0, -2.0};
    std::vector<View> views;
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic, CameraKind::c_arm}) {
        camera.kind = kind;
        views.push_back(make_view(camera, 1.5));
    }
    views.push_back(views.front());
    views.back().projection = glm::frustumRH_NO(-0.2, 0.7, -0.3, 0.1, 1.0, 1000.0);  // off-axis
    views.push_back(views[1]);
    views.back().projection = glm::orthoRH_NO(-30.0, 70.0, -50.0, 10.0, 1.0, 1000.0);
    for (const View& view : views) {
        for (const auto& [x, y] : {std::pair(0, 0), std::pair(29, 19), std::pair(11, 3)}) {
            const Ray ray = pixel_ray(view, x, y, 30, 20);
            EXPECT_NEAR(glm::length(ray.direction), 1.0, 1e-14);
            for (const double s : {10.0, 500.0}) {
                const glm::dvec4 clip = view.view_projection() * glm::dvec4(ray.at(s), 1.0);
                EXPECT_NEAR(clip.x / clip.w, 2.0 * (x + 0.5) / 30.0 - 1.0, 1e-10);
                EXPECT_NEAR(clip.y / clip.w, 2.0 * (y + 0.5) / 20.0 - 1.0, 1e-10);
            }
            // s is counted from the eye, or from its plane.
            EXPECT_NEAR(glm::dot(ray.origin_mm - view.eye_mm, view.forward), 0.0, 1e-9);
            EXPECT_GT(glm::dot(ray.direction, view.forward), 0.0);
        }
    }
}

TEST(Pictures, DoNotDependOnThreads) {
    const View view = make_view({}, 1.0);
    const Field field(glm::ivec3(5), noise(glm::ivec3(5)), Filter::trilinear,
                      glm::scale(glm::dmat4(1.0), glm::dvec3(80.0)));
    const auto colour = [&](const Ray& ray, const Interval& interval) {
        return glm::dvec4(value_at(field, ray, interval.begin), interval.begin, interval.end, 1.0);
    };
    const Buffer one = render(view, 31, 17, field, {}, colour, glm::dvec4(-1.0), 1);
    const Buffer two = render(view, 31, 17, field, {}, colour, glm::dvec4(-1.0), 2);
    EXPECT_EQ(one.data, two.data);
    EXPECT_EQ(one.at(0, 0, 3), -1.0);
    EXPECT_EQ(one.at(17, 9, 3), 1.0);
    EXPECT_THROW((void)render(
                     view, 4, 4, [](const Ray&) -> glm::dvec4 { throw std::runtime_error("ray"); }, 2),
                 std::runtime_error);
}

}  // namespace
}  // namespace viscera::reference
