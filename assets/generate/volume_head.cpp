#include "assets/generate/volume_head.h"

#include "assets/generate/noise.h"
#include "assets/generate/volume_canvas.h"
#include "assets/generate/volume_head_bones.h"
#include "assets/generate/volume_head_brain.h"
#include "assets/generate/volume_head_skin.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

// Hounsfield units.
constexpr float air = -1000.0F;
constexpr float fat = -95.0F;
constexpr float skin = 25.0F;
constexpr float muscle = 55.0F;
constexpr float fluid = 6.0F;
constexpr float gray_matter = 39.0F;
constexpr float white_matter = 27.0F;
constexpr float dura = 62.0F;
constexpr float clot = 68.0F;
constexpr float swelling = 17.0F;
constexpr float compact_bone = 1250.0F;

constexpr float noise_sigma = 6.0F;
constexpr double point_spread_mm = 0.7;  // of a scanner; sharper edges show the grid as rings
constexpr PaintedBox braincase_box{{-72.0F, -80.0F, -48.0F}, {72.0F, 98.0F, 100.0F}};
constexpr PaintedBox face_box{{-80.0F, -112.0F, -70.0F}, {80.0F, 50.0F, 40.0F}};
constexpr PaintedBox jaw_box{{-64.0F, -94.0F, -116.0F}, {64.0F, 20.0F, -14.0F}};

float noise_at(const glm::vec3& p, double feature_mm, std::uint32_t seed) {
    return static_cast<float>(gradient_noise(glm::dvec3(p) / feature_mm, seed));
}

VolumeGrid grid_of(const glm::ivec3& dims) {
    const glm::dvec3 box(192.0, 224.0, 240.0);
    VolumeGrid grid;
    grid.dims = dims;
    grid.spacing_mm = box / glm::dvec3(dims);
    grid.origin_mm = 0.5 * (grid.spacing_mm - box) + glm::dvec3(0.0, 0.0, -3.0);
    return grid;
}

/// Compact bone around spongy bone.
float bone(const glm::vec3& p, float distance, std::uint32_t seed) {
    const float spongy = 380.0F + 220.0F * noise_at(p, 3.5, seed);
    return spongy + (compact_bone - 150.0F - spongy) * step_between(-3.4F, -1.6F, distance);
}

void paint_soft_tissue(Canvas& canvas, std::uint32_t seed) {
    canvas.paint({}, soft_tissue, skin_distance, [seed](const glm::vec3& p, float d) {
        if (d > -1.8F) {
            return skin;
        }
        const float face = step_between(10.0F, -40.0F, p.z);
        const float layer = 4.0F + 3.0F * face + 2.5F * noise_at(p, 28.0, seed);
        const float deep = step_between(layer, layer + 1.5F, -d - 1.8F);
        const float between = step_between(0.08F, 0.03F, std::abs(noise_at(p, 21.0, seed + 1U)));
        const float below = muscle + (0.7F * fat - muscle) * face * between;
        return fat + (below - fat) * deep;
    });
}

void paint_skull(Canvas& canvas, std::uint32_t seed) {
    const auto vault = [](const glm::vec3& p) {
        const float shell = braincase_distance(p) - vault_thickness(p);
        return p.z < 10.0F ? join(shell, skull_base_distance(p), 8.0F) : shell;
    };
    canvas.paint(braincase_box, skull, vault, [seed](const glm::vec3& p, float) {
        const float c = braincase_distance(p);
        const float depth = vault_thickness(p) - c;
        // Diploe between the tables, where there is room.
        const float inner = step_between(0.9F, 2.0F, c);
        const float outer = step_between(1.1F, 2.3F, depth);
        const float diploe = 520.0F + 260.0F * noise_at(p, 3.0, seed + 2U);
        const float solid = compact_bone + (diploe - compact_bone) * inner * outer;
        const float seam = step_between(1.1F, 0.3F, suture_distance(p, seed));
        return solid + (240.0F - solid) * seam * step_between(4.2F, 3.0F, depth);
    });
    canvas.paint(face_box, skull, face_bone_distance,
                 [seed](const glm::vec3& p, float d) { return bone(p, d, seed + 3U); });
}

