#include "assets/generate/generate.h"

#include <stdexcept>
#include <string>

#include "assets/generate/coronary.h"
#include "assets/generate/smoke.h"
#include "assets/generate/thorax.h"
#include "assets/generate/tube.h"
#include "assets/generate/vessel_mesh.h"
#include "assets/generate/volume_angiogram.h"
#include "assets/generate/volume_artery.h"
#include "assets/generate/volume_cryosections.h"
#include "assets/generate/volume_fetus.h"
#include "assets/generate/volume_files.h"
#include "assets/generate/volume_head.h"
#include "assets/generate/write_file.h"
#include "assets/generate/write_glb.h"

namespace viscera::assets {
namespace {

/// Now and then a grid lies so that two sheets of the wall touch: a slightly finer one does not.
MeshData sound_mesh(const VesselTree& tree, double spacing_mm, const std::string& name) {
    for (int attempt = 0; attempt < 5; ++attempt) {
        MeshData mesh = mesh_vessels(tree, spacing_mm);
        if (check_surface(mesh).sound()) {
            mesh.name = name;
            return mesh;
        }
        spacing_mm *= 0.96;
    }
    throw std::runtime_error(name + ": the wall cannot be meshed as one closed surface");
}

}  // namespace

void generate_vessels(const std::filesystem::path& folder, std::uint64_t seed) {
    const Coronary coronary = grow_coronary(seed);
    write_centreline(coronary.tree.graph, folder / "vessels" / "coronary.centreline.json");
    write_landmarks(coronary.landmarks, folder / "vessels" / "coronary.landmarks.json");
    write_glb(sound_mesh(coronary.tree, 0.42, "coronary"), folder / "meshes" / "coronary.glb");

    const VesselTree tube = make_tube();
    MeshData mesh = sound_mesh(tube, 1.3, "tube");
    mesh.scalars.push_back(tube_density(tube, mesh));
    write_centreline(tube.graph, folder / "vessels" / "tube.centreline.json");
    write_glb(mesh, folder / "meshes" / "tube.glb");
}

void generate_sprites(const std::filesystem::path& folder, std::uint64_t seed) {
    constexpr int size = 256;
    const Smoke smoke(static_cast<std::uint32_t>(seed));
    for (const SmokeView& view : smoke_views) {
        write_exr(smoke.project(view, size), folder / "sprites" / (std::string(view.name) + ".exr"));
    }
}

void generate_images(const std::filesystem::path& folder, std::uint64_t seed) {
    write_exr(make_thorax(ConeBeam(0.0, 0.0), seed), folder / "images" / "thorax.exr");
    write_exr(make_thorax(ConeBeam(-30.0, -20.0), seed), folder / "images" / "thorax_rao_caudal.exr");
}

void generate_volumes(const std::filesystem::path& folder, std::uint64_t seed, int coarser) {
    const HeadVolumes head = make_head(seed, coarser);
    write_volume(head.ct, folder / "volumes" / "head.mha");
    write_volume(head.labels, folder / "volumes" / "head_labels.nrrd");
    write_volume(head.perfusion, folder / "volumes" / "overlay.nrrd");
    write_volume(make_cryosections(head), folder / "volumes" / "cryosections.nrrd");
    write_volume(make_angiogram(seed, coarser), folder / "volumes" / "angiogram.mha");
    write_volume(make_artery(seed, coarser), folder / "volumes" / "artery.nrrd");
    write_volume(make_fetus(seed, coarser), folder / "volumes" / "fetus.nrrd");
}

void generate_all(const std::filesystem::path& folder, std::uint64_t seed, int coarser) {
    generate_vessels(folder, seed);
    generate_sprites(folder, seed);
    generate_images(folder, seed);
    generate_organs(folder, seed, coarser);
    generate_volumes(folder, seed, coarser);
}

}  // namespace viscera::assets
