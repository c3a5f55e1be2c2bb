#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

#include "assets/generate/generate.h"
#include "assets/generate/organ_field.h"
#include "assets/generate/organ_mesh.h"
#include "assets/generate/organ_paint.h"
#include "assets/generate/vessel_mesh.h"
#include "engine/core/mesh_atlas.h"

// The generated organ: a sound surface with an atlas that can be painted by, and pictures without seams.
namespace viscera::assets {
namespace {

const OrganField& field() {
    static const OrganField organ(default_seed);
    return organ;
}
const MeshData& organ() {
    static const MeshData mesh = mesh_organ(field(), organ_spacing_mm);
    return mesh;
}

/// The mesh without the vertices that charts repeat.
MeshData welded(const MeshData& mesh) {
    MeshData result;
    std::map<std::array<float, 3>, std::uint32_t> known;
    for (const std::uint32_t vertex : mesh.indices) {
        const glm::vec3& p = mesh.positions[vertex];
        const auto [entry, is_new] =
            known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(result.positions.size()));
        if (is_new) {
            result.positions.push_back(p);
        }
        result.indices.push_back(entry->second);
    }
    return result;
}

TEST(Organ, is_one_closed_outward_surface) {
    const SurfaceCheck check = check_surface(welded(organ()));
    EXPECT_EQ(check.components, 1U);
    EXPECT_EQ(check.bad_edges, 0U);
    EXPECT_EQ(check.degenerate, 0U);
    EXPECT_GT(check.volume_mm3, 1e5);
    EXPECT_GT(least_agreement(organ()), 0.25) << "folds: somewhere two sheets are closer than the grid";
    EXPECT_GT(organ().triangle_count(), 8000U);
    double worst = 0.0;
    for (std::size_t v = 0; v < organ().positions.size(); ++v) {
        worst = std::max(worst, std::abs(field().distance(glm::dvec3(organ().positions[v]))));
        ASSERT_NEAR(glm::length(organ().normals[v]), 1.0, 1e-5);
    }
    EXPECT_LT(worst, 0.5) << "vertices lie off the surface [mm]";
}

TEST(Organ, atlas_gives_each_place_its_own_texels) {
    const UvUse use = measure_uvs(organ().uvs, organ().indices);
    std::printf("  atlas covers %.1f %% of the texture\n", 100.0 * use.covered);
    EXPECT_FALSE(use.beyond);
    EXPECT_EQ(use.overlap, 0.0);
    EXPECT_GT(use.covered, 0.35);
    EXPECT_GT(organ().positions.size(), welded(organ()).positions.size()) << "no seams";
}

TEST(Organ, has_a_liver_a_gallbladder_and_fat) {
    double liver = 0.0;
    double gallbladder = 0.0;
    double fat = 0.0;
    for (const glm::vec3& p : organ().positions) {
        const OrganTissue tissue = field().tissue(glm::dvec3(p));
        ASSERT_NEAR(tissue.liver + tissue.gallbladder + tissue.fat, 1.0, 1e-12);
        liver += tissue.liver;
        gallbladder += tissue.gallbladder;
        fat += tissue.fat;
    }
    const auto all = static_cast<double>(organ().positions.size());
    EXPECT_GT(liver / all, 0.3);
    EXPECT_GT(gallbladder / all, 0.03);
    EXPECT_GT(fat / all, 0.2);
}

/// Hollows: places that water would not leave, where all neighbours lie higher. Down is +y.
TEST(Organ, has_hollows_that_hold_blood) {
    const MeshData mesh = welded(organ());
    std::vector<bool> lowest(mesh.positions.size(), true);
    std::vector<float> upward(mesh.positions.size(), 0.0F);
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::vec3& p = mesh.positions[mesh.indices[t]];
        const glm::vec3 normal =
            glm::cross(mesh.positions[mesh.indices[t + 1]] - p, mesh.positions[mesh.indices[t + 2]] - p);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.indices[t + k];
            upward[v] -= normal.y;
            for (const std::uint32_t other : {mesh.indices[t + (k + 1) % 3], mesh.indices[t + (k + 2) % 3]}) {
                lowest[v] = lowest[v] && mesh.positions[other].y <= mesh.positions[v].y;
            }
        }
    }
    int hollows = 0;
    for (std::size_t v = 0; v < lowest.size(); ++v) {
        hollows += lowest[v] && upward[v] > 0.0F ? 1 : 0;
    }
    std::printf("  %d hollows\n", hollows);
    EXPECT_GE(hollows, 3);
}

