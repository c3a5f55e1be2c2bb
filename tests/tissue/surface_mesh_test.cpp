#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/core/mesh_atlas.h"
#include "engine/io/mesh.h"
#include "tests/tissue/bake_stage.h"

// Moved vertices, made atlases, what is kept and what is done again.
namespace viscera::test {
namespace {

MeshData patch() {
    return sheet(
        6, 6, [](double s, double t) { return glm::dvec3(50.0 * s, 40.0 * t, 6.0 * s * s - 4.0 * s * t); },
        [](double s, double t) { return glm::dvec2(0.15 + 0.7 * s, 0.15 + 0.7 * t); });
}

std::vector<float> xyz_of(const MeshData& mesh) {
    std::vector<float> values;
    for (const glm::vec3& p : mesh.positions) {
        values.insert(values.end(), {p.x, p.y, p.z});
    }
    return values;
}

PassReport bake_of(const FrameReport& report) {
    const auto found = std::ranges::find(report.passes, "bake", &PassReport::name);
    return found == report.passes.end() ? PassReport{} : *found;
}

void expect_equal(const Image& a, const Image& b) {
    EXPECT_EQ(a.data, b.data);
}

class MovedMesh : public testing::Test {
  protected:
    MovedMesh() {
        stage.use(patch());
        stage.parameters["mesh"]["host_positions"] = "organ.positions";
        // Vertices in the order in which the reader leaves them.
        Log log;
        mesh = io::merge(io::load_meshes(stage.parameters["mesh"]["file"].get<std::string>(), {}, log));
    }
    BakeStage stage;
    MeshData mesh;
    HostValues values;
};

TEST_F(MovedMesh, IsBakedWhereTheHostPutsIt) {
    const Baked still = stage.bake();
    MeshData moved = mesh;
    for (glm::vec3& p : moved.positions) {
        p.z += 5.0F * std::sin(0.1F * p.x);
    }
    moved.normals = io::vertex_normals(moved);
    values.set("organ.positions", xyz_of(moved));
    const Baked baked = stage.bake(&values);
    const reference::BakedSurface surface = surface_of(moved);
    double worst = 0.0;
    double worst_normal = 0.0;
    double worst_area = 0.0;
    for (int y = 0; y < baked.height; ++y) {
        for (int x = 0; x < baked.width; ++x) {
            const auto all = reference::baked_points(surface, baked.uv(x, y), glm::dvec2(64.0));
            if (all.size() != 1 || all[0].margin < 1e-6) {
                continue;
            }
            worst =
                std::max(worst, glm::distance(all[0].position, glm::dvec3(baked.at(baked.position, x, y))));
            worst_normal = std::max(worst_normal,
                                    glm::distance(all[0].normal, glm::dvec3(baked.at(baked.normal, x, y))));
            const double area = glm::length(glm::cross(all[0].du, all[0].dv));
            worst_area = std::max(worst_area, std::abs(baked.metric.at(x, y, 3) / area - 1.0));
        }
    }
    EXPECT_LT(worst, 2e-5);
    // Moved normals turn as the mean of the triangles by area does; the reference weights by angle.
    EXPECT_LT(worst_normal, 0.08);
    EXPECT_LT(worst_area, 3e-5);
    // Where a texel leads to does not change.
    expect_equal(baked.seam, still.seam);
    // Taken away, the file's own shape comes back.
    values.erase("organ.positions");
    const Baked back = stage.bake(&values);
    expect_equal(back.position, still.position);
    expect_equal(back.normal, still.normal);
    expect_equal(back.metric, still.metric);
}

TEST_F(MovedMesh, ThatDoesNotMoveKeepsItsNormals) {
    const Baked still = stage.bake();
    values.set("organ.positions", xyz_of(mesh));
    const Baked baked = stage.bake(&values);
    expect_equal(baked.position, still.position);
    for (int y = 0; y < baked.height; ++y) {
        for (int x = 0; x < baked.width; ++x) {
            ASSERT_LT(glm::distance(baked.at(baked.normal, x, y), still.at(still.normal, x, y)), 1e-6F);
        }
    }
}

TEST_F(MovedMesh, IsBakedAgainOnlyWhenItMoves) {
    EXPECT_EQ(bake_of(stage.render()).status, PassStatus::run);
    const Baked first = stage.bake();
    EXPECT_EQ(bake_of(stage.render()).status, PassStatus::cached);
    EXPECT_EQ(
        std::ranges::count_if(stage.long_work(),
                              [](const std::string& what) { return what.starts_with("finding the texels"); }),
        1);
    values.set("organ.positions", xyz_of(mesh));
    EXPECT_EQ(bake_of(stage.render(&values)).status, PassStatus::run);
    EXPECT_EQ(bake_of(stage.render(&values)).status, PassStatus::cached);
    std::vector<float> moved = xyz_of(mesh);
    moved[2] += 1.0F;
    values.set("organ.positions", moved);
    EXPECT_EQ(bake_of(stage.render(&values)).status, PassStatus::run);
    // Positions move; which point a texel stands for is not looked for again.
    EXPECT_EQ(
        std::ranges::count_if(stage.long_work(),
                              [](const std::string& what) { return what.starts_with("finding the texels"); }),
        1);
    expect_equal(stage.bake().position, first.position);
}

TEST_F(MovedMesh, InputThatDoesNotFitLeavesTheFilesShape) {
    const Baked still = stage.bake();
    std::vector<float> few = xyz_of(mesh);
    few.resize(few.size() - 3);
    values.set("organ.positions", few);
    expect_equal(stage.bake(&values).position, still.position);
    EXPECT_TRUE(stage.has_said("not 3 for each of 49 vertices"));
    std::vector<float> wrong = xyz_of(mesh);
    wrong[7] = std::numeric_limits<float>::quiet_NaN();
    values.set("organ.positions", wrong);
    expect_equal(stage.bake(&values).position, still.position);
    EXPECT_TRUE(stage.has_said("are not all finite"));
}

TEST_F(MovedMesh, CollapsedToAPointStaysFinite) {
    values.set("organ.positions", std::vector<float>(3 * mesh.positions.size(), 1.0F));
    const Baked baked = stage.bake(&values);
    for (const Image* image : {&baked.position, &baked.normal, &baked.metric, &baked.seam}) {
        for (const float value : to_floats(*image)) {
            ASSERT_TRUE(std::isfinite(value));
        }
    }
    EXPECT_EQ(baked.metric.at(32, 32, 3), 0.0F);
}

TEST(TissueBakeSkips, OutputsThatNobodyReadsAreLeftOutAndChangeNothing) {
    BakeStage stage;
    stage.use(patch());
    const Baked all = stage.bake();
    stage.all_outputs = false;
    expect_equal(stage.bake().position, all.position);
}

TEST(TissueBakeSkips, MapsAndAtlasesAreKeptOnDisk) {
    const TempFolder cache;
    MeshData mesh = patch();
    mesh.uvs.clear();
    std::vector<Baked> bakes;
    for (int run = 0; run < 2; ++run) {
        BakeStage stage(cache.path());
        stage.use(mesh);
        bakes.push_back(stage.bake());
        EXPECT_TRUE(stage.has_said("an atlas of 1 charts was made"));
        EXPECT_EQ(stage.long_work().size(), run == 0 ? 2U : 0U);
    }
    EXPECT_EQ(cache.entries(), 2U);
    expect_equal(bakes[0].position, bakes[1].position);
    expect_equal(bakes[0].seam, bakes[1].seam);
    // Another size is another map, but the same atlas; another shape is both.
    BakeStage stage(cache.path());
    stage.parameters["size"] = 32;
    stage.use(mesh);
    (void)stage.bake();
    EXPECT_EQ(cache.entries(), 3U);
    mesh.positions[3].z += 1.0F;
    stage.use(mesh);
    (void)stage.bake();
    EXPECT_EQ(cache.entries(), 5U);
}

// --- Made atlases.

/// A lumpy ball.
MeshData ball(int n) {
    return sheet(
        2 * n, n,
        [](double s, double t) {
            const double a = 6.283185307179586 * (s == 1.0 ? 0.0 : s);
            const double b = 3.141592653589793 * t;
            const double r =
                20.0 + 3.0 * std::sin(3.0 * a) * std::sin(b) * std::sin(b) + 2.0 * std::cos(4.0 * b);
            return r * glm::dvec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
        },
        [](double, double) { return glm::dvec2(0.0); });
}

void expect_good_atlas(const MeshData& mesh, const char* name, double least_coverage) {
    const std::vector<std::uint32_t> place = io::first_at_same_place(mesh.positions);
    const MeshAtlas atlas = make_atlas(mesh.positions, mesh.indices, place);
    const UvUse use = measure_uvs(atlas.uvs, atlas.indices);
    std::printf("  %s: %zu charts, coverage %.1f %%, stretch %.2f on average, %.2f at most\n", name,
                atlas.charts, 100.0 * use.covered, atlas.mean_stretch, atlas.most_stretch);
    EXPECT_EQ(use.overlap, 0.0) << name;
    EXPECT_FALSE(use.beyond) << name;
    EXPECT_GT(use.covered, least_coverage) << name;
    // The cosine of 65 degrees.
    EXPECT_LE(atlas.most_stretch, 2.37) << name;
    // Triangles are as they were, only that vertices may be repeated.
    ASSERT_EQ(atlas.indices.size(), mesh.indices.size());
    for (std::size_t i = 0; i < atlas.indices.size(); ++i) {
        const std::uint32_t v = atlas.indices[i];
        ASSERT_EQ(v < mesh.positions.size() ? v : atlas.origin[v - mesh.positions.size()], mesh.indices[i]);
    }
    // Areas in the texture are those of the surface, shortened by the cosine.
    for (std::size_t t = 0; t + 2 < atlas.indices.size(); t += 3) {
        const auto uv = [&](std::size_t k) { return glm::dvec2(atlas.uvs[atlas.indices[t + k]]); };
        const auto p = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[t + k]]); };
        const glm::dvec2 e1 = (uv(1) - uv(0)) / atlas.scale;
        const glm::dvec2 e2 = (uv(2) - uv(0)) / atlas.scale;
        const double flat = std::abs(e1.x * e2.y - e1.y * e2.x);
        const double area = glm::length(glm::cross(p(1) - p(0), p(2) - p(0)));
        const double rounding = 1e-6 / atlas.scale * (glm::length(e1) + glm::length(e2));
        ASSERT_LE(flat, area + rounding);
        ASSERT_GE(flat + rounding, area / 2.37);
    }
}

