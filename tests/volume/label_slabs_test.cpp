// Pre-integration in segments, beside integrals in double precision.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/reference/volume_exact.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int slab_voxels = 16;
constexpr double spacing_mm = 5.0;
constexpr double wall_mm = 10.0;  // where the segments meet: y, between voxels of the labels

json points_of(const TransferFunction& function) {
    json points = json::array();
    for (const TransferPoint& p : function.points) {
        points.push_back(
            {{"value", p.value}, {"colour", {p.colour.r, p.colour.g, p.colour.b}}, {"opacity", p.opacity}});
    }
    return points;
}

/// Narrow teeth between which there is nothing.
TransferFunction comb(int teeth, double opacity, const glm::dvec3& colour) {
    TransferFunction function{.reference_length_mm = 1.0};
    for (int i = 0; i < teeth; ++i) {
        const double low = (i + 0.4) / teeth;
        const double high = low + 0.08 / teeth;
        for (const auto& [value, a] : {std::pair{low, 0.0}, {low, opacity}, {high, opacity}, {high, 0.0}}) {
            function.points.push_back({value, colour, a});
        }
    }
    return function;
}

TransferFunction smooth() {
    return {.points = {{0.0, {0.2, 0.3, 0.9}, 0.001}, {1.0, {0.9, 0.7, 0.2}, 0.03}},
            .reference_length_mm = 1.0};
}

class LabelSlabs : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }

    Shot shot(const json& parameters) {
        const std::array<HostVolume, 2> given{HostVolume{"host", &volume_}, HostVolume{"labels", &labels_}};
        stage_.make_current();
        stage_.load(mixed_scene(json::array(), parameters, to_json(look_), 32, 32));
        stage_.renderer().keep({"volume.colour"});
        Frame frame = stage_.renderer().still(0.0);
        frame.volumes = given;
        stage_.renderer().render(frame);
        return {stage_.renderer().read("volume.colour"), frame.eye()};
    }

    /// Below the wall `low` holds, above it `high`. `across`: rays that pass it, or all others.
    Miss miss_of(const Shot& shot, const reference::Medium& low, const reference::Medium& high,
                 bool across) const {
        const reference::Field field(volume_.volume(), reference::Filter::trilinear);
        return miss(shot, [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
            const auto interval = reference::intersect(
                ray, field.texture_to_world(),
                {.crop_min = glm::dvec3(1.0 / slab_voxels), .crop_max = glm::dvec3(1.0 - 1.0 / slab_voxels)});
            if (!interval) {
                return std::nullopt;
            }
            const double wall = (wall_mm - ray.origin_mm.y) / ray.direction.y;
            const bool passes = wall > interval->begin && wall < interval->end;
            if (passes != across) {
                return std::nullopt;
            }
            const bool begins_low = ray.at(interval->begin).y < wall_mm;
            const double split = passes ? wall : interval->end;
            const reference::Light first =
                reference::composite(field, ray, {interval->begin, split}, begins_low ? low : high);
            const reference::Light second =
                passes ? reference::composite(field, ray, {split, interval->end}, begins_low ? high : low)
                       : reference::Light{};
            return glm::dvec4(first.colour + first.transmittance * second.colour,
                              1.0 - first.transmittance * second.transmittance);
        });
    }

    static json parameters(const TransferFunction& function, const json& segment, std::string_view scheme,
                           double step) {
        json second = segment;
        second["id"] = 2;
        return {
            {"transfer_function",
             {{"points", points_of(function)}, {"entries", 16384}, {"interpolate", true}}},
            {"labels", {{"host", "labels"}, {"segments", {second}}}},
            // Without the faces, at which the ramp bends.
            {"crop", {{"first", {1, 1, 1}}, {"size", {slab_voxels - 2, slab_voxels - 2, slab_voxels - 2}}}},
            {"sampling",
             {{"scheme", scheme}, {"step", step}, {"termination", 0}, {"filter", "linear_fp32"}}}};
    }

    Stage stage_;
    /// A slanted ramp from 0 to 1.
    LiveVolume volume_{float_volume(glm::ivec3(slab_voxels), glm::dvec3(spacing_mm), [](const glm::dvec3& p) {
        return std::clamp(0.5 + 0.0072 * p.y + 0.004 * p.z + 0.002 * p.x, 0.0, 1.0);
    })};
    LiveVolume labels_{
        byte_volume(slab_voxels, spacing_mm, [](const glm::dvec3& p) { return p.y > wall_mm ? 2.0 : 1.0; })};
    Look look_{.eye_mm = {40, -330, 90}, .fov_deg = 16};
};

