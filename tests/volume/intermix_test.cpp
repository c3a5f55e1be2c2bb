#include <gtest/gtest.h>

#include "engine/gl/functions.h"
#include "engine/gl/texture.h"
#include "tests/volume/mixed_scene.h"

// Opaque meshes in a homogeneous volume: what is seen of the volume in front of a mesh is 1 - exp(-sigma L).

namespace viscera::test {
namespace {

constexpr double sigma = 0.008;        // [1/mm]
constexpr double half_side_mm = 80.0;  // of the volume
constexpr double tolerance = 1e-5;

nlohmann::json homogeneous() {
    const double opacity = 1.0 - std::exp(-sigma);
    const nlohmann::json colour{0.25, 0.5, 1.0};
    return {{"transfer_function",
             {{"points",
               {{{"value", 0}, {"colour", colour}, {"opacity", opacity}},
                {{"value", 255}, {"colour", colour}, {"opacity", opacity}}}}}},
            {"sampling", {{"termination", 0}}}};
}

class Intermixed : public testing::TestWithParam<ComputeUse> {
  protected:
    nlohmann::json surface(const MeshData& mesh, nlohmann::json more = nlohmann::json::object()) {
        // Files that have been read are not read again, so each has a name of its own.
        const std::string name = "mesh" + std::to_string(meshes_++) + ".obj";
        more["mesh"] = folder_.write(name, obj_text(mesh)).string();
        return {{{"name", "surface"}, {"effect", "mesh.surface"}, {"parameters", more}}};
    }

    /// Holds every pixel against the closed form; those at a silhouette or an edge of the box are left out
    /// where a ray a little aside would give another length.
    void expect_closed_form(const nlohmann::json& scene, const MeshData& mesh) {
        const Image got = mixed_shot(stage_, scene, volume_);
        const View view = stage_.renderer().still(0.0).eye();
        double worst = 0.0;
        std::size_t cut = 0;
        std::size_t left_out = 0;
        for (int y = 0; y < got.height; ++y) {
            for (int x = 0; x < got.width; ++x) {
                const PixelRay ray = pixel_ray(view, x, y, got.width, got.height);
                const glm::dvec2 inside =
                    box_interval(ray, glm::dvec3(-half_side_mm), glm::dvec3(half_side_mm));
                double end = inside.y;
                bool covered = false;
                for (const double s : crossings(ray, mesh)) {
                    if (s > 0.0 && s < ray.far) {
                        covered = true;
                        end = std::min(end, s);
                    }
                }
                // Whether a pixel on a silhouette is covered is the rasteriser's to say.
                bool edge = false;
                for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                    const PixelRay beside = pixel_ray(view, x + dx, y + dy, got.width, got.height);
                    edge = edge || crossings(beside, mesh).size() != crossings(ray, mesh).size();
                }
                if (edge) {
                    ++left_out;
                    continue;
                }
                const double length = std::max(end - inside.x, 0.0);
                const double alpha = 1.0 - std::exp(-sigma * length);
                cut += covered && length > 1.0 && end < inside.y ? 1U : 0U;
                // Where there is a mesh, the picture is opaque.
                worst = std::max(worst, std::abs(got.at(x, y, 3) - (covered ? 1.0 : alpha)));
                if (!covered) {
                    worst = std::max(worst, std::abs(got.at(x, y, 2) - alpha));
                } else {
                    // The mesh is black, so all colour is the volume's.
                    worst = std::max(worst, std::abs(got.at(x, y, 2) - alpha));
                    worst = std::max(worst, std::abs(got.at(x, y, 0) - 0.25 * alpha));
                }
            }
        }
        EXPECT_LE(worst, tolerance);
        EXPECT_GT(cut, 300U);
        EXPECT_LT(left_out, static_cast<std::size_t>(got.width * got.height) / 4);
        EXPECT_EQ(stage_.complaints(), std::vector<std::string>{});
    }

