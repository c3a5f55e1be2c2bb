#include <gtest/gtest.h>

#include "engine/runtime/assets.h"
#include "tests/effects/deviation.h"
#include "tests/effects/noise_pictures.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/reference/contrast.h"

// Smoke against the double-precision reference: sprites at any angle, with and without front view and masks,
// on targets that are not square.
namespace viscera::test {
namespace {

using nlohmann::json;
using reference::Buffer;

json emitter(const glm::dvec3& base, const glm::dvec3& tip, double size = 1.2) {
    const glm::dvec3 edge = tip + glm::dvec3(2.0, 1.0, 1.5);
    return {{"base_mm", {base.x, base.y, base.z}},
            {"tip_mm", {tip.x, tip.y, tip.z}},
            {"edge_mm", {edge.x, edge.y, edge.z}},
            {"size", size},
            {"strength", size > 1.55 ? 0.6 : 1.0}};
}

/// From the side, slanted and almost towards the source, some of them over one another or cut off by the
/// border of the picture.
json many_emitters() {
    return {emitter({0, 0, -20}, {18, 3, -12}),        emitter({2, 1, -16}, {-15, 8, 4}, 1.6),
            emitter({10, 0, 14}, {12, 16, 18}),        emitter({-10, 0, 10}, {-18, -28, 17}, 1.5),
            emitter({-30, 0, 20}, {-60, 10, 30}, 2.0), emitter({4, 2, 0}, {5, 3, 9})};
}

class SpriteAccuracy : public testing::TestWithParam<bool> {
  protected:
    struct Picture {
        int width = 160;
        int height = 96;
        bool front = true;
        bool masks = true;
        std::vector<double> angles{22.5, 45.0, 67.5, 90.0};
        json emitters = many_emitters();
        json camera = tube_camera();
    };

    static std::string file_of(double angle_deg) {
        const std::string name = angle_deg == 90.0 ? "side" : std::to_string(static_cast<int>(angle_deg));
        return "../sprites/smoke_" + name + ".exr";
    }
    static Buffer load(const std::string& file) {
        Log log;
        Assets assets(log);
        return to_buffer(
            *assets.image(std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes" / file));
    }

    void check(const std::string& name, const Picture& p, std::size_t least_content = 500) {
        json views = json::array();
        for (const double angle : p.angles) {
            views.push_back({{"angle_deg", angle}, {"image", file_of(angle)}});
        }
        json parameters{{"emitters", p.emitters}, {"views", views}};
        if (p.front) {
            parameters["front"] = "../sprites/smoke_front.exr";
        }
        json targets = json::object();
        json passes{NoisePictures::fill("contrast.summary", pictures_.waves(p.width, p.height, 0.1F))};
        std::vector<std::string> kept{"contrast.reflux", "contrast.summary"};
        if (p.masks) {
            passes.push_back(NoisePictures::fill("mask.sharp", pictures_.waves(p.width, p.height, 0.25F)));
            passes.push_back(NoisePictures::fill("mask.blurred", pictures_.waves(p.width, p.height, 0.06F)));
            targets = {{"mask_sharp", "mask.sharp"}, {"mask_blurred", "mask.blurred"}};
            kept.insert(kept.end(), {"mask.sharp", "mask.blurred"});
        }
        passes.push_back(pass("reflux", "contrast.reflux", parameters, targets));
        json scene = scene_of(p.camera, passes, {"contrast.reflux"}, p.width, p.height);
        if (p.masks) {
            // Of another size than the target: it is filtered.
            scene["targets"]["mask.blurred"] = {{"scale", 0.5}};
        }
        if (GetParam()) {
            use_floats(scene, {"contrast.reflux", "contrast.summary"});
        }
        stage_.load(scene);
        stage_.renderer().keep(kept);
        stage_.render(0.0);
        EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front();

        reference::Sprites pictures;
        for (const double angle : p.angles) {
            pictures.views.push_back({angle, load(file_of(angle))});
        }
        if (p.front) {
            pictures.front = load("../sprites/smoke_front.exr");
        }
        if (p.masks) {
            pictures.mask_sharp = to_buffer(stage_.renderer().read("mask.sharp"));
            pictures.mask_blurred = to_buffer(stage_.renderer().read("mask.blurred"));
        }
        std::vector<reference::Emitter> emitters;
        const auto point = [](const json& list) {
            return glm::dvec3(list[0].get<double>(), list[1].get<double>(), list[2].get<double>());
        };
        for (const json& e : p.emitters) {
            emitters.push_back(
                {point(e["base_mm"]), point(e["tip_mm"]), point(e["edge_mm"]), e["size"], e["strength"]});
        }
        const View view = stage_.renderer().still(0.0).eye();
        const Buffer wanted = reference::sprites(
            emitters, pictures, {view.view_projection(), view.eye_mm, view.forward, view.orthographic},
            to_buffer(stage_.renderer().read("contrast.summary")));
        const Image image = stage_.renderer().read("contrast.reflux");
        expect_accurate(name, image.format, deviation(image, wanted), least_content);
    }

    NoisePictures pictures_;
    Stage stage_;
};

TEST_P(SpriteAccuracy, ManyWithAllTheirPictures) {
    check("sprites, wide target", {});
    check("sprites, high target", {.width = 96, .height = 160});
}

TEST_P(SpriteAccuracy, OneViewAlone) {
    check("sprites, one view", {.front = false, .masks = false, .angles = {90.0}});
}

TEST_P(SpriteAccuracy, TwoViewsWithoutMasks) {
    check("sprites, two views and front", {.masks = false, .angles = {45.0, 90.0}});
}

TEST_P(SpriteAccuracy, MasksWithoutFront) {
    check("sprites, masks, no front", {.front = false});
}

TEST_P(SpriteAccuracy, OrthographicCamera) {
    check("sprites, orthographic",
          {.camera = {{"kind", "orthographic"}, {"eye_mm", {40, -500, 20}}, {"height_mm", 80}}});
}

/// No side of it is left, but all of its front, as where it is turned away by a hair.
TEST_P(SpriteAccuracy, SeenExactlyFromTheFront) {
    const json camera{{"kind", "orthographic"}, {"eye_mm", {0, -500, 0}}, {"height_mm", 50}};
    const json exactly{emitter({3, 4, 5}, {3, -10, 5})};
    check("sprites, front", {.emitters = exactly, .camera = camera});
    check("sprites, front, no masks", {.masks = false, .emitters = exactly, .camera = camera});
    check("sprites, a hair beside it", {.emitters = {emitter({3, 4, 5}, {3.01, -10, 5})}, .camera = camera});
}

/// More than are drawn at once.
TEST_P(SpriteAccuracy, ManyEmitters) {
    json emitters = json::array();
    for (int i = 0; i < 37; ++i) {
        const glm::dvec3 base(-24.0 + 1.3 * i, 0.2 * i, -30.0 + 1.5 * i);
        emitters.push_back(emitter(base, base + glm::dvec3(6.0 * std::sin(i), 5.0 * std::cos(2.0 * i), 4.0)));
    }
    check("sprites, 37 emitters", {.emitters = emitters});
}

INSTANTIATE_TEST_SUITE_P(Targets, SpriteAccuracy, testing::Values(true, false),
                         [](const auto& info) { return info.param ? "float32" : "half"; });

}  // namespace
}  // namespace viscera::test
