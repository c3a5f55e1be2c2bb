// Transfer functions with narrow teeth: what pre-integration is for; and what it may cost on smooth ones.

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "tests/reference/volume_exact.h"
#include "tests/reference/volume_forms.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

constexpr double comb_side_mm = 100.0;
constexpr int comb_voxels = 16;
const std::vector<double> comb_counts{16, 32, 64, 128, 256, 512, 1024};  // samples per ray

/// Rays along z through a ramp that differs a little from ray to ray, from 0 to 1.
constexpr std::string_view ramp =
    "float field(vec3 p) { return 0.5 + 0.0093 * p.z + 0.0002 * p.x + 0.0005 * p.y; }";
double ramp_at(const reference::Ray& ray, double z) {
    return 0.5 + 0.0093 * z + 0.0002 * ray.origin_mm.x + 0.0005 * ray.origin_mm.y;
}

/// The table's range is the host volume's.
LiveVolume unit_range() {
    return LiveVolume(float_volume(
        glm::ivec3(comb_voxels), glm::dvec3(comb_side_mm / comb_voxels), [](const glm::dvec3& p) {
            return std::clamp(p.z / (comb_side_mm * (1.0 - 1.0 / comb_voxels)) + 0.5, 0.0, 1.0);
        }));
}

struct CombErrors {
    std::vector<double> rms;
    std::vector<double> worst;
};

CombErrors errors(VolumeStage& stage, std::string_view scheme, const nlohmann::json& points,
                  const WantedColour& wanted, std::span<const double> n) {
    const LiveVolume volume = unit_range();
    CombErrors found;
    for (const double count : n) {
        const nlohmann::json parameters{
            {"transfer_function", {{"points", points}, {"entries", 16384}, {"interpolate", true}}},
            {"sampling",
             {{"scheme", scheme}, {"step", comb_voxels / count}, {"termination", 0}, {"skip", false}}}};
        const Look look{.eye_mm = {0, 0, -300}, .up = {0, 1, 0}, .orthographic_mm = 0.9 * comb_side_mm};
        const Miss m = miss(stage.cast(volume, parameters, look, glm::ivec2(16)), wanted);
        found.rms.push_back(m.rms);
        found.worst.push_back(m.worst);
    }
    return found;
}

double geometric_mean_of_ratios(const CombErrors& a, const CombErrors& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.rms.size(); ++i) {
        sum += std::log(a.rms[i] / b.rms[i]);
    }
    return std::exp(sum / static_cast<double>(a.rms.size()));
}

void print(const char* name, const CombErrors& e) {
    std::printf("  %-14s", name);
    for (const double error : e.rms) {
        std::printf(" %.1e", error);
    }
    std::printf("\n");
}

TEST(CombFunction, PreintegrationIsAHundredTimesNearer) {
    constexpr int teeth = 20;
    constexpr double opacity = 0.3;  // per mm
    const double k = -std::log1p(-opacity);
    nlohmann::json points = nlohmann::json::array();
    std::vector<reference::Tooth> comb;
    const nlohmann::json colour{0.9, 0.6, 0.3};
    const auto knot = [&](double value, double a) {
        points.push_back({{"value", value}, {"colour", colour}, {"opacity", a}});
    };
    knot(0.0, 0.0);
    for (int i = 0; i < teeth; ++i) {
        const double low = (i + 0.37) / teeth;
        const double high = low + 0.06 / teeth;
        knot(low, 0.0);
        knot(low, opacity);
        knot(high, opacity);
        knot(high, 0.0);
        comb.push_back({low, high});
    }
    const auto wanted = [&](const reference::Ray& ray) {
        const double s0 = ramp_at(ray, -0.5 * comb_side_mm);
        const double s1 = ramp_at(ray, 0.5 * comb_side_mm);
        const double tau = reference::comb_depth(
            {.s0 = s0, .g = (s1 - s0) / comb_side_mm, .length = comb_side_mm, .k = k}, comb);
        const double alpha = 1.0 - std::exp(-tau);
        return std::optional(glm::dvec4(alpha * glm::dvec3(0.9, 0.6, 0.3), alpha));
    };
    VolumeStage stage({{"volume/sample.glsl", field_text(ramp, glm::dvec3(comb_side_mm))}});
    const CombErrors pre = errors(stage, "preintegrated", points, wanted, comb_counts);
    print("preintegrated", pre);
    for (const char* scheme : {"midpoint", "gauss"}) {
        const CombErrors post = errors(stage, scheme, points, wanted, comb_counts);
        print(scheme, post);
        const double ratio = geometric_mean_of_ratios(post, pre);
        std::printf("  %s errs %.0f times as much\n", scheme, ratio);
        EXPECT_GE(ratio, 100.0);
    }
}

