#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/reference/volume_field.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

// Slices beside the field in double precision.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int slice_width = 72;
constexpr int slice_height = 56;

json slice_scene(json parameters, const json& camera = {}) {
    parameters["volume"]["host"] = "host";
    json scene{{"version", 1},
               {"resolution", {slice_width, slice_height}},
               {"passes", {{{"name", "slice"}, {"effect", "volume.slice"}, {"parameters", parameters}}}},
               {"targets", {{"volume.slice", {{"format", "rgba32f"}}}}},
               {"outputs", {"volume.slice"}}};
    if (!camera.is_null()) {
        scene["camera"] = camera;
    }
    return scene;
}

Image slice(Stage& stage, const LiveVolume& volume, const json& parameters, const json& camera = {},
            std::string_view target = "volume.slice") {
    return mixed_shot(stage, slice_scene(parameters, camera), volume, target);
}

/// Grey from 0 to 1 over [0, 1].
json grey_levels() {
    return {{"window", {{"width", 1}, {"level", 0.5}}}};
}

/// Smooth, in [0, 1], different along every axis and direction; anisotropic voxels off the world's origin.
Volume wavy_volume() {
    Volume volume = float_volume({24, 20, 16}, {1.5, 2.0, 3.0}, [](const glm::dvec3& p) {
        return 0.5 + 0.2 * std::sin(0.2 * p.x + 0.1 * p.y) + 0.2 * std::cos(0.15 * p.z - 0.12 * p.y) +
               0.002 * p.x;
    });
    volume.grid.origin_mm += glm::dvec3(10.0, -20.0, 30.0);
    return volume;
}

/// A frame on a plane as the picture has it, in the test's own words.
struct Sheet {
    glm::dvec3 centre;
    glm::dvec3 right;
    glm::dvec3 up;
    double height_mm;

    [[nodiscard]] glm::dvec3 at(int x, int y) const {
        const double mm = height_mm / slice_height;
        return centre + (x + 0.5 - 0.5 * slice_width) * mm * right + (y + 0.5 - 0.5 * slice_height) * mm * up;
    }
};

/// Whether a place is in the box, and not so near its faces that rounding decides.
enum class Place { inside, outside, face };
Place place_of(const glm::dvec3& t) {
    const glm::dvec3 depth = glm::min(t, 1.0 - t);
    const double least = std::min({depth.x, depth.y, depth.z});
    return least > 1e-5 ? Place::inside : least < -1e-5 ? Place::outside : Place::face;
}

void expect_field(const Image& image, const reference::Field& field, const Sheet& sheet, double tolerance) {
    int inside = 0;
    for (int y = 0; y < slice_height; ++y) {
        for (int x = 0; x < slice_width; ++x) {
            const glm::dvec3 t = field.world_to_texture() * glm::dvec4(sheet.at(x, y), 1.0);
            const Place place = place_of(t);
            if (place == Place::outside) {
                ASSERT_EQ(image.at(x, y, 2), 0.25F) << x << ", " << y;
            } else if (place == Place::inside) {
                ++inside;
                ASSERT_NEAR(image.at(x, y, 0), field.value(t), tolerance) << x << ", " << y;
                ASSERT_EQ(image.at(x, y, 3), 1.0F);
            }
        }
    }
    EXPECT_GT(inside, 500);
    EXPECT_LT(inside, slice_width * slice_height);
}

class Slice : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }
    Stage stage_;
};

TEST_F(Slice, values_are_those_of_the_field) {
    const Volume volume = wavy_volume();
    const LiveVolume live(volume);
    const reference::Field field(volume, reference::Filter::trilinear);
    const glm::dvec3 n = glm::normalize(glm::dvec3(0.3, -0.8, 0.5));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.1, 0.2, 1.0), n));
    const Sheet sheet{{12.0, -18.0, 28.0}, right, glm::cross(n, right), 60.0};
    const json oblique = {{"point_mm", {12, -18, 28}}, {"normal", {0.6, -1.6, 1.0}}, {"up", {0.1, 0.2, 1.0}}};
    for (const auto& storage : {"texture_3d", "atlas"}) {
        const Image image = slice(stage_, live,
                                  {{"transfer_function", grey_levels()},
                                   {"plane", {{"oblique", oblique}}},
                                   {"volume", {{"storage", storage}}},
                                   {"height_mm", 60},
                                   {"background", {0, 0, 0.5, 0.5}},
                                   {"sampling", {{"filter", "linear_fp32"}}}});
        expect_field(image, field, sheet, 2e-6);
    }
}