/// Teeth in either segment: their places, colours and depths differ.
TEST_F(LabelSlabs, EachSegmentIsIntegratedByItsOwnFunction) {
    const TransferFunction front = comb(7, 0.3, {0.9, 0.6, 0.3});
    const TransferFunction rear = comb(11, 0.2, {0.2, 0.7, 0.9});
    const json segment{{"points", points_of(rear)}};
    for (const double step : {1.0, 0.5, 0.25}) {
        const Shot pre = shot(parameters(front, segment, "preintegrated", step));
        const Shot post = shot(parameters(front, segment, "gauss", step));
        std::printf("  step %.2f:", step);
        for (const bool across : {false, true}) {
            const Miss a = miss_of(pre, reference::Medium(front), reference::Medium(rear), across);
            const Miss b = miss_of(post, reference::Medium(front), reference::Medium(rear), across);
            std::printf(" %s preintegrated %.1e, gauss %.1e rms", across ? "across" : "within", a.rms, b.rms);
            EXPECT_GT(a.pixels, 200);
            // A tooth that stands on the border may be taken or left: 0.29 slabs of it.
            EXPECT_LT(a.rms, (across ? 0.2 : 1e-3) * b.rms);
        }
        std::printf("\n");
    }
}

/// A border lies within 0.29 slabs of its place: that much of the difference of both extinctions, at most.
TEST_F(LabelSlabs, BordersErrByAShareOfASlab) {
    const reference::Medium low(smooth());
    const reference::Medium high({0.0, 1.0}, [&low](double value) {
        reference::Emission e = low.at(value);
        return reference::Emission{3.0 * e.extinction, glm::mix(e.colour, glm::dvec3(0.1, 0.9, 0.4), 0.5)};
    });
    const double most = -2.0 * std::log1p(-0.03);  // difference of extinctions [1/mm]
    const json segment{{"opacity_factor", 3.0}, {"colour", {0.1, 0.9, 0.4}}, {"colour_weight", 0.5}};
    for (const double step : {1.0, 0.5, 0.25}) {
        const Shot pre = shot(parameters(smooth(), segment, "preintegrated", step));
        const Miss across = miss_of(pre, low, high, true);
        const Miss within = miss_of(pre, low, high, false);
        const double slab_mm = 2.0 * step * spacing_mm;  // two samples each
        std::printf("  step %.2f: %.1e across, %.1e within one segment\n", step, across.worst, within.worst);
        EXPECT_GT(within.pixels, 20);
        // The opacity knows of the function between knots what a parabola does: the rest is the trilinear
        // field's kinks.
        EXPECT_LE(across.worst, 0.29 * slab_mm * most + 2e-3);
        EXPECT_LE(within.worst, 2e-3);
    }
}

/// Labels that change nothing leave the picture as it is, and so does skipping.
TEST_F(LabelSlabs, LabelsWithoutLooksAndSkippingChangeNothing) {
    const TransferFunction front = comb(7, 0.3, {0.9, 0.6, 0.3});
    json p = parameters(front, json::object(), "preintegrated", 0.5);
    const Shot with = shot(p);
    json plain = p;
    plain.erase("labels");
    EXPECT_LE(difference(with.image, shot(plain).image).max, 2e-6);
    p["labels"]["segments"] = {{{"id", 1}, {"points", points_of(comb(5, 0.4, {0.3, 0.9, 0.3}))}},
                               {{"id", 2}, {"visible", false}}};
    const Shot skipped = shot(p);
    EXPECT_GT(difference(with.image, skipped.image).max, 0.05);
    p["sampling"]["skip"] = false;
    EXPECT_TRUE(same_bits(skipped, shot(p)));
}

}  // namespace
}  // namespace viscera::test