void paint_airways(Canvas& canvas) {
    canvas.paint(face_box, soft_tissue, nasal_hollow_distance, muscle);
    canvas.paint(face_box, no_label, sinus_distance, air);
    canvas.paint({{-30.0F, -112.0F, -130.0F}, {30.0F, 10.0F, -5.0F}}, no_label, airway_distance, air);
}

void paint_orbits(Canvas& canvas) {
    const PaintedBox box{{-58.0F, -92.0F, -24.0F}, {58.0F, -20.0F, 22.0F}};
    // Fat fills the orbit up to the lids.
    canvas.paint(
        box, soft_tissue,
        [](const glm::vec3& p) {
            return std::max({orbit_distance(p), skin_distance(p) + 3.0F, -p.y - 79.0F});
        },
        fat);
    const auto strands = [](const glm::vec3& p) {
        const glm::vec3 q = folded(p);
        const glm::vec3 apex(15.5F, -30.0F, 0.0F);
        return std::min({rod(q, apex, {21.0F, -62.0F, -2.0F}, 1.2F, 2.0F),
                         rod(q, apex, {43.0F, -62.0F, -2.0F}, 1.2F, 2.0F),
                         rod(q, apex, {32.0F, -62.0F, 9.5F}, 1.2F, 2.0F),
                         rod(q, apex, {32.0F, -62.0F, -13.5F}, 1.2F, 2.0F),
                         rod(q, apex, {31.0F, -54.0F, -2.0F}, 2.0F, 2.3F)});
    };
    canvas.paint(box, soft_tissue, strands, 48.0F);
    canvas.paint(
        box, eyes,
        [](const glm::vec3& p) {
            return sphere(folded(p), {32.0F, -66.0F, -2.0F}, 12.2F);
        },
        [](const glm::vec3& p, float d) {
            const float lens = ellipsoid(folded(p), {32.0F, -74.5F, -2.0F}, {4.8F, 2.3F, 4.8F});
            return lens < 0.0F ? 105.0F : d > -1.4F ? 58.0F : 9.0F;
        });
}

void paint_spine(Canvas& canvas, std::uint32_t seed) {
    const PaintedBox box{{-50.0F, 0.0F, -130.0F}, {50.0F, 90.0F, -28.0F}};
    for (int level = 1; level <= vertebra_count; ++level) {
        canvas.paint(
            box, vertebrae, [level](const glm::vec3& p) { return vertebra_distance(p, level); },
            [seed](const glm::vec3& p, float d) { return 0.85F * bone(p, d, seed + 4U); });
    }
    const auto canal = [](const glm::vec3& p) {
        return rod(p, {0.0F, 36.0F, -32.0F}, {0.0F, 40.0F, -135.0F}, 9.5F, 8.0F);
    };
    canvas.paint({{-12.0F, 20.0F, -130.0F}, {12.0F, 55.0F, -28.0F}}, soft_tissue, canal, fluid + 4.0F);
}

void paint_jaw(Canvas& canvas, std::uint32_t seed) {
    canvas.paint(jaw_box, mandible, mandible_distance,
                 [seed](const glm::vec3& p, float d) { return bone(p, d, seed + 5U) + 60.0F; });
    for (const bool upper : {true, false}) {
        for (int number = 0; number < teeth_per_side; ++number) {
            const Tooth t = tooth(number, upper);
            for (const float side : {1.0F, -1.0F}) {
                const glm::vec3 mirror(side, 1.0F, 1.0F);
                const glm::vec3 reach(9.0F, 9.0F, 26.0F);
                canvas.paint(
                    {mirror * t.centre - reach, mirror * t.centre + reach}, teeth,
                    [&](const glm::vec3& p) { return tooth_distance(mirror * p, t); },
                    [&](const glm::vec3& p, float d) {
                        const float up = t.root_mm > 0.0F ? p.z - t.centre.z : t.centre.z - p.z;
                        const bool crown = up < 0.6F * t.half_lengths.z;
                        const float dentine = d < -2.0F ? 900.0F : 1500.0F;
                        return crown && d > -1.3F ? 2500.0F : dentine;
                    });
            }
        }
    }
}

