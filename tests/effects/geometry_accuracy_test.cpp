#include <cmath>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/effects/vessel_picture.h"

// The pictures of the vessel surface against the double-precision reference, in targets of full and of half
// floats. Left out are only pixels of the outline that the vessel covers in one of the two and not in the
// other; they are counted, and there must be few.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int geometry_side = 128;
constexpr double place_known = geometry_side / 8388608.0;  // [pixels]: 2^-23 of the side
constexpr std::size_t most_edge_on = 8;                    // measured are up to 5
constexpr std::size_t most_left_out = 2;                   // of 16,384 pixels: measured are none

class GeometryAccuracy : public testing::TestWithParam<bool> {
  protected:
    [[nodiscard]] static bool floats() { return GetParam(); }
    [[nodiscard]] static json scene(const json& parameters, const json& camera = tube_camera()) {
        json passes = json::array({pass("vessels", "contrast.geometry", parameters)});
        if (parameters.contains("method")) {  // draws one target alone
            passes.push_back(passes[0]);
            passes[1]["name"] = "alone";
            passes[1]["effect"] = "contrast.main";
            passes[0]["parameters"].erase("method");
        }
        json made = scene_of(camera, passes, {"contrast.main", "contrast.cloud", "contrast.distance"},
                             geometry_side, geometry_side);
        if (floats()) {
            use_floats(made, {"contrast.main", "contrast.cloud", "contrast.distance"});
        }
        return made;
    }

    void load(const json& parameters, const json& camera = tube_camera()) {
        stage_.load(scene(parameters, camera));
        const Frame frame = stage_.renderer().still(0.0);
        picture_ = std::make_unique<VesselPicture>(parameters, frame.eye(), geometry_side, geometry_side);
        const contrast::BolusParams& bolus = picture_->parameters().bolus;
        // Some time in the injection, when the distance map is drawn: the outline is the same at all times.
        coverage_ = stage_.shot("contrast.distance", bolus.start_s + 0.5);
    }

    using Draw = std::function<reference::Buffer()>;

    /// Floats hold a place in clip space to 2^-24 of its distance from the middle, so no shader of floats
    /// knows better than to `place_known` where it samples a surface. On triangles seen almost edge-on, and
    /// only there, that shows: there the target must lie between what the reference has around the sample,
    /// give or take the bound. How many pixels need that is counted, and bounded.
    void expect(const std::string& name, std::string_view target, const Draw& draw, int channel = 0,
                std::size_t least_content = 300) {
        const Image image = stage_.renderer().read(target);
        const IsCompared agreed = picture_->agreed(coverage_);
        const reference::Buffer wanted = draw();
        reference::Buffer low = wanted;
        reference::Buffer high = wanted;
        for (const glm::dvec2 corner : {glm::dvec2(-1, -1), {1, -1}, {-1, 1}, {1, 1}}) {
            picture_->shift(place_known * corner);
            const reference::Buffer shifted = draw();
            std::ranges::transform(low.data, shifted.data, low.data.begin(),
                                   [](double a, double b) { return std::min(a, b); });
            std::ranges::transform(high.data, shifted.data, high.data.begin(),
                                   [](double a, double b) { return std::max(a, b); });
        }
        picture_->shift(glm::dvec2(0.0));
        reference::Buffer nearest = wanted;
        std::size_t steep = 0;
        for (int y = 0; y < geometry_side; ++y) {
            for (int x = 0; x < geometry_side; ++x) {
                const auto got = static_cast<double>(image.at(x, y, channel));
                const double want = wanted.at(x, y, channel);
                if (floats() && std::abs(got - want) > float_bound && agreed(x, y)) {
                    ++steep;
                    nearest.at(x, y, channel) =
                        std::clamp(got, low.at(x, y, channel), high.at(x, y, channel));
                }
            }
        }
        const Deviation plain = deviation(image, wanted, channel, channel, agreed);
        if (steep > 0) {
            std::printf("  %zu pixels edge-on, by up to %g\n", steep, plain.max);
        }
        EXPECT_LE(steep, most_steep_) << name;
        EXPECT_LE(plain.left_out, most_left_out) << name;
        expect_accurate(name, image.format, deviation(image, nearest, channel, channel, agreed),
                        least_content);
    }

    void expect_main(const std::string& name, double time_s, std::size_t least_content = 300) {
        const contrast::GeometryParams& p = picture_->parameters();
        const double since_start_s = time_s - p.delay_s - p.bolus.start_s;
        stage_.render(time_s);
        expect(
            name + ", t " + std::to_string(time_s), "contrast.main",
            [&] {
                const auto density = [&](double tau) { return bolus_density(p.bolus, since_start_s - tau); };
                return p.method == contrast::OverlapMethod::thickness ? picture_->thickness(density, p.tone)
                                                                      : picture_->main(density, p.tone);
            },
            0, least_content);
        for (const std::string& complaint : stage_.complaints()) {
            EXPECT_TRUE(catheter_ && complaint.find("no contrast") != std::string::npos) << complaint;
        }
    }

    Stage stage_;
    std::unique_ptr<VesselPicture> picture_;
    Image coverage_;
    std::size_t most_steep_ = most_edge_on;
    bool catheter_ = false;  ///< contrast enters at its mouth and does not reach the rest of it
};

TEST_P(GeometryAccuracy, MainByCentreline) {
    load(tube_parameters());
    for (const double time_s : {0.35, 0.6, 1.9, 2.6}) {
        expect_main("main, centreline", time_s);
    }
}

