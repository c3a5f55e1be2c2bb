#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "effects/tissue/texel_map.h"
#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/surface_mesh.h"
#include "tests/tissue/bake_stage.h"

// Where the surface goes on beyond the borders of charts.
namespace viscera::test {
namespace {

using std::numbers::pi;

glm::dvec2 turned(const glm::dvec2& p, double degrees) {
    const double angle = degrees * pi / 180.0;
    return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y};
}

/// A flat square of 64 mm cut at x = 32 into two charts. The right one lies elsewhere in the texture, turned,
/// mirrored, and of another size.
struct CutPlane {
    double degrees = 0.0;
    bool mirrored = false;
    double scale = 1.0;

    static constexpr double left_scale = 0.22 / 32.0;  // texture widths per mm

    [[nodiscard]] glm::dvec2 left(const glm::dvec2& mm) const {
        return glm::dvec2(0.05, 0.1) + left_scale * mm;
    }
    [[nodiscard]] glm::dvec2 right(const glm::dvec2& mm) const {
        glm::dvec2 p = (mm - glm::dvec2(48.0, 32.0)) * (scale * left_scale);
        p.x = mirrored ? -p.x : p.x;
        return glm::dvec2(0.66, 0.5) + turned(p, degrees);
    }
    [[nodiscard]] MeshData mesh() const {
        const auto half = [&](double x0, auto&& uv) {
            return sheet(
                5, 10, [=](double s, double t) { return glm::dvec3(x0 + 32.0 * s, 64.0 * t, 5.0); },
                [&, x0](double s, double t) { return uv(glm::dvec2(x0 + 32.0 * s, 64.0 * t)); });
        };
        return together(half(0.0, [&](const glm::dvec2& p) { return left(p); }),
                        half(32.0, [&](const glm::dvec2& p) { return right(p); }));
    }
};

TEST(TissueSeam, AFlatSurfaceGoesOnAsIfItWereNotCut) {
    for (const CutPlane& plane :
         {CutPlane{}, CutPlane{90.0, false, 1.0}, CutPlane{37.0, true, 1.0}, CutPlane{-15.0, false, 0.7}}) {
        BakeStage stage;
        stage.parameters["size"] = 128;
        stage.use(plane.mesh());
        const Baked baked = stage.bake();
        int crossed = 0;
        double worst_place = 0.0;
        double worst_uv = 0.0;
        for (int y = 0; y < baked.height; ++y) {
            for (int x = 0; x < baked.width; ++x) {
                // The gutter right of the left chart, clear of its corners.
                const glm::dvec2 mm = (baked.uv(x, y) - glm::dvec2(0.05, 0.1)) / CutPlane::left_scale;
                if (!baked.gutter(x, y) || mm.x < 32.0 || mm.x > 37.0 || mm.y < 1.0 || mm.y > 63.0) {
                    continue;
                }
                ++crossed;
                const glm::dvec3 p(baked.at(baked.position, x, y));
                worst_place = std::max(worst_place, glm::distance(p, glm::dvec3(mm, 5.0)));
                const glm::dvec2 seam(baked.at(baked.seam, x, y));
                worst_uv = std::max(worst_uv, glm::distance(seam, plane.right(mm)));
                // It is measured by its own chart.
                EXPECT_NEAR(baked.metric.at(x, y, 0), 1.0 / (128.0 * CutPlane::left_scale), 1e-4);
            }
        }
        std::printf("  %d texels, place %.1e mm, uv %.1e\n", crossed, worst_place, worst_uv);
        EXPECT_GE(crossed, 4 * 50);
        EXPECT_LT(worst_place, 2e-5);
        EXPECT_LT(worst_uv, 2e-6);
    }
}

TEST(TissueSeam, GuttersAreAtLeastFourTexelsWide) {
    BakeStage stage;
    stage.parameters["size"] = 128;
    stage.use(CutPlane{20.0, false, 1.0}.mesh());
    const Baked baked = stage.bake();
    for (int y = 4; y + 4 < baked.height; ++y) {
        for (int x = 4; x + 4 < baked.width; ++x) {
            if (!baked.inside(x, y)) {
                continue;
            }
            for (int dy = -4; dy <= 4; ++dy) {
                for (int dx = -4; dx <= 4; ++dx) {
                    if (dx * dx + dy * dy <= 16) {
                        ASSERT_GT(baked.position.at(x + dx, y + dy, 3), 0.0F) << x << " " << y;
                    }
                }
            }
        }
    }
}

TEST(TissueSeam, AnOpenBorderGoesNowhere) {
    BakeStage stage;
    stage.use(sheet(
        3, 3, [](double s, double t) { return glm::dvec3(40.0 * s, 40.0 * t, 0.0); },
        [](double s, double t) { return glm::dvec2(0.25 + 0.5 * s, 0.25 + 0.5 * t); }));
    const Baked baked = stage.bake();
    int gutters = 0;
    for (int y = 0; y < baked.height; ++y) {
        for (int x = 0; x < baked.width; ++x) {
            if (!baked.gutter(x, y)) {
                continue;
            }
            ++gutters;
            EXPECT_EQ(baked.seam.at(x, y, 0), -1.0F);
            EXPECT_EQ(baked.seam.at(x, y, 1), -1.0F);
            // The nearest place of the border.
            const glm::dvec2 nearest = glm::clamp((baked.uv(x, y) - 0.25) * 80.0, 0.0, 40.0);
            EXPECT_NEAR(baked.position.at(x, y, 0), nearest.x, 1e-5);
            EXPECT_NEAR(baked.position.at(x, y, 1), nearest.y, 1e-5);
        }
    }
    EXPECT_GT(gutters, 500);
}

/// Of a bake: from each texel at a border one step into the gutter. The world's distance between the two
/// is at most the step's own length, and the place named by the seam is the place itself.
void expect_continuous(const Baked& baked, const reference::BakedSurface& surface, double longest_ratio) {
    const glm::dvec2 texels(baked.width, baked.height);
    int steps = 0;
    int long_steps = 0;
    double worst_ratio = 0.0;
    double worst_jump = 0.0;
    for (int y = 1; y + 1 < baked.height; ++y) {
        for (int x = 1; x + 1 < baked.width; ++x) {
            if (!baked.inside(x, y)) {
                continue;
            }
            const glm::dvec3 here(baked.at(baked.position, x, y));
            for (const glm::ivec2& step :
                 {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
                const int gx = x + step.x;
                const int gy = y + step.y;
                if (!baked.gutter(gx, gy) || baked.seam.at(gx, gy, 0) == -1.0F) {
                    continue;
                }
                ++steps;
                const glm::dvec3 there(baked.at(baked.position, gx, gy));
                const int c = step.x != 0 ? 0 : 1;
                const double length = std::max(baked.metric.at(x, y, c), baked.metric.at(gx, gy, c));
                const double ratio = glm::distance(here, there) / length;
                worst_ratio = std::max(worst_ratio, ratio);
                long_steps += ratio > 1.02 ? 1 : 0;
            }
        }
    }
    // Every seventh gutter texel by brute force.
    for (int i = 0; i < baked.width * baked.height; i += 7) {
        const int x = i % baked.width;
        const int y = i / baked.width;
        if (!baked.gutter(x, y) || baked.seam.at(x, y, 0) == -1.0F) {
            continue;
        }
        const glm::dvec3 place(baked.at(baked.position, x, y));
        const glm::dvec2 seam(baked.at(baked.seam, x, y));
        double nearest = 1e30;
        // The seam's texture coordinates are floats: on a border they may lie a little outside.
        for (const glm::dvec2& off : {glm::dvec2(0.0), glm::dvec2(1e-5, 0.0), glm::dvec2(-1e-5, 0.0),
                                      glm::dvec2(0.0, 1e-5), glm::dvec2(0.0, -1e-5)}) {
            for (const reference::BakedPoint& p : reference::baked_points(surface, seam + off, texels)) {
                nearest = std::min(nearest, glm::distance(p.position, place) / glm::length(p.du));
            }
        }
        worst_jump = std::max(worst_jump, nearest);
    }
    std::printf(
        "  %d steps over seams, longest %.3f of a texel, %d beyond 1.02; seam and place apart %.1e texels\n",
        steps, worst_ratio, long_steps, worst_jump);
    EXPECT_GT(steps, 100);
    EXPECT_LT(worst_ratio, longest_ratio);
    EXPECT_LT(worst_jump, 0.05);
}

/// A box whose faces lie apart in the texture.
MeshData box() {
    MeshData all;
    const glm::dvec3 half(20.0, 15.0, 10.0);
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        const double side = face % 2 == 0 ? -1.0 : 1.0;
        const glm::dvec2 corner(0.06 + 0.32 * (face % 3), 0.1 + 0.45 * (face / 3));
        const MeshData one = sheet(
            2, 2,
            [&](double s, double t) {
                glm::dvec3 p(0.0);
                p[axis] = side * half[axis];
                p[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * s - 1.0) * side;
                p[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * t - 1.0);
                return p;
            },
            [&](double s, double t) {
                const double a = half[(axis + 1) % 3] / 20.0;
                const double b = half[(axis + 2) % 3] / 20.0;
                return corner + 0.24 * glm::dvec2(a * s, b * t);
            });
        all = face == 0 ? one : together(all, one);
    }
    return all;
}

TEST(TissueSeam, WalkingOverTheEdgesOfABoxIsContinuous) {
    BakeStage stage;
    stage.parameters["size"] = 128;
    const MeshData mesh = box();
    stage.use(mesh);
    // All charts have one scale and right angles: no step may be longer than it is flat.
    expect_continuous(stage.bake(), surface_of(mesh), 1.001);
}

TEST(TissueSeam, WalkingOverTheSeamsOfTheOrganIsContinuous) {
    BakeStage stage;
    stage.parameters["size"] = 256;
    const std::string file = std::string(VISCERA_SOURCE_DIR) + "/assets/meshes/organ.glb";
    stage.parameters["mesh"] = {{"file", file}};
    Log log;
    const MeshData mesh = io::merge(io::load_meshes(file, {}, log));
    // A texel's step may cross triangles of another stretch than its own on the way, up to 2.4.
    expect_continuous(stage.bake(), surface_of(mesh), 2.4);
}

TEST(TissueSeam, WalkingOverTheSeamsOfASpleenIsContinuous) {
    const std::string file = std::string(VISCERA_DATA_DIR) + "/organs/VH_M_Spleen.glb";
    if (std::string(VISCERA_DATA_DIR).empty() || !std::filesystem::exists(file)) {
        GTEST_SKIP() << "needs VISCERA_DATA_DIR";
    }
    BakeStage stage;
    stage.parameters["size"] = 256;
    stage.parameters["mesh"] = {{"file", file}};
    Log log;
    const MeshData mesh = io::merge(io::load_meshes(file, {}, log));
    expect_continuous(stage.bake(), surface_of(mesh), 8.0);
}

TEST(TissueSeam, MirroredTextureHalvesMeetAtTheirFold) {
    // Both halves of a strip use one place of the texture, folded along their common edge: the right half is
    // painted over, but what leaves the left one over the fold enters the right one.
    const auto place = [](double s, double t) { return glm::dvec3(40.0 * s, 30.0 * t, 0.0); };
    const MeshData mesh = sheet(4, 2, place, [](double s, double t) {
        return glm::dvec2(0.2 + 0.8 * std::min(s, 1.0 - s), 0.2 + 0.5 * t);
    });
    BakeStage stage;
    stage.use(mesh);
    const Baked baked = stage.bake();
    EXPECT_TRUE(stage.has_said("several triangles on one place")) << "of the atlas made instead";
    stage.parameters["mesh"]["atlas"] = "file";
    const Baked folded = stage.bake();
    EXPECT_TRUE(stage.has_said("lie in more than one triangle"));
    const int x = static_cast<int>(0.6 * 64) + 2;
    ASSERT_TRUE(folded.gutter(x, 32));
    // Two texels and a half beyond the fold at 20 mm, less than 40 mm.
    const double mm = 20.0 + ((x + 0.5) / 64.0 - 0.6) / 0.8 * 40.0;
    EXPECT_NEAR(folded.position.at(x, 32, 0), mm, 1e-3);
    EXPECT_NEAR(folded.seam.at(x, 32, 0), 0.6 - ((x + 0.5) / 64.0 - 0.6), 1e-5);
    for (int i = 0; i < baked.width * baked.height; ++i) {
        ASSERT_TRUE(std::isfinite(folded.metric.at(i % 64, i / 64, 3)));
    }
}

/// By triangle a vertex that stands for its chart: an atlas repeats those that charts share.
std::vector<std::uint32_t> charts_of(const MeshData& mesh) {
    std::vector<std::uint32_t> chart(mesh.positions.size());
    std::iota(chart.begin(), chart.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (chart[v] != v) {
            v = chart[v] = chart[chart[v]];
        }
        return v;
    };
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        chart[find(mesh.indices[i])] = find(mesh.indices[i / 3 * 3]);
    }
    std::vector<std::uint32_t> of_triangle;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        of_triangle.push_back(find(mesh.indices[t]));
    }
    return of_triangle;
}