void paint_brain(Canvas& canvas, std::uint32_t seed) {
    canvas.paint(braincase_box, soft_tissue, braincase_distance, fluid + 3.0F);
    canvas.paint(
        braincase_box, brain, [seed](const glm::vec3& p) { return cerebrum_at(p, seed).surface_mm; },
        [seed](const glm::vec3& p, float) {
            const float cortex = step_between(3.6F, 2.4F, cerebrum_at(p, seed).cortex_mm);
            const float nuclei = step_between(0.5F, -0.5F, deep_gray_distance(p));
            float value = white_matter + (gray_matter - white_matter) * std::max(cortex, nuclei);
            const float wet = step_between(8.0F, 2.0F, bleed_distance(p, seed));
            value += (swelling - value) * wet * (1.0F - 0.7F * cortex);
            return value;
        });
    canvas.paint({{-32.0F, -5.0F, -130.0F}, {32.0F, 55.0F, 20.0F}}, brain, stem_distance, 31.0F);
    canvas.paint(braincase_box, cerebellum, cerebellum_distance, [seed](const glm::vec3& p, float) {
        return white_matter + (gray_matter + 1.0F - white_matter) * cerebellum_gray(p, seed);
    });
    canvas.paint(braincase_box, ventricles, ventricle_distance, fluid);
    canvas.paint(braincase_box, soft_tissue, dura_distance, dura);
    canvas.paint(
        braincase_box, bleed, [seed](const glm::vec3& p) { return bleed_distance(p, seed); },
        [seed](const glm::vec3& p, float) { return clot + 8.0F * noise_at(p, 7.0, seed + 7U); });
    // What is chalky in most adults: pineal gland and choroid plexus.
    const auto chalk = [](const glm::vec3& p) {
        return std::min(sphere(p, {0.0F, 27.0F, 15.0F}, 2.2F),
                        sphere(folded(p), {23.0F, 34.0F, 21.0F}, 2.4F));
    };
    canvas.paint(braincase_box, brain, chalk, 260.0F);
}

/// Blood flows through gray matter three times as much as through white; less around the bleed, none in it.
Volume perfusion_of(const VolumeGrid& grid, std::uint64_t seed) {
    Canvas map(grid, 0.0F, seed);
    const auto salt = static_cast<std::uint32_t>(seed);
    const auto inside = [](const glm::vec3& p) { return braincase_distance(p) + 3.0F; };
    map.paint(braincase_box, brain, inside, [salt](const glm::vec3& p, float d) {
        const float gray =
            std::max(step_between(-24.0F, -6.0F, d), step_between(6.0F, -4.0F, deep_gray_distance(p)));
        float flow = (22.0F + 42.0F * gray) * (1.0F + 0.35F * noise_at(p, 30.0, salt + 8U));
        flow *= 0.15F + 0.85F * step_between(0.0F, 22.0F, bleed_distance(p, salt));
        return flow * step_between(-2.0F, 6.0F, ventricle_distance(p));
    });
    return map.values(ScalarType::f32);
}

}  // namespace

HeadVolumes make_head(std::uint64_t seed, int coarser) {
    const auto salt = static_cast<std::uint32_t>(seed);
    Canvas canvas(grid_of(glm::ivec3(192, 224, 192) / coarser), air, seed);
    paint_soft_tissue(canvas, salt);
    paint_skull(canvas, salt);
    paint_airways(canvas);
    paint_orbits(canvas);
    paint_spine(canvas, salt);
    paint_jaw(canvas, salt);
    paint_brain(canvas, salt);
    canvas.blur(point_spread_mm);
    canvas.add_noise(noise_sigma, salt);
    HeadVolumes head{.ct = canvas.values(ScalarType::i16),
                     .labels = canvas.labels(),
                     .perfusion = perfusion_of(grid_of(glm::ivec3(32) / coarser), seed)};
    head.ct.unit = "HU";
    return head;
}

}  // namespace viscera::assets