    static nlohmann::json black() {
        return {{"colour", {0, 0, 0}}, {"specular", 0}, {"ambient", 0}, {"diffuse", 0}};
    }
    static MeshData plane() {
        MeshData mesh;
        mesh.positions = {{-200, 13, -200}, {200, -41, -200}, {200, 7, 200}, {-200, 61, 200}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        return mesh;
    }

    TempFolder folder_;
    int meshes_ = 0;
    LiveVolume volume_{byte_volume(16, 10.0, [](const glm::dvec3&) { return 200.0; })};
    Stage stage_{Backend::osmesa, {}, GetParam()};
};

TEST_P(Intermixed, APlaneCutsTheVolumeInPerspective) {
    expect_closed_form(
        mixed_scene(surface(plane(), black()), homogeneous(), camera_at({60, -420, 90}, 200, 800)), plane());
}

TEST_P(Intermixed, APlaneCutsTheVolumeOrthographically) {
    expect_closed_form(mixed_scene(surface(plane(), black()), homogeneous(), orthographic_at({60, -420, 90})),
                       plane());
}

TEST_P(Intermixed, ABallInTheVolume) {
    const MeshData ball = ball_mesh({12, -20, 15}, 45);
    expect_closed_form(
        mixed_scene(surface(ball, black()), homogeneous(), camera_at({60, -420, 90}, 200, 800)), ball);
}

TEST_P(Intermixed, TheEyeInTheVolume) {
    const MeshData ball = ball_mesh({12, 20, 15}, 30);
    expect_closed_form(mixed_scene(surface(ball, black()), homogeneous(), camera_at({-20, -70, -10}, 5, 400)),
                       ball);
}

TEST_P(Intermixed, WithoutAMeshThePictureIsTheVolumesAlone) {
    nlohmann::json scene = mixed_scene(nlohmann::json::array(), homogeneous(), camera_at({60, -420, 90}));
    const Image alone = mixed_shot(stage_, scene, volume_);
    // A mesh out of sight: bound, but empty.
    MeshData away = plane();
    for (glm::vec3& p : away.positions) {
        p.y -= 3000.0F;
    }
    const Image with =
        mixed_shot(stage_, mixed_scene(surface(away), homogeneous(), camera_at({60, -420, 90})), volume_);
    EXPECT_EQ(difference(alone, with).max, 0.0);
    EXPECT_GT(difference(alone, with).seen, 500U);
}

TEST_P(Intermixed, AMeshBehindTheVolumeIsSeenThroughIt) {
    MeshData behind = plane();
    for (glm::vec3& p : behind.positions) {
        p.y += 300.0F;
    }
    const nlohmann::json camera = camera_at({60, -420, 90});
    const Image alone =
        mixed_shot(stage_, mixed_scene(nlohmann::json::array(), homogeneous(), camera), volume_);
    const nlohmann::json scene = mixed_scene(surface(behind), homogeneous(), camera);
    const Image mesh = mixed_shot(stage_, scene, volume_, "mesh.colour");
    const Image both = mixed_shot(stage_, scene, volume_);
    double worst = 0.0;
    for (int y = 0; y < both.height; ++y) {
        for (int x = 0; x < both.width; ++x) {
            for (int c = 0; c < 4; ++c) {
                const double over = alone.at(x, y, c) + (1.0 - alone.at(x, y, 3)) * mesh.at(x, y, c);
                worst = std::max(worst, std::abs(both.at(x, y, c) - over));
            }
        }
    }
    EXPECT_LE(worst, 1e-6);
}

TEST_P(Intermixed, WithoutAVolumeInSightTheMeshRemains) {
    nlohmann::json parameters = homogeneous();
    parameters["volume"]["placement"]["move_mm"] = {-3000, 0, 0};
    const nlohmann::json scene = mixed_scene(surface(plane()), parameters, camera_at({60, -420, 90}));
    FrameReport report;
    const Image both = mixed_shot(stage_, scene, volume_, "volume.colour", &report);
    EXPECT_EQ(pass_of(report, "cast").status, PassStatus::idle);
    const Difference d = difference(mixed_shot(stage_, scene, volume_, "mesh.colour"), both);
    EXPECT_EQ(d.max, 0.0);
    EXPECT_GT(d.seen, 500U);
}

TEST_P(Intermixed, ADepthOfTheHostsEndsRays) {
    // The host's depth says that there is a wall at 400 mm in front of the eye.
    stage_.make_current();
    const nlohmann::json camera = camera_at({0, -420, 0}, 200, 800);
    nlohmann::json scene = mixed_scene(nlohmann::json::array(), homogeneous(), camera);
    const std::unique_ptr<const gl::Functions> gl = gl::Functions::load(stage_.context().proc_address());
    gl::Texture depth = gl::Texture::make_2d(*gl, 96, 80, PixelFormat::depth32f, "host depth");
    const double window = (1.0 / 200 - 1.0 / 400) / (1.0 / 200 - 1.0 / 800);
    const std::vector<float> texels(96 * 80, static_cast<float>(window));
    depth.upload(std::as_bytes(std::span(texels)));
    const ImportedTarget target{"mesh.depth", PixelFormat::depth32f, 96, 80};
    const ImportedTexture import{"mesh.depth", depth.id(), PixelFormat::depth32f, 96, 80};
    const auto file = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes" / "test.json";
    stage_.renderer().set_scene(parse_scene(scene.dump(), file), std::span(&target, 1));
    const HostVolume given{"host", &volume_};
    Frame frame = stage_.renderer().still(0.0);
    frame.volumes = std::span(&given, 1);
    frame.imported = std::span(&import, 1);
    stage_.renderer().render(frame);
    const Image got = stage_.renderer().read("volume.colour");
    const View view = frame.eye();
    double worst = 0.0;
    std::size_t seen = 0;
    for (int y = 0; y < got.height; ++y) {
        for (int x = 0; x < got.width; ++x) {
            const PixelRay ray = pixel_ray(view, x, y, got.width, got.height);
            const glm::dvec2 inside = box_interval(ray, glm::dvec3(-half_side_mm), glm::dvec3(half_side_mm));
            const double wall = 200.0 / glm::dot(ray.direction, view.forward);  // from the near plane
            const double alpha = 1.0 - std::exp(-sigma * std::max(std::min(inside.y, wall) - inside.x, 0.0));
            worst = std::max(worst, std::abs(got.at(x, y, 3) - alpha));
            seen += alpha > 0.1 ? 1U : 0U;
        }
    }
    EXPECT_LE(worst, tolerance);
    EXPECT_GT(seen, 500U);
}

TEST_P(Intermixed, BothSidesOfAMeshAreDrawnOrOne) {
    const nlohmann::json camera = camera_at({60, -420, 90});
    MeshData turned = plane();
    std::swap(turned.indices[1], turned.indices[2]);
    std::swap(turned.indices[4], turned.indices[5]);
    const auto seen = [&](const MeshData& mesh, bool two_sided, bool mirrored) {
        nlohmann::json parameters{{"two_sided", two_sided}};
        if (mirrored) {
            parameters["placement"]["scale"] = {-1, 1, 1};
        }
        const nlohmann::json scene = mixed_scene(surface(mesh, parameters), homogeneous(), camera);
        const Image image = mixed_shot(stage_, scene, volume_, "mesh.colour");
        return image.at(48, 40, 3) > 0.0F;
    };
    EXPECT_TRUE(seen(plane(), true, false));
    EXPECT_TRUE(seen(turned, true, false));
    EXPECT_NE(seen(plane(), false, false), seen(turned, false, false));
    // A mirror turns no outside into an inside.
    EXPECT_EQ(seen(plane(), false, true), seen(plane(), false, false));
    EXPECT_EQ(seen(turned, false, true), seen(turned, false, false));
}

TEST_P(Intermixed, LightsAreSummed) {
    const nlohmann::json camera = orthographic_at({0, -420, 0});
    const auto centre = [&](nlohmann::json parameters) {
        parameters["placement"]["rotate_deg"] = {0, 0, 0};
        MeshData wall;
        wall.positions = {{-200, 0, -200}, {200, 0, -200}, {200, 0, 200}, {-200, 0, 200}};
        wall.indices = {0, 1, 2, 0, 2, 3};
        nlohmann::json scene = mixed_scene(surface(wall, parameters), homogeneous(), camera);
        scene["camera"]["target_mm"] = {0, 0, 0};
        return mixed_shot(stage_, scene, volume_, "mesh.colour").at(48, 40, 0);
    };
    nlohmann::json plain{{"colour", {0.5, 0.5, 0.5}}, {"specular", 0}, {"ambient", 0.1}, {"diffuse", 0.6}};
    EXPECT_NEAR(centre(plain), 0.5 * (0.1 + 0.6), 1e-6);
    plain["headlight"] = 0;
    EXPECT_NEAR(centre(plain), 0.5 * 0.1, 1e-6);
    plain["lights"] = {{{"direction", {0, -1, 1}}, {"colour", {0.5, 0.5, 0.5}}}};
    EXPECT_NEAR(centre(plain), 0.5 * (0.1 + 0.6 * 0.5 * std::sqrt(0.5)), 1e-6);
    plain["lights"].push_back({{"direction", {0, 1, 0}}});  // behind
    EXPECT_NEAR(centre(plain), 0.5 * (0.1 + 0.6 * 0.5 * std::sqrt(0.5)), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Paths, Intermixed, testing::Values(ComputeUse::off, ComputeUse::on),
                         [](const auto& use) {
                             return use.param == ComputeUse::on ? std::string("Compute")
                                                                : std::string("Fragment");
                         });

}  // namespace
}  // namespace viscera::test