/// Colours at the two places in the texture of one point of the surface.
TEST(Organ, pictures_show_no_seam) {
    constexpr int size = 512;
    const OrganPaint paint(field(), default_seed);
    const ColourImage image = paint_atlas(organ(), size, [&](const PaintPoint& p) {
        // A smooth colour, so that half a texel makes no difference.
        return glm::vec4(glm::vec3(0.5 + p.place / 400.0), 1.0F);
    });
    const auto at = [&](const glm::vec2& uv) {
        const glm::ivec2 texel = glm::clamp(glm::ivec2(uv * static_cast<float>(size)), 0, size - 1);
        return image.pixels[static_cast<std::size_t>(texel.y) * size + static_cast<std::size_t>(texel.x)];
    };
    std::map<std::array<float, 3>, std::uint32_t> first;
    double worst = 0.0;
    int seams = 0;
    for (std::uint32_t v = 0; v < organ().positions.size(); ++v) {
        const glm::vec3& p = organ().positions[v];
        const auto [entry, is_new] = first.try_emplace({p.x, p.y, p.z}, v);
        if (!is_new) {
            ++seams;
            const glm::vec4 apart = at(organ().uvs[v]) - at(organ().uvs[entry->second]);
            worst = std::max<double>(worst, glm::length(glm::vec3(apart)));
        }
    }
    EXPECT_GT(seams, 100);
    // Two texels of about 1 mm, stretched by up to 2.4.
    EXPECT_LT(worst, 2.0 * 2.4 * 1.2 / 400.0);
}

TEST(Organ, cut_and_hint_mark_a_part_of_the_surface) {
    const OrganPaint paint(field(), default_seed);
    const ColourImage cut = paint_atlas(organ(), 512, [&](const PaintPoint& p) { return paint.cut(p); });
    const ColourImage hint = paint_atlas(organ(), 256, [&](const PaintPoint& p) { return paint.hint(p); });
    const auto share = [](const ColourImage& image) {
        const auto marked =
            std::ranges::count_if(image.pixels, [](const glm::vec4& c) { return c.a > 0.5F; });
        return static_cast<double>(marked) / static_cast<double>(image.pixels.size());
    };
    EXPECT_GT(share(cut), 1e-4);
    EXPECT_LT(share(cut), 0.01);
    EXPECT_GT(share(hint), 1e-3);
    EXPECT_LT(share(hint), 0.05);
    for (const glm::dvec3& end : paint.cut_line()) {
        EXPECT_LT(std::abs(field().distance(end)), 0.2);
        EXPECT_GT(field().tissue(end).liver, 0.99);
    }
}

TEST(Organ, normal_map_points_outwards) {
    const OrganPaint paint(field(), default_seed);
    const ColourImage map = paint_atlas(organ(), 64, [&](const PaintPoint& p) { return paint.normal(p); });
    double tilt = 0.0;
    for (const glm::vec4& c : map.pixels) {
        ASSERT_GT(c.b, 0.6F);
        tilt = std::max<double>(tilt, std::abs(c.r - 128.0F / 255.0F));
    }
    EXPECT_GT(tilt, 0.05);
}

TEST(Abdomen, is_seen_from_inside) {
    const MeshData wall = mesh_abdomen(default_seed, 16);
    ASSERT_EQ(wall.triangle_count(), 512U);
    for (std::size_t v = 0; v < wall.positions.size(); ++v) {
        EXPECT_LT(glm::dot(wall.normals[v], wall.positions[v] - glm::vec3(0.0F, 10.0F, -10.0F)), 0.0F);
    }
    const glm::vec3& p = wall.positions[wall.indices[0]];
    const glm::vec3 winding =
        glm::cross(wall.positions[wall.indices[1]] - p, wall.positions[wall.indices[2]] - p);
    EXPECT_GT(glm::dot(winding, wall.normals[wall.indices[0]]), 0.0F);
}

}  // namespace
}  // namespace viscera::assets