TEST_P(GeometryAccuracy, MainByCalibre) {
    json parameters = tube_parameters();
    parameters["vessel"]["full_calibre_mm"] = 5.5;
    load(parameters);
    expect_main("main, weighted by calibre", 0.6);
}

TEST_P(GeometryAccuracy, MainByThickness) {
    json parameters = tube_parameters();
    parameters["vessel"]["full_calibre_mm"] = 9;
    parameters["method"] = "thickness";
    // The way through a vessel falls to 0 along its whole outline, more steeply the nearer it comes: there
    // are more such pixels. Measured are up to 16.
    most_steep_ = 3 * most_edge_on;
    load(parameters);
    expect_main("main, thickness", 0.6);
    load(parameters, {{"kind", "orthographic"}, {"eye_mm", {40, -300, 260}}, {"height_mm", 110}});
    expect_main("main, thickness, parallel rays", 1.2);
}

TEST_P(GeometryAccuracy, MainByGeodesic) {
    json parameters = tube_parameters();
    parameters["vessel"].erase("centreline");
    parameters["vessel"]["geodesic"] = {{"speed_mm_s", 200}};
    parameters["tone"] = 0.8;
    parameters["delay_s"] = 0.1;
    load(parameters);
    for (const double time_s : {0.55, 2.2}) {
        expect_main("main, geodesic", time_s);
    }
}

TEST_P(GeometryAccuracy, MainOnTheCoronaries) {
    json parameters = tube_parameters();
    parameters["vessel"] = {{"mesh", "../meshes/coronary.glb"},
                            {"centreline", "../vessels/coronary.centreline.json"},
                            {"injection_mm", {-12.94, -3.16, 42.0}},
                            {"flow", {{"injection_speed_mm_s", 260}}}};
    parameters["cloud"]["radius_mm"] = 30;
    catheter_ = true;
    load(parameters, coronary_camera());
    expect_main("main, coronaries", 0.6);
    expect(
        "cloud, coronaries", "contrast.cloud", [&] { return picture_->cloud(0.9); }, 1, 200);
    expect("distance, coronaries", "contrast.distance", [&] { return picture_->distance(); });
}

TEST_P(GeometryAccuracy, MainByTable) {
    json parameters = tube_parameters();
    // Corners fall on samples of the table's 1024, so that straight lines between the points are the truth.
    parameters["bolus"] = {{"start_s", 0.2},
                           {"table", json::array({{{"time_s", 0.0}, {"density", 0.05}},
                                                  {{"time_s", 0.4}, {"density", 0.9}},
                                                  {{"time_s", 1.2}, {"density", 0.3}},
                                                  {{"time_s", 2.046}, {"density", 0.0}}})}};
    load(parameters);
    for (const double time_s : {0.5, 1.1, 2.3}) {
        expect_main("main, table", time_s);
    }
}

TEST_P(GeometryAccuracy, MainPerVertex) {
    json parameters = tube_parameters();
    parameters["vessel"] = {{"mesh", "../meshes/tube.glb"}, {"density", "per_vertex"}};
    load(parameters);
    stage_.render(0.5);
    expect("main, the mesh's own density", "contrast.main",
           [&] { return picture_->main([](double density) { return density; }); });

    // The host's: anything goes, and what is no density is mended.
    std::vector<float> densities(picture_->vessel().scalar.size());
    for (std::size_t i = 0; i < densities.size(); ++i) {
        const glm::vec3& p = picture_->vessel().mesh.positions[i];
        densities[i] = 0.5F + 0.7F * std::sin(0.2F * p.x + 0.11F * p.z);
    }
    HostValues values;
    values.set("DENSITY", densities);
    stage_.render(0.5, &values);
    std::vector<float> mended = densities;
    for (float& density : mended) {
        density = std::clamp(density, 0.0F, 1.0F);
    }
    expect("main, densities of the host", "contrast.main", [&] { return picture_->main_of(mended); });
}

TEST_P(GeometryAccuracy, CloudAndDistance) {
    load(tube_parameters());
    const double time_s = 0.35;  // while the injection still rises
    const contrast::GeometryParams& p = picture_->parameters();
    stage_.render(time_s);
    const double brightness = p.cloud.brightness * bolus_density(p.bolus, time_s - p.bolus.start_s);
    const Draw cloud = [&] { return picture_->cloud(brightness); };
    expect("cloud, brightness", "contrast.cloud", cloud, 0);
    expect("cloud, weight", "contrast.cloud", cloud, 1);
    expect("distance", "contrast.distance", [&] { return picture_->distance(); });
}

TEST_P(GeometryAccuracy, Silhouette) {
    load(tube_parameters());
    json scene = scene_of(
        tube_camera(), json::array({pass("mask", "contrast.silhouette", {{"mesh", "../meshes/tube.glb"}})}),
        {"contrast.mask"}, geometry_side, geometry_side);
    if (floats()) {
        use_floats(scene, {"contrast.mask"});
    }
    stage_.renderer().keep({});
    stage_.load(scene);
    stage_.render(0.0);
    const reference::Buffer map = picture_->distance();
    expect("silhouette", "contrast.mask", [&] {
        reference::Buffer mask(geometry_side, geometry_side);
        std::ranges::transform(map.data, mask.data.begin(), [](double q) { return q < 0.0 ? 0.0 : 1.0; });
        return mask;
    });
}

INSTANTIATE_TEST_SUITE_P(Targets, GeometryAccuracy, testing::Values(true, false),
                         [](const auto& info) { return info.param ? "float32" : "half"; });

}  // namespace
}  // namespace viscera::test
