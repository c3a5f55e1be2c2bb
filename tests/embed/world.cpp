#include "tests/embed/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "effects/register_all.h"
#include "engine/io/exr.h"
#include "engine/io/mesh.h"
#include "engine/io/png.h"

namespace viscera::test {
namespace {

/// An open tube along z, radius 5 mm, from -20 to 20 mm.
std::string tube_obj() {
    constexpr int around = 16;
    constexpr int along = 20;
    std::string text;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / around;
            text += "v " + std::to_string(5.0 * std::cos(angle)) + " " +
                    std::to_string(5.0 * std::sin(angle)) + " " + std::to_string(40.0 * j / along - 20.0) +
                    "\n";
        }
    }
    const auto corner = [](int i, int j) { return std::to_string(j * around + i % around + 1) + " "; };
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < around; ++i) {
            text += "f " + corner(i, j) + corner(i + 1, j) + corner(i, j + 1) + "\n";
            text += "f " + corner(i + 1, j) + corner(i + 1, j + 1) + corner(i, j + 1) + "\n";
        }
    }
    return text;
}

Image gradient(int side, float low, float high) {
    Image image = make_image(side, side, PixelFormat::r8);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const float share = static_cast<float>(x + 2 * y) / static_cast<float>(3 * (side - 1));
            image.set(x, y, 0, low + (high - low) * share);
        }
    }
    return image;
}

/// A soft ball of 16^3 bytes, 40 mm wide, as MetaImage.
std::string ball_mha() {
    std::string text =
        "ObjectType = Image\nNDims = 3\nDimSize = 16 16 16\nElementSpacing = 2.5 2.5 2.5\n"
        "Offset = -18.75 -18.75 -18.75\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    for (int z = 0; z < 16; ++z) {
        for (int y = 0; y < 16; ++y) {
            for (int x = 0; x < 16; ++x) {
                const double r = std::hypot(x - 7.5, y - 7.5, z - 7.5);
                text += static_cast<char>(std::clamp(30.0 * (8.0 - r), 0.0, 200.0));
            }
        }
    }
    return text;
}

constexpr const char* head = R"json({
  "version": 1, "resolution": [96, 80], "frames_per_second": 10,
  "camera": {"kind": "orthographic", "eye_mm": [0, -300, 0], "target_mm": [0, 0, 0], "up": [0, 0, 1], "height_mm": 60},
  "shared": {
    "tube": {
      "vessel": {"mesh": "tube.obj", "injection_mm": [0, -5, -20], "geodesic": {"speed_mm_s": 100}},
      "bolus": {"start_s": 0, "duration_s": 1, "rise_s": 0.2},
      "cloud": {"radius_mm": 12}
    },
    "smoke": {
      "emitters": [{"base_mm": [0, -5, -15], "tip_mm": [12, -8, -10], "edge_mm": [12, -8, -7], "size": 1.5}],
      "host_emitters": "host_emitters",
      "views": [{"angle_deg": 30, "image": "smoke_a.png"}, {"angle_deg": 90, "image": "smoke_b.png"}],
      "front": "smoke_b.png"
    },
    "bolus_table": {"start_s": 0, "table": [
      {"time_s": 0, "density": 0}, {"time_s": 0.3, "density": 1}, {"time_s": 2, "density": 0}]}
  },
)json";

}  // namespace

World::World() {
    const auto tube = folder_.write("tube.obj", tube_obj());
    (void)folder_.write("ball.mha", ball_mha());
    io::write_png(folder_ / "background.png", gradient(24, 0.4F, 0.9F));
    io::write_png(folder_ / "smoke_a.png", gradient(16, 0.1F, 0.8F));
    io::write_png(folder_ / "smoke_b.png", gradient(16, 0.9F, 0.2F));
    const io::ExrPart energy{.name = "tissue.energy", .image = make_image(64, 64, PixelFormat::r32f)};
    io::write_exr(folder_ / "energy.exr", std::span(&energy, 1));
    Log log;
    vertices_ = io::merge(io::load_meshes(tube, {}, log)).positions.size();
}

