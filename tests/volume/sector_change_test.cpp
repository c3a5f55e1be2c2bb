// Cylindrical and spherical volumes that change while they are shown, and what else of the box's ray caster
// works on them: long slabs, traces behind a surface, and light from a coarse grid.

#include <cmath>
#include <optional>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "effects/volume/light_volume.h"
#include "effects/volume/space.h"
#include "tests/reference/volume_sector.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/sector_stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

VolumeShape shape_of(std::string_view name) {
    for (const NamedShape& named : some_shapes()) {
        if (named.name == name) {
            return named.shape;
        }
    }
    throw std::invalid_argument(std::string(name));
}

Look look_at(const VolumeGrid& grid) {
    return {.eye_mm = sector_centre(grid) + glm::dvec3(110, -150, 80),
            .target_mm = sector_centre(grid),
            .fov_deg = 34};
}

json glow(double opacity) {
    return {{"points",
             {{{"value", 0.3}, {"colour", {0.9, 0.3, 0.2}}, {"opacity", 0.0}},
              {{"value", 1}, {"colour", {1.0, 0.95, 0.8}}, {"opacity", opacity}}}}};
}

/// Every second voxel of a box, along each axis, as bright as may be.
std::vector<float> studs(const glm::ivec3& size) {
    std::vector<float> values;
    for (int i = 0; i < size.x * size.y * size.z; ++i) {
        values.push_back((i % size.x + i / size.x % size.y + i / size.x / size.y) % 2 == 0 ? 1.0F : 0.0F);
    }
    return values;
}

TEST(SectorChanges, PartsOnEitherSideOfTheSeamShowAsInAVolumeMadeAnew) {
    for (const char* name : {"tube", "ring", "ball", "shell"}) {
        const VolumeShape shape = shape_of(name);
        const glm::ivec3 n = small_dims(shape);
        const int ring = shape.wrap_axis();
        for (const char* filter : {"linear", "bspline_fp32"}) {
            SCOPED_TRACE(std::string(name) + ", " + filter);
            // Dark before, so that bricks beside the seam are empty until the change tells otherwise.
            LiveVolume live(sector_volume(shape, n, [](const glm::dvec3&) { return 0.0; }));
            Look look = look_at(live.volume().grid);
            const json p{{"transfer_function", glow(0.4)}, {"sampling", {{"filter", filter}}}};
            VolumeStage stage;
            (void)stage.cast(live, p, look, glm::ivec2(40));
            // The last samples of the ring, and in a later frame the first ones, at the axis or a pole as
            // well.
            for (const int first : {n[ring] - 2, 0}) {
                VoxelBox box{{0, 0, 0}, glm::min(glm::ivec3(9), n)};
                box.first[ring] = first;
                box.size[ring] = 2;
                const std::vector<float> data = studs(box.size);
                live.update(box, std::as_bytes(std::span(data)));
                const Shot changed =
                    stage.cast_again(live, stage.stage().renderer().still(0.0).eye(), glm::ivec2(40));
                VolumeStage other;
                const LiveVolume anew(live.volume());
                const Shot wanted = other.cast(anew, p, look, glm::ivec2(40));
                const Difference d = difference(changed.image, wanted.image);
                // A change reaches 16 coefficients, where it has faded to 1e-9 of its size; on a longer ring
                // only those are solved again.
                EXPECT_LE(d.max, std::string_view(filter) == "linear" ? 0.0 : 1e-6);
                EXPECT_GT(d.seen, 3U);
            }
        }
    }
}

