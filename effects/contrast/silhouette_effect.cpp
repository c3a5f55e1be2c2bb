#include "effects/contrast/silhouette_effect.h"

#include "engine/core/hash.h"
#include "engine/gl/mesh.h"
#include "engine/io/mesh.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::contrast {

SilhouetteEffect::SilhouetteEffect()
    : programs_{{"contrast/geometry.vert", "contrast/silhouette.frag", {}}} {}

void SilhouetteEffect::visit(ParamVisitor& v) {
    v.field({.name = "mesh", .doc = "Surface: glTF, GLB, STL, OBJ, PLY or VTP.", .required = true}, mesh_);
    v.field({.name = "mesh_filter", .doc = "Only meshes whose name contains this; empty: all."}, filter_);
    v.field({.name = "mm_per_unit",
             .doc = "Length of the file's unit; by default 1000 for glTF, 1 for the others.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            mm_per_unit_);
}

std::vector<Port> SilhouetteEffect::ports() const {
    return {{.name = "mask",
             .access = Access::write,
             .target = "contrast.mask",
             .doc = "1 where the mesh is seen."}};
}

Work SilhouetteEffect::prepare(Prepare& prepare) {
    if (!data_ || parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        data_ = prepare.assets().shared<MeshData>(parameters_key_, [&] {
            return std::make_shared<MeshData>(io::merge(io::load_meshes(
                mesh_.path, {.scale_mm_per_unit = mm_per_unit_, .name_filter = filter_}, prepare.log())));
        });
    }
    const glm::dmat4 view_projection = prepare.frame().eye().view_projection();
    const glm::ivec2 size = prepare.size("mask");
    const PixelRect region = project_bounds(data_->bounds(), view_projection, size);
    if (region.empty()) {
        return Work::idle("the mesh lies outside the view");
    }
    return Work::in_region(region, "only where the mesh can be seen",
                           Hash().add(parameters_key_).add(view_projection).value());
}

void SilhouetteEffect::draw(const Pass& pass) {
    const gl::Mesh& mesh = *pass.assets().shared<gl::Mesh>(
        parameters_key_, [&] { return std::make_shared<gl::Mesh>(pass.gl(), *data_); });
    const gl::Program& program = pass.use(0);
    program.set("u_view_projection", glm::mat4(pass.frame().eye().view_projection()));
    mesh.draw();
}

}  // namespace viscera::contrast