Scene World::parse(const std::string& text) const {
    return parse_scene(text, folder_ / "scene.json");
}

Scene World::small() const {
    return parse(std::string(head) + R"json(
  "passes": [
    {"name": "background", "effect": "picture.image", "parameters": {"file": "background.png"}},
    {"name": "vessels", "effect": "contrast.geometry", "parameters": {"$ref": "#/shared/tube"}},
    {"name": "summarize", "effect": "contrast.summarize"},
    {"name": "composite", "effect": "contrast.composite"}
  ],
  "outputs": ["final"]
})json");
}

Scene World::everything() const {
    return parse(std::string(head) + R"json(
  "passes": [
    {"name": "background", "effect": "picture.image", "parameters": {"file": "background.png"}},
    {"name": "vessels", "effect": "contrast.geometry", "parameters": {"$ref": "#/shared/tube"}},
    {"name": "distance_view", "effect": "contrast.distance_view"},
    {"name": "summarize", "effect": "contrast.summarize"},
    {"name": "mask", "effect": "contrast.silhouette", "parameters": {"mesh": "tube.obj"}},
    {"name": "blurred_mask", "effect": "filter.gaussian", "parameters": {"axis": "x", "sigma": 0.05},
     "targets": {"source": "contrast.mask", "blurred": "mask.blurred"}},
    {"name": "reflux", "effect": "contrast.reflux", "parameters": {"$ref": "#/shared/smoke"}},
    {"name": "extravasate", "effect": "contrast.extravasate", "parameters": {"$ref": "#/shared/smoke"},
     "targets": {"mask_sharp": "contrast.mask", "mask_blurred": "mask.blurred"}},
    {"name": "cloud_alone", "effect": "contrast.cloud", "parameters": {"$ref": "#/shared/tube"},
     "targets": {"cloud": "alone.cloud"}},
    {"name": "distance_alone", "effect": "contrast.distance", "parameters": {"$ref": "#/shared/tube"},
     "targets": {"distance": "alone.distance"}},
    {"name": "by_depth", "effect": "contrast.main",
     "parameters": {"$ref": "#/shared/tube", "bolus": {"$ref": "#/shared/bolus_table"}, "method": "depth"},
     "targets": {"main": "depth.main"}},
    {"name": "by_painter", "effect": "contrast.main",
     "parameters": {"$ref": "#/shared/tube", "method": "painter", "delay_s": 0.1},
     "targets": {"main": "painter.main"}},
    {"name": "of_host", "effect": "contrast.main",
     "parameters": {"vessel": {"mesh": "tube.obj", "density": "per_vertex", "scalar": "host_density"}},
     "targets": {"main": "host.main"}},
    {"name": "blush", "effect": "filter.gaussian", "parameters": {"axis": "y", "sigma": 0.1},
     "targets": {"source": "painter.main", "blurred": "contrast.capillary"}},
    {"name": "surface", "effect": "mesh.surface", "parameters": {"mesh": "tube.obj"}},
    {"name": "bake", "effect": "tissue.bake", "parameters": {"mesh": {"file": "tube.obj"}, "size": 64}},
    {"name": "gravity", "effect": "tissue.gravity", "parameters": {"size": 64}},
    {"name": "spill", "effect": "picture.image", "parameters": {"file": "smoke_a.png", "monochrome": true},
     "targets": {"image": "tissue.blood_spill"}},
    {"name": "blood", "effect": "tissue.blood",
     "parameters": {"mesh": {"file": "tube.obj"}, "size": 64, "wounds": [{"position_mm": [5, 0, 0], "rate_mm3_s": 200},
       {"position_mm": [5, 0, 10], "rate_mm3_s": 300, "kind": "jet", "direction": [1, 0, 0], "speed_mm_s": 200}]}},
    {"name": "account", "effect": "tissue.blood_account"},
    {"name": "coagulate", "effect": "tissue.coagulate",
     "parameters": {"mesh": {"file": "tube.obj"}, "size": 64, "load": {"file": "energy.exr", "time_s": 0},
       "contacts": [{"from_mm": [5, 0, 0], "to_mm": [5, 0, 9], "power": 2}]}},
    {"name": "bipolar", "effect": "tissue.coagulate_bipolar",
     "parameters": {"mesh": {"file": "tube.obj"}, "size": 64, "held": [0, 1, 2, 100], "max_uv_perimeter": 10,
       "tool": {"shape": "sphere", "size_mm": [1, 1, 40]}}},
    {"name": "organ", "effect": "organ.surface",
     "parameters": {"mesh": {"file": "tube.obj"}, "diffuse_map": "smoke_a.png", "focus": {"focus_mm": 300, "far_mm": 340}}},
    {"name": "jet", "effect": "tissue.jet"},
    {"name": "membrane", "effect": "organ.surface",
     "parameters": {"mesh": {"file": "tube.obj", "placement": {"move_mm": [4, -3, 0]}}, "blending": "blended",
       "opacity": 0.4, "into_picture": true, "hematoma": {"spots": [{"centre": [5, -5, 0]}]}}},
    {"name": "depth_of_field", "effect": "organ.depth_of_field", "parameters": {"radius": 0.05},
     "targets": {"picture": "organ.final"}},
    {"name": "slice", "effect": "volume.slice",
     "parameters": {"volume": {"file": "ball.mha"}, "transfer_function": {"window": {"width": 100, "level": 50}}}},
    {"name": "entry", "effect": "volume.entry", "parameters": {"volume": {"file": "ball.mha"}}},
    {"name": "exit", "effect": "volume.exit", "parameters": {"volume": {"file": "ball.mha"}}},
    {"name": "inner_exit", "effect": "volume.inner_exit", "parameters": {"volume": {"file": "ball.mha"}}},
    {"name": "inner_entry", "effect": "volume.inner_entry", "parameters": {"volume": {"file": "ball.mha"}}},
    {"name": "cast", "effect": "volume.ray_cast",
     "parameters": {"volume": {"file": "ball.mha"}, "sampling": {"limits": "two_pass"},
       "transfer_function": {"points": [{"value": 10, "opacity": 0}, {"value": 200, "opacity": 0.05}]}}},
    {"name": "composite", "effect": "contrast.composite"}
  ],
  "targets": {"contrast.capillary": {"scale": 0.5}, "tissue.blood_spill": {"size": [64, 64]}},
  "outputs": ["final", "contrast.distance_view", "contrast.mask", "contrast.reflux", "contrast.extravasate",
              "alone.cloud", "alone.distance", "depth.main", "painter.main", "host.main", "volume.colour",
              "volume.slice", "volume.inner_entry", "volume.inner_exit", "organ.final", "tissue.energy", "tissue.position", "tissue.blood_account"]
})json");
}

HostValues World::values(float density) const {
    HostValues values;
    values.set("host_density", std::vector<float>(vertices_, density));
    values.set("host_emitters",
               std::array{0.0F, -5.0F, 10.0F, -12.0F, -8.0F, 15.0F, -12.0F, -8.0F, 18.0F, 1.2F});
    return values;
}

Registry all_effects() {
    Registry registry;
    register_all(registry);
    return registry;
}

std::map<std::string, Image> pictures(Renderer& renderer) {
    std::map<std::string, Image> images;
    for (const std::string& output : renderer.scene().outputs) {
        images.emplace(output, renderer.read(output));
    }
    return images;
}

std::vector<std::string> differing(const std::map<std::string, Image>& a,
                                   const std::map<std::string, Image>& b) {
    std::vector<std::string> names;
    for (const auto& [name, image] : a) {
        const auto other = b.find(name);
        if (other == b.end() || other->second.width != image.width || other->second.height != image.height ||
            other->second.format != image.format || other->second.data != image.data) {
            names.push_back(name);
        }
    }
    return names;
}

}  // namespace viscera::test
