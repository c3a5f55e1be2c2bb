#include <cmath>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

/// Contacts at vertices spread over the mesh, each moving by 5 mm in a second.
nlohmann::json contacts(const MeshData& mesh, std::size_t count, double sigma_mm) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3& p = mesh.positions[(2 * i + 1) * mesh.positions.size() / (2 * count)];
        list.push_back({{"from_mm", {p.x, p.y, p.z}},
                        {"to_mm", {p.x + 300.0F, p.y, p.z}},
                        {"end_s", 60.0},
                        {"power", 0.5},
                        {"sigma_mm", sigma_mm}});
    }
    return list;
}

}  // namespace

/// A step of the energy at the lab's size: contacts that reach a part of the texture, against the same
/// contacts with the whole texture drawn, and against a plain copy. Blood and energy together may take 4
/// copies.
void run_tissue_energy(Lab& lab) {
    const std::string file = (lab.options().assets / "meshes" / "organ.glb").string();
    Log log(lab.options().log);
    const MeshData mesh = io::merge(io::load_meshes(file, {}, log));
    struct Variant {
        std::string name;
        std::size_t count;
        double sigma_mm;
    };
    const std::vector<Variant> variants{{"1 contact of 1 mm", 1, 1.0},
                                        {"1 contact of 4 mm", 1, 4.0},
                                        {"8 contacts of 2 mm", 8, 2.0},
                                        {"1000 contacts of 1 mm", 1000, 1.0}};

    SceneText scene(lab.empty_scene());
    const nlohmann::json surface = {{"file", file}};
    scene.pass("bake", "tissue.bake", {{"mesh", surface}, {"size", lab.options().width}});
    const auto energy = [&](const std::string& name, nlohmann::json parameters) {
        parameters["size"] = lab.options().width;
        scene.pass(name, "tissue.coagulate", std::move(parameters), {{"energy", name}, {"last", name}})
            .output(name);
    };
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const nlohmann::json list = contacts(mesh, variants[i].count, variants[i].sigma_mm);
        energy("part." + std::to_string(i), {{"mesh", surface}, {"contacts", list}});
        if (variants[i].count < 1000) {
            energy("whole." + std::to_string(i), {{"contacts", list}});
        }
    }
    scene.target("in", "r32f").target("out.copy", "r32f");
    scene.pass("source", "bench.source", {}, {{"out", "in"}});
    scene.pass("copy", "bench.copy1", {}, {{"a", "in"}, {"out", "out.copy"}}).output("out.copy");
    Stage stage(lab, scene.json());
    stage.run();
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const std::string part = "part." + std::to_string(i);
        const std::string whole = "whole." + std::to_string(i);
        lab.add({.group = "tissue_energy",
                 .name = variants[i].name,
                 .samples = stage.pass(part),
                 .ceiling = "copy r32f",
                 .base = stage.pass("copy"),
                 .goal = variants[i].count < 1000 ? std::optional(2.0) : std::nullopt});
        if (variants[i].count < 1000) {
            lab.add({.group = "tissue_energy",
                     .name = variants[i].name + ", by part",
                     .samples = stage.pass(part),
                     .error = largest_difference(stage.read(part), stage.read(whole)),
                     .error_of = "the whole texture drawn",
                     .ceiling = "the whole texture drawn",
                     .base = stage.pass(whole)});
        }
    }
}

}  // namespace viscera::app
