#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "effects/volume/classic.h"
#include "effects/volume/clip.h"
#include "effects/volume/colours.h"
#include "effects/volume/labels.h"
#include "effects/volume/light_volume.h"
#include "effects/volume/overlay.h"
#include "effects/volume/transfer_params.h"
#include "engine/core/error.h"

// What places look like, without OpenGL.
namespace viscera::volume {
namespace {

template <class T>
Volume volume_of(const glm::ivec3& dims, ScalarType type, const std::vector<T>& stored) {
    Volume volume;
    volume.grid.dims = dims;
    volume.type = type;
    volume.voxels.resize(stored.size() * sizeof(T));
    std::memcpy(volume.voxels.data(), stored.data(), volume.voxels.size());
    return volume;
}

std::string message_of(auto&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(TransferChoice, unknown_presets_are_told_which_there_are) {
    TransferParams params;
    params.preset = "ct-bine";
    const std::string windows = message_of([&] { params.validate(); });
    EXPECT_NE(windows.find("ct-bone"), std::string::npos) << windows;
    params.file.path = "presets.json";
    const std::vector<TransferFunction> presets{TransferFunction{.name = "one"},
                                                TransferFunction{.name = "two"}};
    const std::string names = message_of([&] { (void)chosen_function(params, presets); });
    EXPECT_NE(names.find("one, two"), std::string::npos) << names;
    params.preset = "two";
    EXPECT_EQ(chosen_function(params, presets).name, "two");
    params.preset.clear();
    EXPECT_NE(message_of([&] { (void)chosen_function(params, presets); }), "");
    EXPECT_EQ(chosen_function(params, std::span(presets).first(1)).name, "one");
}

TEST(TransferChoice, only_one_source) {
    TransferParams params;
    params.window = WindowLevel{};
    EXPECT_NO_THROW(params.validate());
    params.preset = "ct-bone";
    EXPECT_THROW(params.validate(), Error);
}

TEST(TransferChoice, knots_are_stretched_and_turned_round) {
    TransferParams params;
    params.points = {{0.0, glm::dvec3(0.0), 0.1}, {0.25, glm::dvec3(0.5), 0.2}, {1.0, glm::dvec3(1.0), 0.3}};
    params.range = glm::dvec2(-100.0, 300.0);
    EXPECT_EQ(chosen_function(params, {}).points[1].value, 0.0);
    params.range = glm::dvec2(300.0, -100.0);
    const TransferFunction turned = chosen_function(params, {});
    EXPECT_EQ(turned.points[0].value, -100.0);
    EXPECT_EQ(turned.points[0].opacity, 0.3);
    EXPECT_EQ(turned.points[1].value, 200.0);
}

TEST(Clip, the_box_shrinks_to_what_is_left) {
    const glm::dmat4 to_world = {{10, 0, 0, 0}, {0, 20, 0, 0}, {0, 0, 30, 0}, {-5, -10, -15, 1}};
    const glm::dvec3 zero(0.0);
    const glm::dvec3 one(1.0);
    const ClippedBox all = clipped_box(zero, one, to_world, {});
    EXPECT_NEAR(glm::length(all.min), 0.0, 1e-12);
    EXPECT_NEAR(glm::length(all.max - one), 0.0, 1e-12);
    const std::vector<ClipPlane> half{{{0.0, 0.0, 3.0}, {0.0, 0.0, -2.0}}};
    EXPECT_NEAR(clipped_box(zero, one, to_world, half).max.z, 0.6, 1e-12);
    // Each leaves something, both together nothing.
    const std::vector<ClipPlane> apart{{{0, 0, 3}, {0, 0, 1}}, {{0, 0, 2}, {0, 0, -1}}};
    EXPECT_TRUE(clipped_box(zero, one, to_world, apart).empty());
    const std::vector<ClipPlane> beside{{{0, 0, 16}, {0, 0, 1}}};
    EXPECT_TRUE(clipped_box(zero, one, to_world, beside).empty());
    EXPECT_FALSE(clipped_box(zero, one, to_world, std::span(apart).first(1)).empty());
}

TEST(Labels, sparse_and_negative_ids_become_dense) {
    LabelParams params;
    params.segments = {{.id = 30000, .look = {}}, {.id = -7, .look = {}}};
    std::size_t broken = 0;
    const Volume labels = volume_of<std::int16_t>({5, 1, 1}, ScalarType::i16, {0, 30000, -7, 29999, -7});
    EXPECT_EQ(dense_labels(labels, params, broken), (std::vector<std::uint16_t>{0, 1, 2, 0, 2}));
    EXPECT_EQ(broken, 0U);
    const Volume floats =
        volume_of<float>({5, 1, 1}, ScalarType::f32, {-7.0F, -7.5F, -7.5F, std::nanf(""), 30000.0F});
    EXPECT_EQ(dense_labels(floats, params, broken), (std::vector<std::uint16_t>{2, 0, 0, 0, 1}));
    EXPECT_EQ(broken, 3U);
    params.segments.push_back({.id = -7, .look = {}});
    EXPECT_THROW(params.validate(), Error);
}

TEST(Labels, looks_are_tabulated_with_their_ramps) {
    LabelParams params;
    params.others.visible = false;
    params.segments = {{.id = 1, .look = {.colour = glm::dvec3(1, 0, 0), .colour_weight = 0.25}},
                       {.id = 2, .look = {.opacity_factor = 3.0, .points = {{}}}}};
    const std::vector<glm::vec4> table = look_table(params);
    ASSERT_EQ(table.size(), 6U);
    EXPECT_EQ(table[3].x, 0.0F);
    EXPECT_EQ(table[1], glm::vec4(1.0F, 0.0F, 0.0F, 0.25F));
    EXPECT_EQ(table[4], glm::vec4(1.0F, 0.0F, 0.0F, 0.0F));
    EXPECT_EQ(table[5], glm::vec4(3.0F, 1.0F, 0.0F, 0.0F));
    EXPECT_EQ(ramps(params, {}).size(), 1U);
}

Volume block(int n, std::uint8_t value) {
    return volume_of<std::uint8_t>(
        glm::ivec3(n), ScalarType::u8,
        std::vector<std::uint8_t>(static_cast<std::size_t>(n) * static_cast<std::size_t>(n * n), value));
}

TEST(LightVolume, a_homogeneous_block_lets_through_by_its_depth) {
    const Volume volume = block(32, 100);
    const glm::dmat4 to_world = volume.grid.texture_to_world();  // 32 mm
    const ExtinctionGrid grid = extinction_grid(
        volume.grid.dims, to_world, 16, of_values(volume, 0, [](double value) { return value * 1e-3; }));
    ASSERT_EQ(grid.dims, glm::ivec3(16));
    const double cell_mm = 2.0;
    for (const double z : {0.1, 0.5, 0.9}) {
        EXPECT_NEAR(transmittance(grid, {0.5, 0.5, z}, {0.0, 0.0, 1.0}, 1e9),
                    std::exp(-0.1 * (32.0 * (1.0 - z) - cell_mm)), 1e-6);
    }
    EXPECT_NEAR(transmittance(grid, glm::dvec3(0.5), {1.0, 0.0, 0.0}, 5.0), std::exp(-0.1 * 3.0), 1e-6);
    const std::vector<glm::vec2> light = light_volume(
        grid, {.shadow = 0.5, .ambient_occlusion = 0.0, .resolution = 16}, glm::dvec4(0.0, 0.0, 1.0, 0.0));
    EXPECT_NEAR(light.front().x, 0.5 + 0.5 * std::exp(-0.1 * 29.0), 1e-6);
    EXPECT_EQ(light.front().y, 1.0F);
}

TEST(LightVolume, colours_take_light_by_their_opacity) {
    Volume colours = volume_of<std::uint16_t>({3, 1, 1}, ScalarType::u16,
                                              {65535, 0, 0, 13107, 0, 65535, 0, 13107, 65535, 0, 0, 0});
    colours.channels = 4;
    colours.slope = 1.0 / 65535.0;
    AccumulateParams params{.opacity = 128.0, .samples = 256.0};
    params.channels.resize(4);
    params.channels[1].threshold = {0.0, 0.9};
    const VoxelExtinction of = colour_extinction(colours, params, 64.0);
    // Opacity 0.2 * 0.5 in a quarter of a millimetre.
    EXPECT_NEAR(of({0, 0, 0}), -std::log(0.9) * 4.0, 1e-12);
    EXPECT_EQ(of({1, 0, 0}), 0.0);
    EXPECT_EQ(of({2, 0, 0}), 0.0);
}

TEST(LightVolume, agrees_with_brute_force) {
    std::vector<std::uint8_t> stored;
    for (int i = 0; i < 24 * 24 * 24; ++i) {
        const glm::dvec3 p = glm::dvec3(i % 24, i / 24 % 24, i / 576) - 11.5;
        stored.push_back(static_cast<std::uint8_t>(200.0 * std::exp(-glm::dot(p, p) / 40.0)));
    }
    const Volume volume = volume_of<std::uint8_t>(glm::ivec3(24), ScalarType::u8, stored);
    const ExtinctionGrid grid =
        extinction_grid(volume.grid.dims, volume.grid.texture_to_world(), 24,
                        of_values(volume, 0, [](double value) { return value * 1e-3; }));
    const glm::dvec3 towards = glm::normalize(glm::dvec3(1.0, 2.0, 3.0));
    double dimmest = 1.0;
    for (const glm::dvec3 place : {glm::dvec3(0.5), glm::dvec3(0.3, 0.2, 0.1), glm::dvec3(0.9)}) {
        double depth = 0.0;
        constexpr double ds = 0.001;
        const double start = 1.0 / towards.z;  // a cell along the steepest axis
        for (double s = start + 0.5 * ds;; s += ds) {
            const glm::dvec3 p = place + towards * s / 24.0;
            if (p.x > 1.0 || p.y > 1.0 || p.z > 1.0) {
                break;
            }
            depth += ds * grid.at(p);
        }
        const double got = transmittance(grid, place, towards, 1e9);
        EXPECT_NEAR(got, std::exp(-depth), 2e-3);
        dimmest = std::min(dimmest, got);
    }
    EXPECT_LT(dimmest, 0.6);
}

TEST(Overlay, fusion_keeps_brightness_and_takes_hue) {
    const glm::dvec3 result = fused({0.2, 0.5, 0.3}, {1.0, 0.0, 0.5});
    EXPECT_EQ(result, glm::dvec3(0.5, 0.0, 0.25));
    OverlayParams params;
    params.window = WindowLevel{.width = 10.0, .level = 5.0};
    const OverlayTable table = overlay_table(overlay_map(params, -100.0, 100.0), 3);
    EXPECT_EQ(table.place, glm::dvec2(0.1, 0.0));
    EXPECT_EQ(table.entries[1], glm::vec4(0.0F, 1.0F, 0.0F, 1.0F));
}

TEST(Classic, accumulation_weighs_by_value_inside_its_threshold) {
    const AccumulateParams params{
        .opacity = 8.0, .samples = 100.0, .brightness = 0.1, .contrast = 0.5, .threshold = {0.25, 0.75}};
    std::size_t faults = 0;
    const TransferFunction f = normalised(accumulate_function(params, -1000.0, 1000.0, 200.0), faults);
    EXPECT_EQ(faults, 0U);
    EXPECT_EQ(f.reference_length_mm, 2.0);
    for (const double v : {0.26, 0.5, 0.74}) {
        const glm::dvec4 c = evaluate(f, -1000.0 + 2000.0 * v);
        EXPECT_NEAR(c.r, (v + 0.1) * 0.5, 1e-12);
        EXPECT_NEAR(c.a, v * 0.08, 1e-12);
    }
    EXPECT_EQ(evaluate(f, -1000.0 + 2000.0 * 0.24).a, 0.0);
    EXPECT_EQ(evaluate(f, -1000.0 + 2000.0 * 0.76).a, 0.0);
}

TEST(Classic, density_is_one_where_anything_is_seen) {
    TransferFunction function;
    function.points = {{0.0, {0.0, 0.0, 0.0}, 0.0},
                       {10.0, {0.2, 0.2, 0.2}, 0.0},
                       {20.0, {0.6, 0.2, 0.2}, 0.9},
                       {30.0, {0.8, 0.4, 0.2}, 0.0},
                       {40.0, {1.0, 1.0, 1.0}, 0.0}};
    std::size_t faults = 0;
    const TransferFunction f =
        normalised(density_function(function, {.density = 0.05, .scale = 2.0, .iso = 6.0}), faults);
    EXPECT_EQ(evaluate(f, 5.9).a, 0.0);  // below iso
    for (const double v : {6.5, 9.0, 12.0, 14.9}) {
        const glm::dvec4 wanted = evaluate(function, 2.0 * v);
        const glm::dvec4 got = evaluate(f, v);
        EXPECT_NEAR(glm::length(glm::dvec3(wanted) - glm::dvec3(got)), 0.0, 1e-12) << v;
        EXPECT_EQ(got.a, 0.05) << v;
    }
    EXPECT_EQ(evaluate(f, 15.1).a, 0.0);
    EXPECT_EQ(evaluate(f, 100.0).a, 0.0);
}

}  // namespace
}  // namespace viscera::volume
