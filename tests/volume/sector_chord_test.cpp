// How much of a ray lies in a sector of a cylinder or sphere, beside double precision.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/placement.h"
#include "tests/reference/volume_sector.h"
#include "tests/volume/sector_stage.h"

namespace viscera::test {
namespace {

/// Whole length and number of the stretches of a ray that are longer than `least`.
struct Chord {
    double length = 0.0;
    int pieces = 0;
    double shortest = 1e300;  ///< of pieces and of gaps between them
};
Chord chord_of(const std::vector<reference::Interval>& stretches, double near_mm) {
    Chord chord;
    double before = -1e300;
    for (const reference::Interval& s : stretches) {
        const double begin = std::max(s.begin, near_mm);
        if (s.end > begin) {
            chord.length += s.end - begin;
            ++chord.pieces;
            chord.shortest = std::min({chord.shortest, s.end - begin, begin - before});
            before = s.end;
        }
    }
    return chord;
}

nlohmann::json seen(bool skip = false) {
    nlohmann::json p{{"sampling", {{"skip", skip}}}};
    p["transfer_function"]["points"] = {{{"value", 0}, {"opacity", 0.1}}, {{"value", 1}, {"opacity", 0.2}}};
    return p;
}

struct Found {
    double worst = 0.0;  ///< of lengths [mm]
    int misjudged = 0;
    int rays = 0;
    int most_pieces = 0;
};

/// Compares with the pixel's ray in double precision. In floats a ray lies up to some 2^-22 of the radius
/// aside; where so little makes a difference, at silhouettes and edges that it grazes, lengths say nothing,
/// and only what is neither hit nor missed by all rays around counts as misjudged.
Found compare(const Shot& shot, const VolumeGrid& grid, const glm::dmat4& frame_to_world, double near_mm,
              double aside_mm) {
    Found found;
    const reference::SectorRange all = reference::whole(grid.shape);
    const auto at = [&](const reference::Ray& ray) {
        return chord_of(reference::intersect(grid.shape, all, frame_to_world, ray), shot.along(ray, near_mm));
    };
    for (int y = 0; y < shot.image.height; ++y) {
        for (int x = 0; x < shot.image.width; ++x) {
            const reference::Ray ray = shot.ray(x, y);
            const Chord wanted = at(ray);
            const double got = shot.at(x, y).x;
            ++found.rays;
            found.most_pieces = std::max(found.most_pieces, static_cast<int>(shot.at(x, y).y));
            if (std::abs(got - wanted.length) <= found.worst) {
                continue;
            }
            const glm::dvec3 u = glm::normalize(glm::cross(ray.direction, glm::dvec3(0.31, 0.52, 0.79)));
            const glm::dvec3 v = glm::cross(ray.direction, u);
            double least = wanted.length;
            double most = wanted.length;
            for (const glm::dvec3& shift :
                 {u, -u, v, -v, 0.7 * (u + v), 0.7 * (u - v), -0.7 * (u + v), 0.7 * (v - u)}) {
                const double there = at({ray.origin_mm + aside_mm * shift, ray.direction}).length;
                least = std::min(least, there);
                most = std::max(most, there);
            }
            const double off = std::max({least - got, got - most, 0.0});
            found.worst = std::max(found.worst, off);
            found.misjudged += (least > 0.0 && got == 0.0) || (most == 0.0 && got > 0.0) ? 1 : 0;
        }
    }
    return found;
}

/// The frame of a volume that no placement moves.
glm::dmat4 frame_of(const VolumeGrid& grid) {
    return grid.frame_to_world();
}

class SectorChords : public testing::Test {
  protected:
    VolumeStage stage_{chords_shown()};
};

TEST_F(SectorChords, OfEveryShapeFromManyPlaces) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    double worst = 0.0;
    int most = 0;
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const LiveVolume volume(sector_noise(named.shape, {4, 5, 4}, 1));
        const VolumeGrid& grid = volume.volume().grid;
        const glm::dvec3 centre = sector_centre(grid);
        for (int i = 0; i < 7; ++i) {
            Look look{.eye_mm = centre + 150.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                      .target_mm = centre + 10.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                      .fov_deg = 50,
                      .near_mm = 0.01};
            const glm::dvec3 axis = grid.direction[2];
            switch (i) {
                case 1:  // along the axis
                    look.eye_mm = grid.origin_mm + 130.0 * axis;
                    look.target_mm = grid.origin_mm;
                    look.up = {0.0, 1.0, 0.0};
                    break;
                case 2:  // in the sphere's centre, at the end of the cylinder's axis
                    look.eye_mm = grid.origin_mm;
                    break;
                case 3:  // on the axis
                    look.eye_mm = grid.origin_mm + 20.0 * axis;
                    look.target_mm = look.eye_mm + grid.direction[0] + 0.3 * axis;
                    break;
                case 4:  // across the axis, all rays in parallel
                    look.orthographic_mm = 120.0;
                    look.eye_mm = grid.origin_mm + 30.0 * axis + 200.0 * grid.direction[1];
                    look.target_mm = grid.origin_mm + 30.0 * axis;
                    break;
                case 5:  // along the axis in parallel: through the poles, grazing
                    look.orthographic_mm = 101.0;
                    look.eye_mm = grid.origin_mm - 300.0 * axis;
                    look.target_mm = grid.origin_mm;
                    look.up = {0.0, 1.0, 0.0};
                    break;
                default:
                    break;
            }
            const Shot shot = stage_.cast(volume, seen(), look, glm::ivec2(63));
            const Found found = compare(shot, grid, frame_of(grid),
                                        look.orthographic_mm > 0.0 ? 0.0 : look.near_mm, 50.0 / 4194304.0);
            EXPECT_LE(found.worst, 50.0 * 1e-5) << "place " << i;
            EXPECT_EQ(found.misjudged, 0) << "place " << i;
            worst = std::max(worst, found.worst / 50.0);
            most = std::max(most, found.most_pieces);
        }
    }
    std::printf("  worst %.1e of the radius, up to %d pieces\n", worst, most);
    EXPECT_GE(most, 3);
}

