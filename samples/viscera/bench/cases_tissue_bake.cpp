#include <cmath>
#include <vector>

#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

constexpr const char* positions_name = "bench.positions";

}  // namespace

/// A surface whose vertices move with each frame, as textures of the lab's size. The ceiling: copies of what
/// all four outputs take, whose texels alone are written.
void run_tissue_bake(Lab& lab) {
    SceneText scene(lab.empty_scene());
    const std::string file = (lab.options().assets / "meshes" / "organ.glb").string();
    const nlohmann::json parameters = {{"mesh", {{"file", file}, {"host_positions", positions_name}}},
                                       {"size", lab.options().width}};
    scene.pass("all", "tissue.bake", parameters);
    scene.pass("positions", "tissue.bake", parameters,
               {{"position", "alone.position"},
                {"normal", "alone.normal"},
                {"metric", "alone.metric"},
                {"seam", "alone.seam"}});
    for (const char* output : {"position", "normal", "metric", "seam"}) {
        scene.output(std::string("tissue.") + output);
    }
    scene.output("alone.position");
    scene.target("in", "rgba32f")
        .target("out.a", "rgba32f")
        .target("out.b", "rgba32f")
        .target("out.c", "rgba32f");
    scene.pass("source", "bench.source", {}, {{"out", "in"}});
    for (const std::string copy : {"a", "b", "c"}) {
        scene.pass("copy." + copy, "bench.copy1", {}, {{"a", "in"}, {"out", "out." + copy}})
            .output("out." + copy);
    }
    Stage stage(lab, scene.json());

    Log log(lab.options().log);
    const MeshData mesh = io::merge(io::load_meshes(file, {}, log));
    std::vector<float> xyz(3 * mesh.positions.size());
    HostValues values;
    stage.run([&](Frame& frame) {
        const auto breath = static_cast<float>(std::sin(frame.time_s));
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            for (int c = 0; c < 3; ++c) {
                xyz[3 * v + static_cast<std::size_t>(c)] = mesh.positions[v][c] * (1.0F + 0.01F * breath);
            }
        }
        values.set(positions_name, xyz);
        frame.values = &values;
    });
    const Samples copies = stage.pass("copy.a") + stage.pass("copy.b") + stage.pass("copy.c");
    lab.add({.group = "tissue_bake",
             .name = "moved vertices, all four outputs",
             .samples = stage.pass("all"),
             .ceiling = "three copies rgba32f",
             .base = copies});
    lab.add({.group = "tissue_bake",
             .name = "moved vertices, positions alone",
             .samples = stage.pass("positions"),
             .error = largest_difference(stage.read("alone.position"), stage.read("tissue.position")),
             .error_of = "all four outputs",
             .ceiling = "copy rgba32f",
             .base = stage.pass("copy.a")});
}

}  // namespace viscera::app
