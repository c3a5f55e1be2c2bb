#include "effects/mesh/surface_effect.h"

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/gl/mesh.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::mesh {
namespace {

constexpr std::size_t most_lights = 16;

}  // namespace

void LightParams::visit(ParamVisitor& v) {
    v.field({.name = "direction", .doc = "From the mesh towards the light, in the world."}, direction);
    v.field({.name = "colour", .doc = "Red, green and blue, linear.", .min = 0.0}, colour);
}

void SurfaceParams::visit(ParamVisitor& v) {
    mesh.visit(v);
    v.field({.name = "placement", .doc = "Where the mesh is put; its centre is its box's."}, placement);
    v.field({.name = "colour", .doc = "Red, green and blue, linear.", .min = 0.0, .max = 1.0}, colour);
    v.field({.name = "two_sided", .doc = "Back faces are drawn, lit as if they were front faces."},
            two_sided);
    v.field({.name = "ambient", .doc = "Share of the colour without any light.", .min = 0.0, .max = 1.0},
            ambient);
    v.field({.name = "diffuse", .doc = "Share of the colour that a light adds.", .min = 0.0, .max = 1.0},
            diffuse);
    v.field({.name = "specular", .doc = "Brightness of highlights.", .min = 0.0, .max = 1.0}, specular);
    v.field({.name = "shininess", .doc = "Exponent of highlights.", .min = 1.0, .max = 1000.0}, shininess);
    v.field({.name = "headlight", .doc = "Brightness of the light in the eye.", .min = 0.0}, headlight);
    v.field({.name = "lights", .doc = "Further lights, at most 16."}, lights);
}

void SurfaceEffect::validate() const {
    if (params_.lights.size() > most_lights) {
        throw Error(ErrorCode::scene, "/lights", "has more than " + std::to_string(most_lights) + " lights");
    }
    for (std::size_t i = 0; i < params_.lights.size(); ++i) {
        if (!(glm::length(params_.lights[i].direction) > 0.0)) {
            throw Error(ErrorCode::scene, "/lights/" + std::to_string(i) + "/direction", "has no length");
        }
    }
}

std::vector<Port> SurfaceEffect::ports() const {
    return {{.name = "colour",
             .access = Access::write,
             .target = "mesh.colour",
             .doc = "Colour as it is lit, and 1 where the mesh is.",
             .format = PixelFormat::rgba16f,
             .behind_depth = true},
            {.name = "depth",
             .access = Access::write,
             .target = "mesh.depth",
             .doc = "Depth of the nearest surface; 1 where there is none.",
             .format = PixelFormat::depth32f,
             .clear = {1.0F, 0.0F, 0.0F, 0.0F}}};
}

std::span<const ProgramDesc> SurfaceEffect::programs() const {
    ProgramDesc program{"mesh/surface.vert", "mesh/surface.frag", {}};
    if (!params_.lights.empty()) {
        program.defines.push_back("LIGHTS " + std::to_string(params_.lights.size()));
    }
    programs_ = {std::move(program)};
    return programs_;
}

Work SurfaceEffect::prepare(Prepare& prepare) {
    if (!data_ || parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        mesh_key_ = params_.mesh.key(prepare.assets());
        data_ = prepare.assets().shared<MeshData>(
            mesh_key_, [&] { return std::make_shared<MeshData>(params_.mesh.load_merged(prepare.log())); });
        bounds_ = data_->bounds();
        to_world_ = placement_matrix(params_.placement, 0.5 * glm::dvec3(bounds_.min + bounds_.max));
        light_directions_.resize(params_.lights.size());
        light_colours_.clear();
        for (const LightParams& light : params_.lights) {
            light_colours_.emplace_back(light.colour);
        }
    }
    if (data_->indices.empty()) {
        return Work::idle("the mesh has no triangles");
    }
    if (!invertible(to_world_)) {
        prepare.log().fault("mesh.singular", "the mesh's placement is singular; it is not drawn");
        return Work::idle("the mesh's placement is singular");
    }
    const View& view = prepare.frame().eye();
    const PixelRect region =
        project_bounds(bounds_, view.view_projection() * to_world_, prepare.size("colour"));
    if (region.empty()) {
        return Work::idle("the mesh lies outside the view");
    }
    return Work::in_region(region, "only where the mesh can be seen",
                           Hash().add(parameters_key_).add(view.view).add(view.projection).value());
}

void SurfaceEffect::draw(const Pass& pass) {
    const gl::Mesh& mesh = *pass.assets().shared<gl::Mesh>(
        mesh_key_, [&] { return std::make_shared<gl::Mesh>(pass.gl(), *data_); });
    const View& view = pass.frame().eye();
    const glm::dmat4 to_eye = view.view * to_world_;
    const gl::Program& program = pass.use(0);
    program.set("u_to_clip", glm::mat4(view.projection * to_eye));
    program.set("u_to_eye", glm::mat4(to_eye));
    program.set("u_normal_to_eye", glm::mat3(glm::transpose(glm::inverse(glm::dmat3(to_eye)))));
    program.set("u_colour", glm::vec3(params_.colour));
    program.set("u_ambient", static_cast<float>(params_.ambient));
    program.set("u_diffuse", static_cast<float>(params_.diffuse));
    program.set("u_specular", static_cast<float>(params_.specular));
    program.set("u_shininess", static_cast<float>(params_.shininess));
    program.set("u_headlight", static_cast<float>(params_.headlight));
    const glm::dmat4& p = view.projection;
    // An orthographic view's rays slant for an eye of two.
    program.set("u_towards_eye", view.orthographic ? glm::vec3(-p[2][0] / p[0][0], -p[2][1] / p[1][1], 1.0F)
                                                   : glm::vec3(0.0F));
    for (std::size_t i = 0; i < light_directions_.size(); ++i) {
        light_directions_[i] = glm::dmat3(view.view) * glm::normalize(params_.lights[i].direction);
    }
    program.set("u_light_direction", std::span<const glm::vec3>(light_directions_));
    program.set("u_light_colour", std::span<const glm::vec3>(light_colours_));
    gl::RasterState state = gl::depth_tested_state;
    if (!params_.two_sided) {
        state.cull = GL_BACK;
    }
    const bool mirrored = view.mirrored != (glm::determinant(glm::dmat3(to_world_)) < 0.0);
    state.front_face = mirrored ? GL_CW : GL_CCW;
    pass.raster(state);
    mesh.draw();
}

}  // namespace viscera::mesh