TEST_F(SectorChords, FromTenThousandRadiiAway) {
    // Two shapes, 2e5 rays: as wide as the volume, so that most of them hit and many graze.
    double worst = 0.0;
    int rays = 0;
    for (const NamedShape& named : some_shapes()) {
        const std::string_view name = named.name;
        if (name != "tube" && name != "shell") {
            continue;
        }
        const LiveVolume volume(sector_noise(named.shape, {4, 5, 4}, 1));
        const VolumeGrid& grid = volume.volume().grid;
        const glm::dvec3 centre = sector_centre(grid);
        const double away = 1e4 * 50.0;
        const Look look{.eye_mm = centre + away * glm::normalize(glm::dvec3(0.5, -0.7, 0.4)),
                        .target_mm = centre,
                        .fov_deg = 0.1,
                        .near_mm = 0.9 * away,
                        .far_mm = 1.1 * away};
        // Scenes have no such narrow angle; a host may.
        View view = stage_.cast(volume, seen(), look, glm::ivec2(8)).view;
        const double zoom = glm::radians(0.1) / (2.0 * 62.0 / away);
        view.projection[0][0] *= zoom;
        view.projection[1][1] *= zoom;
        const Shot shot = stage_.cast_again(volume, view, glm::ivec2(318));
        const Found found = compare(shot, grid, frame_of(grid), look.near_mm, 50.0 / 4194304.0);
        EXPECT_LE(found.worst, 50.0 * 1e-5) << name;
        EXPECT_EQ(found.misjudged, 0) << name;
        worst = std::max(worst, found.worst / 50.0);
        rays += found.rays;
    }
    std::printf("  %d rays from 1e4 radii: worst %.1e of the radius\n", rays, worst);
    EXPECT_GE(rays, 200000);
}

TEST_F(SectorChords, UnderPlacementsThatStretchAndMirror) {
    for (const NamedShape& named : some_shapes()) {
        SCOPED_TRACE(named.name);
        const LiveVolume volume(sector_noise(named.shape, {4, 5, 4}, 1));
        const VolumeGrid& grid = volume.volume().grid;
        const PlacementParams placement{
            .move_mm = {8, -6, 3}, .rotate_deg = {-70, 15, 110}, .scale = {1.3, -0.6, 1.1}};
        nlohmann::json p = seen();
        p["volume"]["placement"] = {
            {"move_mm", {8, -6, 3}}, {"rotate_deg", {-70, 15, 110}}, {"scale", {1.3, -0.6, 1.1}}};
        const Look look{.eye_mm = sector_centre(grid) + glm::dvec3(120, -160, 90),
                        .target_mm = sector_centre(grid),
                        .fov_deg = 40};
        const Shot shot = stage_.cast(volume, p, look, glm::ivec2(63));
        const glm::dmat4 placed = placement_matrix(placement, sector_centre(grid));
        const Found found = compare(shot, grid, placed * frame_of(grid), look.near_mm, 65.0 / 4194304.0);
        EXPECT_LE(found.worst, 65.0 * 1e-5);
        EXPECT_EQ(found.misjudged, 0);
    }
}

}  // namespace
}  // namespace viscera::test
