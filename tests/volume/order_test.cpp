// Orders of the integrator on smooth fields that stand in the shader, held against closed forms.

#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/reference/volume_exact.h"
#include "tests/reference/volume_forms.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

constexpr double order_side_mm = 100.0;
const std::vector<double> order_counts{8, 16, 32, 64};  // samples per ray

/// Rms over rows of each row's mean error: fields change little along a row, so that rounding, which differs
/// from pixel to pixel and would hide the integrator's own error from some 1e-7 on, averages out.
double systematic_error(const Shot& shot, const WantedColour& wanted) {
    double sum = 0.0;
    for (int y = 0; y < shot.image.height; ++y) {
        glm::dvec4 row(0.0);
        for (int x = 0; x < shot.image.width; ++x) {
            row += shot.at(x, y) - wanted(shot.ray(x, y)).value();
        }
        row /= shot.image.width;
        sum += glm::dot(row, row);
    }
    return std::sqrt(sum / (4.0 * shot.image.height));
}

/// Errors of pictures whose rays all run the length of the box along z, with that many samples.
std::vector<double> errors(VolumeStage& stage, std::string_view scheme, std::string_view function,
                           const WantedColour& wanted, std::vector<double>* worst = nullptr) {
    constexpr int voxels = 8;
    const LiveVolume volume(float_volume(glm::ivec3(voxels), glm::dvec3(order_side_mm / voxels),
                                         [](const glm::dvec3& p) { return p.z; }));
    std::vector<double> found;
    for (const double n : order_counts) {
        const nlohmann::json parameters{
            {"function", function},
            {"transfer_function", {{"points", {{{"value", 0}, {"opacity", 0.5}}}}}},
            {"xray", {{"negative", false}, {"water_attenuation_per_mm", 1.0}}},
            {"sampling", {{"scheme", scheme}, {"step", voxels / n}, {"termination", 0}, {"skip", false}}}};
        const Look look{.eye_mm = {0, 0, -300}, .up = {0, 1, 0}, .orthographic_mm = 0.9 * order_side_mm};
        const Shot shot = stage.cast(volume, parameters, look, glm::ivec2(24));
        const Miss m = miss(shot, wanted);
        EXPECT_EQ(m.pixels, 24 * 24);
        found.push_back(systematic_error(shot, wanted));
        if (worst != nullptr) {
            worst->push_back(m.worst);
        }
        std::printf("  %-9s %-9s n %3.0f  systematic %.2e  worst %.2e\n", std::string(function).c_str(),
                    std::string(scheme).c_str(), n, found.back(), m.worst);
    }
    return found;
}

/// Emission and absorption of a ramp whose start and slope differ from ray to ray; it rises for some, falls
/// for others.
class RampOrder : public testing::Test {
  protected:
    static constexpr double k = 0.05;
    static reference::Ramp ramp(const reference::Ray& ray) {
        const double x = ray.origin_mm.x / order_side_mm;
        const double y = ray.origin_mm.y / order_side_mm;
        const double slope = 1.3 * y / order_side_mm;
        return {.s0 = 1.0 + 0.5 * x - 0.5 * order_side_mm * slope,
                .g = slope,
                .length = order_side_mm,
                .k = k,
                .c0 = 0.1,
                .c1 = 0.4};
    }
    static std::optional<glm::dvec4> wanted(const reference::Ray& ray) {
        const reference::RampLight light = reference::ramp_light(ramp(ray));
        return glm::dvec4(glm::dvec3(light.colour), 1.0 - std::exp(-light.tau));
    }
    VolumeStage stage_{
        {{"volume/sample.glsl",
          field_text("float field(vec3 p) { return 1.0 + 0.005 * p.x + 1.3e-4 * p.y * p.z; }",
                     glm::dvec3(order_side_mm))},
         {"volume/classify.glsl",
          classify_text("vec4 classify(float v) { return vec4(vec3(0.1 + 0.4 * v), 0.05 * v); }")}}};
};

TEST_F(RampOrder, GaussIsOfFourthOrder) {
    std::vector<double> worst;
    const std::vector<double> e = errors(stage_, "gauss", "composite", wanted, &worst);
    EXPECT_GE(order_of(order_counts, e), 3.8);
    EXPECT_LE(worst.back(), 2e-6);
}

TEST_F(RampOrder, MidpointIsOfSecondOrder) {
    const std::vector<double> e = errors(stage_, "midpoint", "composite", wanted);
    EXPECT_NEAR(order_of(order_counts, e), 2.0, 0.05);
}

/// Part of a Gaussian ball: the box cuts it off, or its tails would make any scheme look better than its
/// order. It glows the brighter, the denser it is.
class GaussianOrder : public testing::Test {
  protected:
    static constexpr double amplitude = 0.15;
    static constexpr double sigma = 33.0;
    static constexpr glm::dvec3 centre{8.0, -5.0, 21.0};

    static reference::Interval across(const reference::Ray& ray) {
        const double from = -0.5 * order_side_mm - ray.origin_mm.z;
        return {from, from + order_side_mm};
    }
    static std::optional<glm::dvec4> wanted(const reference::Ray& ray) {
        const glm::dmat4 box = glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(-0.5 * order_side_mm)),
                                          glm::dvec3(order_side_mm));
        const auto value = [](const glm::dvec3& p) {
            return amplitude * std::exp(-0.5 * glm::dot(p - centre, p - centre) / (sigma * sigma));
        };
        static const reference::Field field = reference::Field::in_world(value, {}, box);
        static const reference::Medium medium({}, [](double v) {
            return reference::Emission{v, glm::dvec3(v / amplitude, 0.5, 1.0 - v / amplitude)};
        });
        const reference::Light light = reference::composite(field, ray, across(ray), medium);
        // The reference integrates; what it lets through has a closed form, too.
        const double depth = reference::gaussian_integral(ray, across(ray), centre, amplitude, sigma);
        EXPECT_NEAR(light.transmittance, std::exp(-depth), 1e-10);
        return light.rgba();
    }
    VolumeStage stage_{
        {{"volume/sample.glsl",
          field_text("float field(vec3 p) { vec3 q = p - " + glsl(centre) + "; return " + glsl(amplitude) +
                         " * exp(-0.5 * dot(q, q) / " + glsl(sigma * sigma) + "); }",
                     glm::dvec3(order_side_mm))},
         {"volume/classify.glsl", classify_text("vec4 classify(float v) { float s = v / " + glsl(amplitude) +
                                                "; return vec4(s, 0.5, 1.0 - s, v); }")}}};
};

TEST_F(GaussianOrder, GaussIsOfFourthOrder) {
    std::vector<double> worst;
    const std::vector<double> e = errors(stage_, "gauss", "composite", wanted, &worst);
    EXPECT_GE(order_of(order_counts, e), 3.8);
    EXPECT_LE(worst.back(), 2e-6);
}

TEST_F(GaussianOrder, MidpointIsOfSecondOrder) {
    EXPECT_NEAR(order_of(order_counts, errors(stage_, "midpoint", "composite", wanted)), 2.0, 0.05);
}

}  // namespace
}  // namespace viscera::test