TEST_F(Slice, every_filter_is_the_field_s) {
    const Volume volume = wavy_volume();
    const LiveVolume live(volume);
    const Sheet sheet{{10.0, -20.0, 25.0}, {1, 0, 0}, {0, -1, 0}, 48.0};
    const auto check = [&](const json& sampling, reference::Filter filter, double tolerance) {
        const Image image = slice(stage_, live,
                                  {{"transfer_function", grey_levels()},
                                   {"plane", {{"position_mm", 25}}},
                                   {"height_mm", 48},
                                   {"background", {0, 0, 0.25, 1}},
                                   {"sampling", sampling}});
        expect_field(image, reference::Field(volume, filter), sheet, tolerance);
    };
    check({{"filter", "bspline_fp32"}}, reference::Filter::bspline_prefiltered, 2e-6);
    check({{"filter", "bspline_fp32"}, {"prefilter", false}}, reference::Filter::bspline, 2e-6);
    check({{"filter", "catmull_rom_fp32"}}, reference::Filter::catmull_rom, 2e-6);
    check({{"filter", "linear"}}, reference::Filter::trilinear, 2e-3);
}

// A bright spot towards the patient's left, front and head.
TEST_F(Slice, pictures_lie_as_radiologists_look_at_them) {
    const glm::dvec3 spot(12.0, -12.0, 12.0);
    const LiveVolume live(float_volume({20, 20, 20}, glm::dvec3(2.0), [&](const glm::dvec3& p) {
        return glm::length(p - spot) < 5.0 ? 1.0 : 0.1;
    }));
    const auto brightest = [&](const char* axis, double position) {
        const Image image = slice(
            stage_, live,
            {{"transfer_function", grey_levels()}, {"plane", {{"axis", axis}, {"position_mm", position}}}});
        glm::dvec2 sum(0.0);
        double count = 0.0;
        for (int y = 0; y < slice_height; ++y) {
            for (int x = 0; x < slice_width; ++x) {
                if (image.at(x, y, 0) > 0.8F) {
                    sum += glm::dvec2(x + 0.5 - 0.5 * slice_width, y + 0.5 - 0.5 * slice_height);
                    count += 1.0;
                }
            }
        }
        return sum / count * (40.0 / slice_height);  // [mm], as the volume fits the height
    };
    const auto expect_at = [](const glm::dvec2& got, const glm::dvec2& wanted) {
        EXPECT_NEAR(got.x, wanted.x, 0.5);
        EXPECT_NEAR(got.y, wanted.y, 0.5);
    };
    expect_at(brightest("axial", 12.0), {12.0, 12.0});      // left on the right, front up
    expect_at(brightest("coronal", -12.0), {12.0, 12.0});   // left on the right, head up
    expect_at(brightest("sagittal", 12.0), {-12.0, 12.0});  // front on the left, head up
}

TEST_F(Slice, oblique_planes_have_up_up_and_are_seen_from_their_normal) {
    const LiveVolume live(
        float_volume({20, 20, 20}, glm::dvec3(2.0), [](const glm::dvec3& p) { return 0.5 + 0.01 * p.x; }));
    // From the head: left and right change places beside the axial picture.
    const Image image = slice(stage_, live,
                              {{"transfer_function", grey_levels()},
                               {"height_mm", 40},
                               {"plane", {{"oblique", {{"normal", {0, 0, 1}}, {"up", {0, -1, 0}}}}}}});
    EXPECT_GT(image.at(slice_width / 2 - 12, slice_height / 2, 0),
              image.at(slice_width / 2 + 12, slice_height / 2, 0) + 0.1F);
}