TEST(SectorLongSlabs, AreFewerAndStayWithinTheTolerance) {
    const auto slabs = [](const Image& image) {
        double sum = 0.0;
        for (int i = 0; i < image.width * image.height; ++i) {
            sum += image.at(i % image.width, i / image.width, 0);
        }
        return sum;
    };
    for (const char* name : {"ring", "gap", "ball", "belt"}) {
        SCOPED_TRACE(name);
        const VolumeShape shape = shape_of(name);
        const LiveVolume volume(sector_volume(shape, 2 * small_dims(shape), [](const glm::dvec3& p) {
            return std::clamp((26.0 - glm::length(p - glm::dvec3(-6, 4, 20))) / 3.0 + 0.5, 0.0, 1.0);
        }));
        const Look look = look_at(volume.volume().grid);
        for (const char* scheme : {"midpoint", "gauss"}) {
            json p{{"transfer_function", glow(0.05)},
                   {"sampling", {{"scheme", scheme}, {"step", 0.25}, {"termination", 0}}}};
            const auto both = [&](double tolerance) {
                p["sampling"]["tolerance"] = tolerance;
                VolumeStage plain;
                VolumeStage counted(slab_counting());
                return std::pair(plain.cast(volume, p, look, glm::ivec2(40)).image,
                                 slabs(counted.cast(volume, p, look, glm::ivec2(40)).image));
            };
            const auto [exact, all] = both(0.0);
            double before = all;
            for (const double tolerance : {0.02, 0.1}) {
                const auto [got, taken] = both(tolerance);
                const double off = difference(got, exact).max;
                std::printf("  %s, %s, tolerance %.2f: off by %.1e, %.2f of the slabs\n", name, scheme,
                            tolerance, off, taken / all);
                EXPECT_LE(off, tolerance);
                EXPECT_LE(taken, before);
                before = taken;
            }
            EXPECT_LT(before, all);
        }
    }
}

TEST(SectorSubVolumes, ATraceEndsBehindWhereTheRayFirstEnters) {
    VolumeStage stage(chords_shown());
    constexpr double depth_mm = 23.0;
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const LiveVolume volume(sector_noise(named.shape, {8, 8, 8}, 1));
        const VolumeGrid& grid = volume.volume().grid;
        const json p{{"transfer_function", glow(0.1)},
                     {"sampling", {{"skip", false}}},
                     {"sub_volume", {{"depth_mm", depth_mm}}}};
        const Shot shot = stage.cast(volume, p, look_at(grid), glm::ivec2(32));
        const Miss m = miss(shot, [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
            const std::vector<reference::Interval> pieces =
                reference::intersect(named.shape, reference::whole(named.shape), grid.frame_to_world(), ray);
            double length = 0.0;
            double count = 0.0;
            for (const reference::Interval& s : pieces) {
                const double end = std::min(s.end, pieces.front().begin + depth_mm);
                length += std::max(end - s.begin, 0.0);
                count += end > s.begin ? 1.0 : 0.0;
                if (std::abs(end - s.begin) < 0.05 || s.length() < 0.05) {
                    return std::nullopt;  // whether so short a piece is one
                }
            }
            return length > 1.0 ? std::optional(glm::dvec4(length, count, 0.0, 1.0)) : std::nullopt;
        });
        EXPECT_LE(m.worst, 0.01) << m.x << " " << m.y;
        EXPECT_GT(m.pixels, 30);
    }
}

/// The sample of a ring or a sector next to a place of the frame; none beside all of them.
std::optional<glm::ivec3> sample_at(const VolumeGrid& grid, const glm::dvec3& frame) {
    const ShapeAxes axes = axes_of(grid.shape, grid.dims);
    const glm::dvec3 index = (from_frame(grid.shape, frame) - axes.first) / axes.step;
    glm::ivec3 sample(glm::floor(index + 0.5));
    const int ring = grid.shape.wrap_axis();
    for (int a = 0; a < 3; ++a) {
        if (a == ring) {
            sample[a] = (sample[a] % grid.dims[a] + grid.dims[a]) % grid.dims[a];
        } else if (sample[a] < 0 || sample[a] >= grid.dims[a]) {
            return std::nullopt;
        }
    }
    return sample;
}

