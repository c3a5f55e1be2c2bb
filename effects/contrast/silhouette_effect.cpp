#include "effects/contrast/silhouette_effect.h"

#include "engine/core/hash.h"
#include "engine/gl/mesh.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::contrast {

SilhouetteEffect::SilhouetteEffect()
    : programs_{{"contrast/geometry.vert", "contrast/silhouette.frag", {}}} {}

std::vector<Port> SilhouetteEffect::ports() const {
    return {{.name = "mask",
             .access = Access::write,
             .target = "contrast.mask",
             .doc = "1 where the mesh is seen."}};
}

Work SilhouetteEffect::prepare(Prepare& prepare) {
    if (!data_ || parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        mesh_key_ = mesh_.key(prepare.assets());
        data_ = prepare.assets().shared<MeshData>(
            mesh_key_, [&] { return std::make_shared<MeshData>(mesh_.load_merged(prepare.log())); });
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
        mesh_key_, [&] { return std::make_shared<gl::Mesh>(pass.gl(), *data_); });
    const gl::Program& program = pass.use(0);
    program.set("u_view_projection", glm::mat4(pass.frame().eye().view_projection()));
    mesh.draw();
}

}  // namespace viscera::contrast
