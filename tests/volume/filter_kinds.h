#pragma once

#include <random>

#include "tests/reference/volume_field.h"
#include "tests/volume/sampler.h"

namespace viscera::test {

/// A filter with its own derivative as gradient, and its reference.
struct FilterKind {
    const char* name;
    volume::ReconstructionParams reconstruction;
    reference::Filter reference;
    bool full_precision;  ///< weighs voxels itself, not by the texture unit
};

inline std::vector<FilterKind> all_filter_kinds() {
    using F = volume::ReconstructionFilter;
    using R = reference::Filter;
    constexpr volume::GradientKind own = volume::GradientKind::analytic;
    return {{"nearest", {F::nearest, false, own}, R::nearest, true},
            {"linear", {F::linear, false, own}, R::trilinear, false},
            {"linear_fp32", {F::linear_fp32, false, own}, R::trilinear, true},
            {"bspline raw", {F::bspline, false, own}, R::bspline, false},
            {"bspline_fp32 raw", {F::bspline_fp32, false, own}, R::bspline, true},
            {"bspline", {F::bspline, true, own}, R::bspline_prefiltered, false},
            {"bspline_fp32", {F::bspline_fp32, true, own}, R::bspline_prefiltered, true},
            {"catmull_rom", {F::catmull_rom, false, own}, R::catmull_rom, false},
            {"catmull_rom_fp32", {F::catmull_rom_fp32, false, own}, R::catmull_rom, true}};
}

/// A volume of one f32 channel; `value` by indices.
template <class Value>
Volume make_volume(const glm::ivec3& dims, const Value& value) {
    std::vector<float> voxels;
    glm::ivec3 i;
    for (i.z = 0; i.z < dims.z; ++i.z) {
        for (i.y = 0; i.y < dims.y; ++i.y) {
            for (i.x = 0; i.x < dims.x; ++i.x) {
                voxels.push_back(static_cast<float>(value(i)));
            }
        }
    }
    Volume volume{.grid = {.dims = dims}, .type = ScalarType::f32, .voxels = {}, .source = "test"};
    const auto bytes = std::as_bytes(std::span(voxels));
    volume.voxels.assign(bytes.begin(), bytes.end());
    return volume;
}

/// Uniform noise over all an integer type can hold, or over [-1, 1].
inline Volume make_noise(const glm::ivec3& dims, ScalarType type) {
    std::mt19937 random(7);
    if (type == ScalarType::f32) {
        return make_volume(dims, [&](const glm::ivec3&) {
            return std::uniform_real_distribution<double>(-1.0, 1.0)(random);
        });
    }
    Volume volume{.grid = {.dims = dims}, .type = type, .voxels = {}, .source = "noise"};
    volume.voxels.resize(volume.grid.voxel_count() * bytes_of(type));
    for (std::byte& b : volume.voxels) {
        b = static_cast<std::byte>(random() & 255U);
    }
    volume.slope = 0.5;
    volume.intercept = -1024.0;
    return volume;
}

/// Random places in a cube about the volume's centre, `half` wide to each side in texture coordinates.
inline std::vector<glm::vec3> places_in(double half, std::size_t count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> at(static_cast<float>(0.5 - half), static_cast<float>(0.5 + half));
    std::vector<glm::vec3> places;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = at(random);
        const float y = at(random);
        places.emplace_back(x, y, at(random));
    }
    return places;
}

}  // namespace viscera::test