TEST_F(Slice, thick_slabs_take_mean_and_extremes_across_them) {
    // Along z a parabola; x and y keep pictures from being flat. Linear between voxels 1 mm apart.
    const auto law = [](const glm::dvec3& p) { return 0.2 + 0.002 * p.z * p.z + 0.004 * p.x; };
    const LiveVolume live(float_volume({32, 32, 41}, {2.0, 2.0, 1.0}, law));
    const auto value = [&](const char* function, double thickness, double position) {
        return slice(stage_, live,
                     {{"transfer_function", grey_levels()},
                      {"height_mm", 40},
                      {"sampling", {{"filter", "linear_fp32"}}},
                      {"slab", {{"thickness_mm", thickness}, {"function", function}}},
                      {"plane", {{"position_mm", position}}}});
    };
    const auto at_middle = [](const Image& image) {
        return 0.5 * (static_cast<double>(image.at(slice_width / 2, slice_height / 2, 0)) +
                      static_cast<double>(image.at(slice_width / 2 - 1, slice_height / 2, 0)));
    };
    // Mean of z^2 over [3, 13]: (13^3 - 3^3) / 30; the chords of cells of 1 mm add 1/6, midpoints of half
    // cells take nothing from straight pieces.
    EXPECT_NEAR(at_middle(value("mean", 10.0, 8.0)), 0.2 + 0.002 * ((2197.0 - 27.0) / 30.0 + 1.0 / 6.0),
                2e-6);
    // Samples lie at the middles of stretches of half a voxel.
    const auto chord = [](double z) {
        const double low = std::floor(z);
        return low * low + (2.0 * low + 1.0) * (z - low);
    };
    EXPECT_NEAR(at_middle(value("mip", 10.0, 8.0)), 0.2 + 0.002 * chord(12.75), 2e-6);
    EXPECT_NEAR(at_middle(value("minip", 10.0, 8.0)), 0.2 + 0.002 * chord(3.25), 2e-6);
    // Where the slab leaves the volume, what is left counts: [10, 20.5], of which [20, 20.5] is constant.
    const double left = ((8000.0 - 1000.0) / 3.0 + 10.0 / 6.0 + 0.5 * 400.0) / 10.5;
    EXPECT_NEAR(at_middle(value("mean", 22.0, 21.0)), 0.2 + 0.002 * left, 2e-6);
}

TEST_F(Slice, a_narrow_window_has_all_its_greys) {
    // 8000 values, of which the window shows 80: 4096 entries over all of them would leave 40 greys.
    const LiveVolume live(float_volume({16, 16, 16}, glm::dvec3(2.0), [](const glm::dvec3& p) {
        return 40.0 + 100.0 * p.x * p.x * p.x / 338.0;
    }));
    const Image image = slice(stage_, live,
                              {{"transfer_function", {{"preset", "ct-brain"}}},
                               {"height_mm", 32},
                               {"sampling", {{"filter", "linear_fp32"}}}});
    const reference::Field field(live.volume(), reference::Filter::trilinear);
    for (int x = 0; x < slice_width; ++x) {
        const glm::dvec3 t = field.world_to_texture() *
                             glm::dvec4((x + 0.5 - 0.5 * slice_width) * 32.0 / slice_height, 0.3, 0.0, 1.0);
        if (place_of(t) == Place::inside) {
            ASSERT_NEAR(image.at(x, slice_height / 2, 0), std::clamp((field.value(t) - 0.0) / 80.0, 0.0, 1.0),
                        5e-6);
        }
    }
}

