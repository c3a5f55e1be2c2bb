#include "effects/contrast/gpu_vessel.h"

#include <utility>
#include <vector>

namespace viscera::contrast {

GpuVessel::GpuVessel(const gl::Functions& gl, std::shared_ptr<const Vessel> drawn)
    : vessel(std::move(drawn)), mesh(gl, vessel->mesh) {
    mesh.update_scalars("scalar", vessel->scalar);
    mesh.select_scalar("scalar");
    const VertexTubes& tubes = vessel->tubes;
    if (tubes.axis.empty()) {
        return;
    }
    // What is known of the vessel around a vertex, in attributes that a vessel has no other use for.
    std::vector<glm::vec2> weight_and_axis_x(tubes.axis.size());
    std::vector<glm::vec2> axis_yz(tubes.axis.size());
    for (std::size_t i = 0; i < tubes.axis.size(); ++i) {
        weight_and_axis_x[i] = {vessel->weight.empty() ? 1.0F : vessel->weight[i], tubes.axis[i].x};
        axis_yz[i] = {tubes.axis[i].y, tubes.axis[i].z};
    }
    mesh.update_uvs(weight_and_axis_x);
    mesh.update_picture_uvs(axis_yz);
    mesh.update_normals(tubes.offset_mm);
}

}  // namespace viscera::contrast
