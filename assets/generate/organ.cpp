#include <nlohmann/json.hpp>

#include "assets/generate/generate.h"
#include "assets/generate/hook.h"
#include "assets/generate/organ_field.h"
#include "assets/generate/organ_mesh.h"
#include "assets/generate/organ_paint.h"
#include "assets/generate/write_file.h"
#include "assets/generate/write_glb.h"
#include "assets/generate/write_png.h"

namespace viscera::assets {
namespace {

constexpr int abdomen_cells = 72;
constexpr int organ_pixels = 2048;
constexpr int abdomen_pixels = 512;

nlohmann::ordered_json rounded(const glm::dvec3& p) {
    const auto micrometres = [](double mm) { return std::round(mm * 1e3) / 1e3; };
    return {micrometres(p.x), micrometres(p.y), micrometres(p.z)};
}

/// Where a scene lets things happen, on the surface.
nlohmann::ordered_json landmarks(const OrganField& field, const OrganPaint& paint) {
    const auto [cut_a, cut_b] = paint.cut_line();
    const auto on = [&](const glm::dvec3& p) { return rounded(field.onto_surface(p)); };
    nlohmann::ordered_json json;
    json["down"] = {0, 1, 0};
    json["cut"] = {rounded(cut_a), on(0.5 * (cut_a + cut_b)), rounded(cut_b)};
    json["bed"] = {on({-52.0, 2.0, -30.0}), on({-46.0, 8.0, -20.0}), on({-40.0, 14.0, -8.0})};
    json["hollow"] = on({-66.0, -50.0, 16.0});
    json["fundus"] = on({-40.0, 8.0, -56.0});
    json["omentum"] = on({0.0, 50.0, -50.0});
    return json;
}

/// Height of the organ's relief [mm].
GrayImage relief_picture(const MeshData& organ, const OrganPaint& paint, int size) {
    const ColourImage painted = paint_atlas(organ, size, [&](const PaintPoint& p) {
        return glm::vec4(glm::vec3(static_cast<float>(paint.relief(p))), 1.0F);
    });
    GrayImage relief(size, size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const auto from = static_cast<std::size_t>(size - 1 - y) * static_cast<std::size_t>(size);
            relief.at(x, y) = painted.pixels[from + static_cast<std::size_t>(x)].r;
        }
    }
    return relief;
}

}  // namespace

void generate_organs(const std::filesystem::path& folder, std::uint64_t seed, int coarser) {
    const OrganField field(seed);
    const OrganPaint paint(field, seed);
    const MeshData organ = mesh_organ(field, organ_spacing_mm);
    write_glb(organ, folder / "meshes" / "organ.glb");
    write_file(folder / "meshes" / "organ.landmarks.json", landmarks(field, paint).dump(1) + "\n");
    const int size = organ_pixels / coarser;
    const auto picture = [&](const char* name, int pixels, bool with_alpha, auto&& brush) {
        write_png(paint_atlas(organ, pixels, brush), with_alpha, folder / "images" / name);
    };
    picture("organ_diffuse.png", size, false, [&](const PaintPoint& p) { return paint.colour(p); });
    picture("organ_normal.png", size, false, [&](const PaintPoint& p) { return paint.normal(p); });
    picture("organ_hint.png", size / 4, true, [&](const PaintPoint& p) { return paint.hint(p); });
    picture("organ_cut.png", size / 2, true, [&](const PaintPoint& p) { return paint.cut(p); });

    write_exr(relief_picture(organ, paint, size / 4), folder / "images" / "organ_relief.exr");

    write_glb(make_hook(), folder / "meshes" / "hook.glb");
    const MeshData abdomen = mesh_abdomen(seed, abdomen_cells);
    write_glb(abdomen, folder / "meshes" / "abdomen.glb");
    const int wall = abdomen_pixels / coarser;
    write_png(paint_atlas(abdomen, wall, [&](const PaintPoint& p) { return abdomen_colour(p, seed); }), false,
              folder / "images" / "abdomen_diffuse.png");
    write_png(paint_atlas(abdomen, wall, [&](const PaintPoint& p) { return abdomen_normal(p, seed); }), false,
              folder / "images" / "abdomen_normal.png");
}

}  // namespace viscera::assets