// The plane in the scene: where each pixel's ray meets it, the field's value and that place's depth.
void expect_plane(const Image& colour, const Image& depth, const View& view, const reference::Field& field,
                  const std::function<double(const PixelRay&)>& along) {
    int seen = 0;
    for (int y = 0; y < slice_height; ++y) {
        for (int x = 0; x < slice_width; ++x) {
            const PixelRay ray = pixel_ray(view, x, y, slice_width, slice_height);
            const double s = along(ray);
            const glm::dvec3 p = ray.origin + s * ray.direction;
            const glm::dvec3 t = field.world_to_texture() * glm::dvec4(p, 1.0);
            const bool in_view = s > 0.0 && s < ray.far;
            const glm::dvec3 edge = glm::min(t, 1.0 - t);
            const double least = std::min({edge.x, edge.y, edge.z});
            if (in_view && least > 1e-3) {
                ++seen;
                const glm::dvec4 clip = view.view_projection() * glm::dvec4(p, 1.0);
                ASSERT_NEAR(colour.at(x, y, 0), field.value(t), 5e-6) << x << ", " << y;
                ASSERT_EQ(colour.at(x, y, 3), 1.0F);
                ASSERT_NEAR(depth.at(x, y, 0), 0.5 + 0.5 * clip.z / clip.w, 1e-6) << x << ", " << y;
            } else if (!in_view || least < -1e-3) {
                ASSERT_EQ(colour.at(x, y, 3), 0.0F) << x << ", " << y;
                ASSERT_EQ(depth.at(x, y, 0), 1.0F) << x << ", " << y;
            }
        }
    }
    EXPECT_GT(seen, 300);
}

TEST_F(Slice, a_plane_stands_in_the_scene) {
    const Volume volume = wavy_volume();
    const LiveVolume live(volume);
    const reference::Field field(volume, reference::Filter::trilinear);
    json parameters = {{"view", "camera"},
                       {"transfer_function", grey_levels()},
                       {"sampling", {{"filter", "linear_fp32"}}},
                       {"plane", {{"oblique", {{"point_mm", {11, -19, 31}}, {"normal", {0.4, -1, 0.3}}}}}}};
    const glm::dvec3 n(0.4, -1.0, 0.3);
    for (json camera : {camera_at({90, -110, 80}), orthographic_at({-60, -110, 90})}) {
        camera["target_mm"] = {10, -20, 30};
        if (camera.contains("height_mm")) {
            camera["height_mm"] = 80;
        }
        const Image colour = slice(stage_, live, parameters, camera);
        const Image depth = slice(stage_, live, parameters, camera, "volume.slice_depth");
        expect_plane(colour, depth, stage_.renderer().still(0.0).eye(), field, [&](const PixelRay& ray) {
            return glm::dot(n, glm::dvec3(11, -19, 31) - ray.origin) / glm::dot(n, ray.direction);
        });
    }
}

TEST_F(Slice, a_mesh_shows_the_values_where_it_cuts) {
    const TempFolder folder;
    const MeshData ball = ball_mesh(glm::vec3(14.0F, -22.0F, 33.0F), 17.0F, 8);
    const auto file = folder.write("ball.obj", obj_text(ball));
    const Volume volume = wavy_volume();
    const LiveVolume live(volume);
    const reference::Field field(volume, reference::Filter::trilinear);
    json camera = camera_at({60, -110, 60});
    camera["target_mm"] = {10, -20, 30};
    camera["vertical_fov_deg"] = 26;
    const json parameters = {{"view", "camera"},
                             {"mesh", file.string()},
                             {"transfer_function", grey_levels()},
                             {"sampling", {{"filter", "linear_fp32"}}}};
    const Image colour = slice(stage_, live, parameters, camera);
    const View view = stage_.renderer().still(0.0).eye();
    int seen = 0;
    int cut_off = 0;
    for (int y = 0; y < slice_height; ++y) {
        for (int x = 0; x < slice_width; ++x) {
            const PixelRay ray = pixel_ray(view, x, y, slice_width, slice_height);
            double nearest = 1e300;
            bool sure = true;
            for (const double s : crossings(ray, ball)) {
                const glm::dvec3 t =
                    field.world_to_texture() * glm::dvec4(ray.origin + s * ray.direction, 1.0);
                sure = sure && place_of(t) != Place::face;
                cut_off += place_of(t) == Place::outside ? 1 : 0;
                nearest = place_of(t) == Place::inside ? std::min(nearest, s) : nearest;
            }
            if (nearest < 1e300 && sure && colour.at(x, y, 3) > 0.0F) {
                ++seen;
                const glm::dvec3 t =
                    field.world_to_texture() * glm::dvec4(ray.origin + nearest * ray.direction, 1.0);
                ASSERT_NEAR(colour.at(x, y, 0), field.value(t), 1e-5) << x << ", " << y;
            }
        }
    }
    EXPECT_GT(seen, 300);
    EXPECT_GT(cut_off, 20);
}