/// Texels within 4 texels of one that a chart covers which do not belong to that chart.
int missing_gutter(const tissue::TexelMap& map, const MeshData& mesh) {
    const std::vector<std::uint32_t> charts = charts_of(mesh);
    const auto chart_at = [&](int x, int y) {
        const float owner = map.texels[static_cast<std::size_t>(y * map.size + x)].owner;
        return owner == 0.0F ? -1 : static_cast<int>(charts[static_cast<std::size_t>(std::abs(owner)) - 1]);
    };
    int missing = 0;
    for (int y = 0; y < map.size; ++y) {
        for (int x = 0; x < map.size; ++x) {
            if (map.texels[static_cast<std::size_t>(y * map.size + x)].owner <= 0.0F) {
                continue;
            }
            for (int v = std::max(y - 4, 0); v <= std::min(y + 4, map.size - 1); ++v) {
                for (int u = std::max(x - 4, 0); u <= std::min(x + 4, map.size - 1); ++u) {
                    const bool near = (u - x) * (u - x) + (v - y) * (v - y) <= 16;
                    missing += near && chart_at(u, v) != chart_at(x, y) ? 1 : 0;
                }
            }
        }
    }
    return missing;
}

/// Two sheets, each with all of the texture for itself.
std::string overlapping_sheets() {
    std::string obj;
    for (const int part : {0, 1}) {
        obj += "o part" + std::to_string(part) + "\n";
        const int first = 4 * part;
        for (const glm::ivec2& p :
             {glm::ivec2(0, 0), glm::ivec2(10, 0), glm::ivec2(10, 10), glm::ivec2(0, 10)}) {
            obj += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(20 * part) +
                   "\n";
            obj += "vt " + std::to_string(p.x / 10) + " " + std::to_string(p.y / 10) + "\n";
        }
        for (const glm::ivec3& c : {glm::ivec3(1, 2, 3), glm::ivec3(1, 3, 4)}) {
            obj += "f";
            for (int k = 0; k < 3; ++k) {
                const std::string i = std::to_string(first + c[k]);
                obj += " " + i + "/" + i;
            }
            obj += "\n";
        }
    }
    return obj;
}

