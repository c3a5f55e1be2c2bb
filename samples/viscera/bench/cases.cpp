#include "samples/viscera/bench/cases.h"

#include <array>

namespace viscera::app {

std::span<const Case> all_cases() {
    static constexpr std::array<Case, 29> cases{{
        {"ceilings", "copy and clear per format, fetches, exp, vertices, triangles", run_ceilings},
        {"readback", "read-back per format, waiting and not waiting", run_read_back},
        {"geometry", "one pass over the vessels against three", run_geometry},
        {"overlap", "densest fragment by max, depth and painter; vessels that add up", run_overlap},
        {"summarize", "against a copy of the same bytes", run_summarize},
        {"composite", "by layers and tone, against a copy of the same bytes", run_composite},
        {"gaussian", "by sigma, against as many plain fetches", run_gaussian},
        {"sprites", "cost by a sprite's own area", run_sprites},
        {"chain", "the default scene pass by pass", run_chain},
        {"cached", "a frame in which nothing changes", run_cached},
        {"region", "vessels that cover part of the picture", run_region},
        {"cpu", "time on the calling thread", run_cpu},
        {"precision", "half targets against float targets", run_precision},
        {"opacity", "the opacity curve in closed form against its 25 terms", run_opacity},
        {"density", "arrival time against densities uploaded each frame", run_density},
        {"resolution", "the default scene by size", run_resolution},
        {"volume", "ray functions against as many plain trilinear samples", run_volume},
        {"steps", "composition by scheme and step", run_steps},
        {"skipping", "empty bricks left out, by how many are occupied", run_skipping},
        {"quality", "the ray caster's knobs, one at a time", run_quality},
        {"filters", "time per sample of a volume by filter, beside its error", run_filters},
        {"organ", "the organ by feature, against the textured organ", run_organ},
        {"curvilinear", "cylindrical and spherical volumes against a box of as many voxels", run_curvilinear},
        {"tissue_blood", "a step of blood against copies of a picture of its size", run_blood},
        {"tissue_bake", "a surface whose vertices move, as textures, against copies of the same bytes",
         run_tissue_bake},
        {"tissue_energy", "coagulation by the part of the texture that contacts reach", run_tissue_energy},
        {"mixed", "the volume at a fraction of the resolution, beside its error", run_mixed},
        {"eyes", "two eyes in one frame against two frames", run_eyes},
        {"fovea", "longer steps away from where one looks, beside their error", run_fovea},
    }};
    return cases;
}

}  // namespace viscera::app