// Rays end at the cut, and the cut is seen through what lies before it.
TEST_F(Slice, rays_of_the_volume_end_at_it) {
    const LiveVolume live(byte_volume(16, 5.0, [](const glm::dvec3& p) { return 100.0 + p.x; }));
    const json camera = camera_at({150, -260, 90});
    json scene = mixed_scene(
        json::array({{{"name", "slice"},
                      {"effect", "volume.slice"},
                      {"parameters",
                       {{"volume", {{"host", "host"}}},
                        {"view", "camera"},
                        {"transfer_function", {{"points", {{{"value", 0}, {"colour", {0, 0, 1}}}}}}},
                        {"plane", {{"axis", "coronal"}, {"position_mm", 5}}}}}}}),
        {{"transfer_function", {{"points", {{{"value", 0}, {"colour", {1, 0, 0}}, {"opacity", 0.02}}}}}}},
        camera, slice_width, slice_height);
    scene["passes"][1]["targets"] = {{"depth", "volume.slice_depth"}, {"background", "volume.slice"}};
    scene["targets"]["volume.slice"] = {{"format", "rgba32f"}};
    const Image image = mixed_shot(stage_, scene, live);
    const View view = stage_.renderer().still(0.0).eye();
    int seen = 0;
    for (int y = 0; y < slice_height; ++y) {
        for (int x = 0; x < slice_width; ++x) {
            const PixelRay ray = pixel_ray(view, x, y, slice_width, slice_height);
            const glm::dvec2 box = box_interval(ray, glm::dvec3(-40.0), glm::dvec3(40.0));
            const double s = (5.0 - ray.origin.y) / ray.direction.y;
            const glm::dvec3 p = glm::abs(ray.origin + s * ray.direction);
            if (s <= box.x || s >= box.y || std::max(p.x, p.z) > 39.9) {
                continue;
            }
            ++seen;
            const double through = std::pow(0.98, s - box.x);
            ASSERT_NEAR(image.at(x, y, 0), 1.0 - through, 1e-5) << x << ", " << y;
            ASSERT_NEAR(image.at(x, y, 2), through, 1e-5) << x << ", " << y;
            ASSERT_NEAR(image.at(x, y, 3), 1.0, 1e-6);
        }
    }
    EXPECT_GT(seen, 200);
}

TEST_F(Slice, degenerate_planes_and_volumes_are_refused_or_harmless) {
    const LiveVolume live(float_volume({1, 1, 1}, glm::dvec3(2.0), [](const glm::dvec3&) { return 3.0; }));
    const Image image = slice(stage_, live, {{"transfer_function", json::object()}});
    EXPECT_TRUE(std::isfinite(image.at(slice_width / 2, slice_height / 2, 0)));
    EXPECT_EQ(image.at(slice_width / 2, slice_height / 2, 3), 1.0F);
    const auto refused = [&](const json& parameters) {
        EXPECT_THROW(stage_.load(slice_scene(parameters)), Error) << parameters;
    };
    refused({{"plane", {{"oblique", {{"normal", {0, 0, 0}}}}}}});
    refused({{"plane", {{"oblique", {{"normal", {0, 1, 0}}, {"up", {0, -2, 0}}}}}}});
    refused({{"mesh", "any.obj"}});
    refused({{"view", "camera"}, {"mesh", "any.obj"}, {"slab", {{"thickness_mm", 1}}}});
    refused({{"slab", {{"step", 0}}}});
}

TEST_F(Slice, a_plane_beside_the_volume_shows_the_background) {
    const LiveVolume live(wavy_volume());
    const Image image =
        slice(stage_, live, {{"plane", {{"position_mm", 500}}}, {"background", {0.5, 0.25, 1, 0.5}}});
    EXPECT_EQ(image.at(5, 5, 0), 0.25F);
    EXPECT_EQ(image.at(5, 5, 3), 0.5F);
}

}  // namespace
}  // namespace viscera::test
