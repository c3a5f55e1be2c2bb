#include "tests/stress/stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "effects/register_all.h"
#include "engine/gl/handle.h"
#include "engine/io/exr.h"

namespace viscera::test {
namespace {

constexpr int sides = 12;
constexpr int rings = tube_vertices / sides;

ContextOptions debug_options() {
    ContextOptions options;
    options.debug = true;
    return options;
}

}  // namespace

Stage::Stage()
    : context_(create_context(Backend::osmesa, debug_options())),
      functions_(gl::Functions::load(context_->proc_address())) {
    register_all(registry_);
    renderer_.emplace(context_->proc_address(), registry_,
                      RendererOptions{.log = [this](LogLevel level, std::string_view text) {
                          if (level != LogLevel::debug) {
                              messages_.emplace_back(text);
                          }
                          EXPECT_FALSE(text.starts_with("OpenGL:") && level != LogLevel::debug) << text;
                      }});
    write_tube("tube.ply");
    Image smoke = make_image(16, 16, PixelFormat::r16f);
    for (int i = 0; i < 256; ++i) {
        smoke.set(i % 16, i / 16, 0, 0.2F + 0.8F * static_cast<float>(i % 16) / 16.0F);
    }
    const io::ExrPart part{.name = "smoke", .image = smoke};
    io::write_exr(folder_ / "smoke.exr", std::span(&part, 1));
}

Stage::~Stage() {
    renderer_.reset();
    EXPECT_EQ(gl::drain_errors(*functions_), static_cast<GLenum>(GL_NO_ERROR));
}

nlohmann::json Stage::chain() {
    return nlohmann::json::parse(R"({
        "version": 1, "name": "stress", "resolution": [64, 48], "time_s": 1, "frames_per_second": 10,
        "camera": {"eye_mm": [0, -60, 10], "target_mm": [0, 0, 10], "near_mm": 1, "far_mm": 1000},
        "passes": [
            {"name": "vessels", "effect": "contrast.geometry", "parameters": {
                "vessel": {"mesh": "tube.ply", "injection_mm": [0, 0, 0], "geodesic": {"speed_mm_s": 20}},
                "bolus": {"start_s": 0, "duration_s": 2, "rise_s": 0.2, "washout_s": 0.5},
                "cloud": {"radius_mm": 6}}},
            {"name": "summarize", "effect": "contrast.summarize"},
            {"name": "reflux", "effect": "contrast.reflux", "parameters": {
                "emitters": [{"base_mm": [0, 0, 4], "tip_mm": [10, 0, 8], "edge_mm": [10, 0, 10]}],
                "views": [{"image": "smoke.exr"}], "front": "smoke.exr"}},
            {"name": "blush", "effect": "filter.gaussian", "parameters": {"sigma": 0.05},
             "targets": {"source": "contrast.main", "blurred": "contrast.capillary"}},
            {"name": "composite", "effect": "contrast.composite"}
        ],
        "outputs": ["final", "contrast.distance"]})");
}

nlohmann::json Stage::per_vertex_chain() {
    nlohmann::json scene = chain();
    scene["passes"][0]["effect"] = "contrast.main";
    scene["outputs"] = {"final"};  // this pass makes no distance map
    scene["passes"][0]["parameters"] = {
        {"vessel", {{"mesh", "tube.ply"}, {"density", "per_vertex"}, {"scalar", "density"}}}};
    return scene;
}

void Stage::write_tube(const std::string& name, const std::function<float(int)>& density) {
    std::ostringstream text;
    text << "ply\nformat ascii 1.0\nelement vertex " << tube_vertices
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float density\nelement face "
         << 2 * sides * (rings - 1) << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < tube_vertices; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i % sides) / sides;
        text << 2.0 * std::cos(angle) << " " << 2.0 * std::sin(angle) << " " << 2.0 * (i / sides) << " "
             << (density ? density(i) : 0.8F) << "\n";
    }
    for (int ring = 0; ring + 1 < rings; ++ring) {
        for (int side = 0; side < sides; ++side) {
            const int a = ring * sides + side;
            const int b = ring * sides + (side + 1) % sides;
            text << "3 " << a << " " << b << " " << b + sides << "\n3 " << a << " " << b + sides << " "
                 << a + sides << "\n";
        }
    }
    (void)folder_.write(name, text.str());
}

void Stage::load(const nlohmann::json& scene) {
    renderer_->set_scene(parse_scene(scene.dump(), folder_ / "scene.json"));
}

Pictures Stage::render(const Frame& frame) {
    Pictures pictures;
    renderer_->set_dump({DumpRequest::Kind::all, {}}, [&](CapturedFrame&& captured) {
        for (CapturedTarget& target : captured.targets) {
            pictures[target.name] = std::move(target.image);
        }
    });
    renderer_->render(frame);
    renderer_->finish_captures();
    renderer_->set_dump({}, {});
    EXPECT_FALSE(pictures.empty());
    expect_finite(pictures);
    return pictures;
}

void Stage::expect_said_once(const std::string& key, const std::string& words) {
    const auto faults = renderer_->log().faults();
    EXPECT_TRUE(faults.contains(key)) << key << " was not counted; said was:\n" << said();
    const auto count = std::ranges::count_if(
        messages_, [&](const std::string& message) { return message.find(words) != std::string::npos; });
    EXPECT_EQ(count, 1) << words << "; said was:\n" << said();
}

std::string Stage::said() const {
    std::string all;
    for (const std::string& message : messages_) {
        all += message + "\n";
    }
    return all;
}

void expect_finite(const Pictures& pictures) {
    for (const auto& [name, image] : pictures) {
        for (const float value : to_floats(image)) {
            ASSERT_TRUE(std::isfinite(value)) << name << " holds " << value;
        }
    }
}

void expect_same(const Image& a, const Image& b, const std::string& what) {
    ASSERT_EQ(a.width, b.width) << what;
    ASSERT_EQ(a.height, b.height) << what;
    EXPECT_TRUE(a.format == b.format && a.data == b.data) << what;
}

float largest(const Image& image) {
    return std::ranges::max(to_floats(image));
}

}  // namespace viscera::test