TEST(SectorLight, ItsGridIsThatOfABoxWithTheSameValues) {
    // Eight places a cell, each of the sample next to it: as a box has them whose voxels are those places.
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const Volume volume = sector_noise(named.shape, small_dims(named.shape), 5);
        const VolumeGrid& sector = volume.grid;
        const auto extinction = [](double value) { return 0.02 * value; };
        const volume::ExtinctionGrid got = volume::extinction_in_box(
            sector, sector.box_to_world(), 20, volume::of_values(volume, 0, extinction));
        Volume box = float_volume(2 * got.dims, glm::dvec3(1.0), [](const glm::dvec3&) { return 0.0; });
        auto* const values = reinterpret_cast<float*>(box.voxels.data());
        const glm::dmat4 to_frame = glm::inverse(sector.frame_to_world()) * sector.box_to_world();
        for (std::size_t i = 0; i < box.grid.voxel_count(); ++i) {
            const auto nx = static_cast<std::size_t>(box.grid.dims.x);
            const auto ny = static_cast<std::size_t>(box.grid.dims.y);
            const glm::dvec3 place =
                (glm::dvec3(i % nx, i / nx % ny, i / nx / ny) + 0.5) / glm::dvec3(box.grid.dims);
            const auto sample = sample_at(sector, to_frame * glm::dvec4(place, 1.0));
            values[i] = sample ? static_cast<float>(volume.stored(*sample)) : 0.0F;
        }
        // A box that is as wide in all directions as the cells are many has as many cells.
        const volume::ExtinctionGrid wanted = volume::extinction_grid(
            box.grid.dims, glm::scale(glm::dmat4(1.0), glm::dvec3(got.dims)),
            std::max({got.dims.x, got.dims.y, got.dims.z}), volume::of_values(box, 0, extinction));
        ASSERT_EQ(wanted.dims, got.dims);
        std::size_t other = 0;
        double most = 0.0;
        for (std::size_t i = 0; i < got.per_mm.size(); ++i) {
            other += std::abs(got.per_mm[i] - wanted.per_mm[i]) > 1e-7F ? 1U : 0U;
            most = std::max(most, static_cast<double>(got.per_mm[i]));
        }
        // Places half-way between two samples may be given to either.
        EXPECT_LE(other, got.per_mm.size() / 100);
        EXPECT_GT(most, 0.01);
    }
}

TEST(SectorLight, IsLookedUpWhereTheRayIs) {
    // So dense that the first slab's middle is all that is seen, in ambient light alone.
    VolumeStage stage;
    for (const char* name : {"ring", "gap", "ball", "bitten"}) {
        SCOPED_TRACE(name);
        const VolumeShape shape = shape_of(name);
        const LiveVolume volume(sector_noise(shape, small_dims(shape), 3));
        const VolumeGrid& sector = volume.volume().grid;
        const volume::LightVolumeParams how{.ambient_occlusion = 0.8, .resolution = 24};
        const json p{{"transfer_function",
                      {{"points", {{{"value", 0}, {"colour", {1, 1, 1}}, {"opacity", 0.9999999}}}}}},
                     {"sampling", {{"step", 1}, {"scheme", "midpoint"}}},
                     {"shading",
                      {{"enabled", true},
                       {"lighting", {{"ambient", 1}, {"diffuse", 0}, {"specular", 0}}},
                       {"light_volume",
                        {{"ambient_occlusion", how.ambient_occlusion}, {"resolution", how.resolution}}}}}};
        const Shot shot = stage.cast(volume, p, look_at(sector), glm::ivec2(40));
        const glm::dmat4 box = sector.box_to_world();
        volume::ExtinctionGrid grid = volume::extinction_in_box(
            sector, box, how.resolution, [](const glm::ivec3&) { return -std::log(1e-7); });
        const std::vector<glm::vec2> light = volume::light_volume(grid, how, glm::dvec4(0, 0, 1, 0));
        // The same grid between cells as the texture unit has it.
        std::ranges::transform(light, grid.per_mm.begin(), [](const glm::vec2& cell) { return cell.y; });
        const double slab_mm = volume::voxel_spacing_mm(volume::make_space(sector, PlacementParams{}));
        double least = 1.0;
        double most = 0.0;
        const Miss m = miss(shot, [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
            const auto pieces =
                reference::intersect(shape, reference::whole(shape), sector.frame_to_world(), ray);
            if (pieces.empty() || pieces.front().length() < slab_mm) {
                return std::nullopt;
            }
            const glm::dvec3 world = ray.at(pieces.front().begin + 0.5 * slab_mm);
            const double arrives = grid.at(glm::inverse(box) * glm::dvec4(world, 1.0));
            least = std::min(least, arrives);
            most = std::max(most, arrives);
            return glm::dvec4(arrives, arrives, arrives, 1.0);
        });
        EXPECT_LE(m.worst, 1e-4) << m.x << ", " << m.y;
        EXPECT_GT(m.pixels, 100);
        EXPECT_GT(most, least + 0.1);
    }
}

}  // namespace
}  // namespace viscera::test