TEST(TissueAtlas, GivesEveryPlaceItsOwnTexels) {
    expect_good_atlas(ball(24), "lumpy ball", 0.35);
    // Rough enough that single triangles face away from their chart.
    MeshData rough = ball(24);
    std::mt19937 random(7);
    std::map<std::uint32_t, glm::vec3> moved;
    const auto place = io::first_at_same_place(rough.positions);
    for (std::size_t v = 0; v < rough.positions.size(); ++v) {
        const auto [entry, is_new] = moved.try_emplace(place[v], rough.positions[v]);
        if (is_new) {
            entry->second += glm::vec3(static_cast<float>(random() % 1000U) * 1.2e-3F);
        }
        rough.positions[v] = entry->second;
    }
    expect_good_atlas(rough, "rough ball", 0.1);
}

TEST(TissueAtlas, OfRealLiversIsSound) {
    const std::string folder = VISCERA_DATA_DIR;
    if (folder.empty() || !std::filesystem::exists(folder + "/organs")) {
        GTEST_SKIP() << "needs VISCERA_DATA_DIR";
    }
    Log log;
    expect_good_atlas(io::merge(io::load_meshes(folder + "/organs/liver-smoothUV.obj", {}, log)),
                      "liver-smoothUV", 0.4);
    expect_good_atlas(io::merge(io::load_meshes(folder + "/organs/VH_M_Liver.glb", {}, log)), "VH_M_Liver",
                      0.2);
}