/// Smooth functions of value, and fields that are smooth along the ray but not straight.
TEST(CombFunction, PreintegrationCostsLittleOnSmoothFunctions) {
    struct Case {
        const char* name;
        std::string field;
        reference::Field::Value value;
    };
    const std::array cases{
        Case{"ramp", std::string(ramp),
             [](const glm::dvec3& p) { return 0.5 + 0.0093 * p.z + 0.0002 * p.x + 0.0005 * p.y; }},
        Case{"wave", "float field(vec3 p) { return 0.5 + 0.3 * sin(0.06 * p.z + 0.02 * p.x) + 0.002 * p.y; }",
             [](const glm::dvec3& p) { return 0.5 + 0.3 * std::sin(0.06 * p.z + 0.02 * p.x) + 0.002 * p.y; }},
        Case{"hill", "float field(vec3 p) { return 0.9 * exp(-0.0008 * dot(p, p)); }",
             [](const glm::dvec3& p) { return 0.9 * std::exp(-0.0008 * glm::dot(p, p)); }}};
    // Smooth to the eye: knots so near that the corners between them do not show.
    TransferFunction function;
    nlohmann::json points = nlohmann::json::array();
    for (int i = 0; i <= 64; ++i) {
        const double v = i / 64.0;
        const glm::dvec3 colour(v, 1.0 - v, 0.5 + 0.5 * std::sin(3.0 * v));
        const double opacity = 0.04 * (0.2 + v * v);
        function.points.push_back({v, colour, opacity});
        points.push_back({{"value", v}, {"colour", {colour.r, colour.g, colour.b}}, {"opacity", opacity}});
    }
    const reference::Medium medium(function);
    const std::vector<double> n{16, 32, 64, 128};
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const glm::dmat4 box(glm::dvec4(comb_side_mm, 0, 0, 0), glm::dvec4(0, comb_side_mm, 0, 0),
                             glm::dvec4(0, 0, comb_side_mm, 0),
                             glm::dvec4(glm::dvec3(-0.5 * comb_side_mm), 1));
        const reference::Field field = reference::Field::in_world(c.value, {}, box);
        // The rays are the same in all pictures.
        std::map<std::pair<double, double>, glm::dvec4> known;
        const auto wanted = [&](const reference::Ray& ray) {
            const auto [at, is_new] = known.try_emplace({ray.origin_mm.x, ray.origin_mm.y});
            if (is_new) {
                at->second =
                    reference::composite(field, ray, reference::intersect(ray, box).value(), medium).rgba();
            }
            return std::optional(at->second);
        };
        VolumeStage stage({{"volume/sample.glsl", field_text(c.field, glm::dvec3(comb_side_mm))}});
        const CombErrors pre = errors(stage, "preintegrated", points, wanted, n);
        const CombErrors post = errors(stage, "midpoint", points, wanted, n);
        const CombErrors gauss = errors(stage, "gauss", points, wanted, n);
        std::printf("  %s\n", c.name);
        print("preintegrated", pre);
        print("midpoint", post);
        print("gauss", gauss);
        for (std::size_t i = 0; i < n.size(); ++i) {
            EXPECT_LE(pre.rms[i], 1.1 * post.rms[i] + 1e-7) << n[i];
        }
    }
}

}  // namespace
}  // namespace viscera::test