TEST(TissueSeam, GuttersOfMadeAtlasesAreFourTexelsWideFrom512On) {
    std::string said;
    Log log([&](LogLevel, std::string_view message) { said += std::string(message) + "\n"; });
    Assets assets(log);
    const TempFolder folder;
    SurfaceMeshParams generated;
    generated.file.path = std::string(VISCERA_SOURCE_DIR) + "/assets/meshes/organ.glb";
    generated.atlas = AtlasSource::generated;
    SurfaceMeshParams tiled;
    tiled.file.path = folder.write("tiled.obj", overlapping_sheets());
    for (const SurfaceMeshParams& params : {generated, tiled}) {
        const auto mesh = SurfaceMesh::load(assets, params);
        for (const int size : {512, 128}) {
            const tissue::TexelMap map = tissue::make_texel_map(tissue::texel_surface(*mesh), size);
            const int missing = missing_gutter(map, mesh->data());
            EXPECT_EQ(missing == 0, size == 512) << params.file.path << ": " << missing;
            EXPECT_EQ(map.faults.narrow_texels == 0, size == 512) << params.file.path;
        }
    }
    EXPECT_NE(said.find("each gets a tile of its own"), std::string::npos) << said;
}

TEST(TissueSeam, GuttersThatAreTooNarrowAreSaid) {
    BakeStage stage;
    stage.parameters["mesh"] = {{"file", std::string(VISCERA_SOURCE_DIR) + "/assets/meshes/organ.glb"},
                                {"atlas", "generated"}};
    stage.parameters["size"] = 128;
    (void)stage.bake();
    EXPECT_TRUE(stage.has_said("narrower than that at a 'size' of 128"));
    const auto faults = stage.renderer().log().faults();
    ASSERT_TRUE(faults.contains("tissue.gutter"));
    stage.parameters["size"] = 512;
    (void)stage.bake();
    EXPECT_EQ(stage.renderer().log().faults().at("tissue.gutter"), faults.at("tissue.gutter"));
}

}  // namespace
}  // namespace viscera::test