TEST(TissueAtlas, DependsOnTheShapeAloneAndNotOnItsSize) {
    MeshData mesh = ball(8);
    const auto place = io::first_at_same_place(mesh.positions);
    const MeshAtlas one = make_atlas(mesh.positions, mesh.indices, place);
    for (const float size : {0x1.0p-20F, 0x1.0p13F}) {
        MeshData other = mesh;
        for (glm::vec3& p : other.positions) {
            p *= size;
        }
        const MeshAtlas atlas = make_atlas(other.positions, other.indices, place);
        EXPECT_EQ(atlas.uvs, one.uvs);
        EXPECT_EQ(atlas.indices, one.indices);
    }
}

TEST(TissueAtlas, IsMadeForWhatHasNoUsableCoordinatesAndSaysSo) {
    BakeStage stage;
    MeshData mesh = patch();
    mesh.uvs.clear();
    stage.use(mesh);
    (void)stage.bake();
    EXPECT_TRUE(stage.has_said("has no texture coordinates; an atlas of 1 charts was made"));
    // All triangles on one.
    MeshData same = patch();
    MeshData soup;
    for (const std::uint32_t i : same.indices) {
        soup.indices.push_back(static_cast<std::uint32_t>(soup.positions.size()));
        soup.positions.push_back(same.positions[i]);
        soup.uvs.push_back(
            std::array{glm::vec2(0.0F), glm::vec2(1.0F, 0.0F), glm::vec2(1.0F)}[soup.positions.size() % 3]);
    }
    soup.normals = io::vertex_normals(soup);
    stage.use(soup);
    const Baked baked = stage.bake();
    EXPECT_TRUE(stage.has_said("puts several triangles on one place of the texture"));
    // The chart hangs together although no two triangles share a vertex: no seam but at its border.
    int inside = 0;
    for (int i = 0; i < 64 * 64; ++i) {
        inside += baked.inside(i % 64, i / 64) ? 1 : 0;
        if (baked.gutter(i % 64, i / 64)) {
            ASSERT_EQ(baked.seam.at(i % 64, i / 64, 0), -1.0F);
        }
    }
    EXPECT_GT(inside, 1500);
}

}  // namespace
}  // namespace viscera::test
