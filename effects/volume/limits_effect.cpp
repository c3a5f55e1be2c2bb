#include "effects/volume/limits_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/volume/crop.h"
#include "effects/volume/sector_mesh.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/gl/mesh.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::volume {
namespace {

/// The projection with its far plane behind all of a box, since rays that are not clipped to their exit would
/// look as if they had none.
glm::dmat4 with_far_behind(const View& view, const Bounds& bounds, const glm::dmat4& local_to_world) {
    const glm::dmat4 to_eye = view.view * local_to_world;
    glm::dmat4 p = view.projection;
    const double near = view.orthographic ? (p[3][2] + 1.0) / p[2][2] : p[3][2] / (p[2][2] - 1.0);
    double far = -1e300;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner((i & 1) != 0 ? bounds.max.x : bounds.min.x,
                                (i & 2) != 0 ? bounds.max.y : bounds.min.y,
                                (i & 4) != 0 ? bounds.max.z : bounds.min.z);
        far = std::max(far, -(to_eye * glm::dvec4(corner, 1.0)).z);
    }
    far = std::max(far, near) + 0.01 * std::abs(near) + 1e-3 * std::abs(far);
    p[2][2] = view.orthographic ? -2.0 / (far - near) : -(far + near) / (far - near);
    p[3][2] = (view.orthographic ? -(far + near) : -2.0 * far * near) / (far - near);
    return p;
}

}  // namespace

void LimitsParams::visit(ParamVisitor& v) {
    v.field({.name = "volume", .doc = "The volume whose rays are limited, as in volume.ray_cast."}, volume);
    v.field({.name = "crop", .doc = "Part of the volume, as in volume.ray_cast."}, crop);
    mesh.visit(v, "limits_mesh",
               "Closed surface in the volume's world instead of its box: glTF, GLB, STL, OBJ, PLY or VTP.");
}

MeshData box_mesh(const glm::vec3& low, const glm::vec3& high) {
    MeshData mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                    (i & 4) != 0 ? high.z : low.z);
    }
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

double signed_volume6(const MeshData& mesh) {
    // About the mesh's own centre: far from it the terms would cancel.
    const Bounds bounds = mesh.bounds();
    const glm::dvec3 centre = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
    double sum = 0.0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const auto at = [&](std::size_t i) {
            return glm::dvec3(mesh.positions[mesh.indices[t + i]]) - centre;
        };
        sum += glm::dot(at(0), glm::cross(at(1), at(2)));
    }
    return sum;
}

LimitsEffect::LimitsEffect(Side side)
    : side_(side), programs_{{"volume/limits.vert", "volume/limits.frag", {}}} {
    if (leaves()) {
        programs_.front().defines.emplace_back("EXIT");
    }
}

void LimitsEffect::validate() const {
    params_.volume.validate();
}

std::vector<Port> LimitsEffect::ports() const {
    static constexpr std::array<std::string_view, 4> targets{"volume.entry", "volume.exit",
                                                             "volume.inner_entry", "volume.inner_exit"};
    static constexpr std::array<std::string_view, 4> depths{
        "volume.entry_depth", "volume.exit_depth", "volume.inner_entry_depth", "volume.inner_exit_depth"};
    const auto side = static_cast<std::size_t>(side_);
    return {{.name = "place",
             .access = Access::write,
             .target = std::string(targets.at(side)),
             .doc = "Local coordinates; 1 where a ray passes the face as this side asks, -1 where it passes "
                    "the other way, 0 beside the faces.",
             .format = PixelFormat::rgba32f},
            {.name = "depth",
             .access = Access::write,
             .target = std::string(depths.at(side)),
             .doc = "Depth of the face kept.",
             .format = PixelFormat::depth32f,
             .clear = {farthest() ? 0.0F : 1.0F, 0.0F, 0.0F, 0.0F}}};
}

void LimitsEffect::find_mesh(Prepare& prepare) {
    if (params_.mesh.empty()) {
        const CropBox box = crop_box(params_.crop, grid_.dims);
        mesh_ = space_.shape.curvilinear() ? sector_mesh(space_, space_.coordinates(box.low, box.high))
                                           : box_mesh(box.low, box.high);
    } else {
        mesh_ = params_.mesh.in_local(space_.local_to_world, prepare.log());
    }
    bounds_ = mesh_.bounds();
    inside_out_ = signed_volume6(mesh_) < 0.0;
}

Work LimitsEffect::prepare(Prepare& prepare) {
    const std::shared_ptr<const Source> source =
        load_source(prepare.assets(), params_.volume, prepare.frame());
    if (!source) {
        return Work::idle("the host gives no volume of this name");
    }
    const VolumeGrid& grid = source->volume().grid;
    if (parameters_key_ != prepare.parameters_key() || !(grid_ == grid)) {
        parameters_key_ = prepare.parameters_key();
        grid_ = grid;
        space_ = make_space(grid, params_.volume.placement);
        // Sectors of many shapes have one local space; cropped by voxels, the same shape has many ends.
        const VolumeShape& shape = space_.shape;
        mesh_key_ =
            Hash()
                .add(parameters_key_)
                .add(space_.local_to_world)
                .add(grid.dims)
                .add(shape.kind)
                .add(glm::dvec4(shape.r_min_mm, shape.first_angle_rad, shape.angle_rad, shape.height_mm))
                .add(glm::dvec2(shape.latitude_rad, shape.wrap ? 1.0 : 0.0))
                .value();
        mesh_ = {};
        if (invertible(space_.local_to_world) && !space_.shape.flat()) {
            find_mesh(prepare);
        }
    }
    if (!invertible(space_.local_to_world)) {
        return Work::idle("the volume's placement is singular");
    }
    if (mesh_.indices.empty()) {
        return Work::idle("the mesh has no triangles");
    }
    const View& view = prepare.frame().eye();
    const PixelRect region =
        project_bounds(bounds_, view.view_projection() * space_.local_to_world, prepare.size("place"));
    if (region.empty()) {
        return Work::idle("what limits the rays lies outside the view");
    }
    Work work = Work::in_region(region, "only where the limits can be seen",
                                Hash().add(mesh_key_).add(view.view).add(view.projection).value());
    work.subject =
        limits_subject(space_.local_to_world, params_.mesh.empty() ? &params_.crop : nullptr, grid.dims);
    return work;
}

void LimitsEffect::draw(const Pass& pass) {
    const gl::Mesh& mesh = *pass.assets().shared<gl::Mesh>(
        mesh_key_, [&] { return std::make_shared<gl::Mesh>(pass.gl(), mesh_); });
    const View& view = pass.frame().eye();
    const gl::Program& program = pass.use(0);
    program.set("u_to_clip", glm::mat4(with_far_behind(view, bounds_, space_.local_to_world) * view.view *
                                       space_.local_to_world));
    gl::RasterState state = gl::depth_tested_state;
    if (farthest()) {
        state.depth_test = GL_GREATER;
    }
    if (side_ == Side::inner_entry) {
        state.cull = GL_BACK;
    } else if (side_ == Side::inner_exit) {
        state.cull = GL_FRONT;
    }
    const bool mirrored = view.mirrored != (glm::determinant(glm::dmat3(space_.local_to_world)) < 0.0);
    state.front_face = mirrored != inside_out_ ? GL_CW : GL_CCW;
    pass.raster(state);
    mesh.draw();
}

}  // namespace viscera::volume
