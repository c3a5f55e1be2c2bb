#include "effects/organ/surface_effect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "effects/organ/lights.h"
#include "effects/organ/pictures.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::organ {
namespace {

constexpr glm::dvec3 liver_colour(0.44, 0.13, 0.1);

/// The nearest surface wins; membranes hide nothing from one another and keep what lies behind in sight.
constexpr gl::RasterState opaque_state = gl::depth_tested_state;
constexpr gl::RasterState blended_state{.depth_test = GL_LESS,
                                        .blend = gl::Blend{.destination_rgb = GL_ONE_MINUS_SRC1_COLOR,
                                                           .source_alpha = GL_ONE,
                                                           .destination_alpha = GL_ONE_MINUS_SRC1_ALPHA}};

double hint_share(const HintParams& hint, double time_s) {
    if (hint.period_s == 0.0) {
        return hint.strength;
    }
    return hint.strength * 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * time_s / hint.period_s));
}

/// Triangles whose vertices go round the other way than their normals say.
std::size_t wound_against_normals(const MeshData& mesh) {
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto vertex = [&](std::size_t k) { return mesh.indices[3 * t + k]; };
        const auto edge = [&](std::size_t k) {
            return glm::dvec3(mesh.positions[vertex(k)]) - glm::dvec3(mesh.positions[vertex(0)]);
        };
        glm::dvec3 normal(0.0);
        for (std::size_t k = 0; k < 3; ++k) {
            normal += glm::dvec3(mesh.normals[vertex(k)]);
        }
        count += glm::dot(glm::cross(edge(1), edge(2)), normal) < 0.0 ? 1 : 0;
    }
    return count;
}

std::uint64_t host_version(const HostValues* values, const std::string& name) {
    const HostValues::Entry* given = values == nullptr || name.empty() ? nullptr : values->find(name);
    return given == nullptr ? 0 : given->version;
}

}  // namespace

bool SurfaceEffect::needs_own_mesh() const {
    return params_.blending == Blending::blended || !params_.cut.vertex_scalar.empty();
}

void SurfaceEffect::load(Prepare& prepare) {
    parameters_key_ = prepare.parameters_key();
    surface_ = SurfaceMesh::load(prepare.assets(), params_.mesh);
    to_world_ = placement_matrix(params_.mesh.placement, surface_->centre());
    const MeshData& mesh = surface_->data();
    if (const std::size_t turned = wound_against_normals(mesh); 2 * turned > mesh.triangle_count()) {
        prepare.log().fault("organ.winding",
                            params_.mesh.file.path.string() + ": " + std::to_string(turned) + " of " +
                                std::to_string(mesh.triangle_count()) +
                                " triangles go round clockwise, seen from where their normals "
                                "point: they are lit as seen from behind");
    }
}

/// What was painted on another mesh lies anywhere on this one. The same mesh in another place is none: a
/// membrane around the organ shows the organ's paint.
void SurfaceEffect::check_subjects(Prepare& prepare) const {
    const std::uint64_t own = surface_->key();
    for (const char* port : {"energy", "blood_colour", "blood_normal", "blood_height"}) {
        const std::uint64_t subject = prepare.has(port) ? prepare.subject(port) : 0;
        if (subject != 0 && subject != own) {
            prepare.log().fault("organ.other_mesh",
                                params_.mesh.file.path.string() + ": what port '" + port +
                                    "' brings was painted on another mesh or atlas, and lies in the wrong "
                                    "places here");
        }
    }
}

/// Whether lights add anything that the surface's colour has no share in.
bool SurfaceEffect::shines() const {
    const bool highlights =
        params_.shading.specular > 0.0 && params_.shading.specular_colour != glm::dvec3(0.0);
    return std::ranges::any_of(params_.lights, [&](const LightParams& light) {
        return light.colour != glm::dvec3(0.0) && (highlights || glows(light));
    });
}

Variant SurfaceEffect::variant_of(const Prepare& prepare) const {
    Variant variant;
    variant.diffuse = !params_.diffuse_map.empty() || prepare.has("diffuse");
    variant.energy = prepare.has("energy");
    variant.blood = prepare.has("blood_colour");
    if (variant.blood && params_.blood.bump > 0.0) {
        if (prepare.has("blood_normal")) {
            variant.relief = BloodRelief::normal;
        } else if (prepare.has("blood_height")) {
            variant.relief = BloodRelief::height;
        }
    }
    variant.cut = !params_.cut.map.empty() || prepare.has("cut");
    variant.hint = hint_share_ > 0.0 && (!params_.hint.map.empty() || prepare.has("hint"));
    variant.hematoma = !hematoma_.empty();
    return variant;
}

void SurfaceEffect::name_features(const Variant& variant) {
    reason_ = "only where the organ can be seen";
    std::string_view word = ", with ";
    const auto name = [&](bool there, std::string_view feature) {
        if (there) {
            reason_ += word;
            reason_ += feature;
            word = ", ";
        }
    };
    name(variant.diffuse, "diffuse map");
    name(has_relief(), "relief");
    name(variant.energy, "energy");
    name(variant.blood, "blood");
    name(variant.relief != BloodRelief::none, "blood relief");
    name(variant.cut, "cuts");
    name(variant.hint, "hint");
    name(variant.hematoma, "hematoma");
}

Work SurfaceEffect::prepare(Prepare& prepare) {
    const Frame& frame = prepare.frame();
    const bool is_new = !surface_ || parameters_key_ != prepare.parameters_key();
    if (is_new) {
        load(prepare);
    }
    surface_->move(frame.values, params_.mesh.host_positions, prepare.log());
    if (surface_->data().indices.empty()) {
        return Work::idle("the mesh has no triangles");
    }
    if (!invertible(to_world_)) {
        prepare.log().fault("organ.singular", "the organ's placement is singular; it is not drawn");
        return Work::idle("the organ's placement is singular");
    }
    if (params_.blending == Blending::blended && params_.opacity == 0.0 && !shines()) {
        return Work::idle("the membrane is clear, and nothing shines on it");
    }
    const View& view = frame.eye();
    const PixelRect region =
        project_bounds(surface_->bounds(), view.view_projection() * to_world_, prepare.size("colour"));
    if (region.empty()) {
        return Work::idle("the organ lies outside the view");
    }
    if (params_.hematoma.used()) {
        hematoma_.gather(params_.hematoma, frame.values, prepare.log());
    }
    hint_share_ = hint_share(params_.hint, frame.time_s);
    const Variant variant = variant_of(prepare);
    check_subjects(prepare);
    if (is_new || variant != variant_) {
        variant_ = variant;
        name_features(variant);
    }
    Hash key;
    key.add(parameters_key_).add(view.view).add(view.projection).add(surface_->shape_key());
    key.add(view.camera_in_eye_mm);
    key.add(variant.hint ? hint_share_ : 0.0);
    key.add(params_.hematoma.used() ? hematoma_.key() : 0);
    key.add(host_version(frame.values, params_.cut.vertex_scalar));
    return Work::in_region(region, reason_, key.value());
}

const gl::Mesh& SurfaceEffect::mesh(const Pass& pass, const glm::dmat4& to_eye) {
    if (!needs_own_mesh()) {
        return surface_->gpu(pass.gl());
    }
    own_mesh_.follow(pass.gl(), *surface_);
    if (!params_.cut.vertex_scalar.empty()) {
        own_mesh_.select_scalar(*surface_, params_.cut.vertex_scalar, pass.frame().values, pass.log());
    }
    if (params_.blending == Blending::blended) {
        // Row of the matrix that makes view depth: z of the eye's frame falls with it.
        own_mesh_.sort(*surface_, -glm::dvec3(to_eye[0][2], to_eye[1][2], to_eye[2][2]));
    }
    return own_mesh_.mesh();
}

void SurfaceEffect::set_view(const Pass& pass, const gl::Program& program, const View& view,
                             const glm::dmat4& to_eye) {
    const glm::dvec3 centre_in_eye(to_eye * glm::dvec4(surface_->centre(), 1.0));
    program.set("u_to_clip", glm::mat4(view.projection * to_eye));
    program.set("u_turn", glm::mat3(glm::dmat3(to_eye)));
    program.set("u_normal_to_eye", glm::mat3(glm::transpose(glm::inverse(glm::dmat3(to_eye)))));
    program.set("u_pivot", glm::vec3(surface_->centre()));
    program.set("u_pivot_in_eye", glm::vec3(centre_in_eye));
    const glm::dmat4& p = view.projection;
    // An orthographic view's rays slant for an eye of two.
    program.set("u_towards_eye", view.orthographic ? glm::vec3(-p[2][0] / p[0][0], -p[2][1] / p[1][1], 1.0F)
                                                   : glm::vec3(0.0F));
    const LightUniforms lights = make_lights(params_.lights, view, centre_in_eye);
    if (lights.too_far > 0) {
        pass.log().fault("organ.light_far", "lights beyond 10^8 mm count as at infinity", lights.too_far);
    }
    set_lights(program, lights);
}

void SurfaceEffect::set_material(const Pass& pass, const gl::Program& program) {
    const auto real = [&](std::string_view name, double value) {
        program.set(name, static_cast<float>(value));
    };
    const ShadingParams& shading = params_.shading;
    // The published normalisation, 3.14 included.
    const double normalised = shading.specular * (shading.shininess + 6.0) / (8.0 * 3.14);
    program.set("u_shading", glm::vec4(shading.ambient, shading.diffuse, normalised, shading.shininess));
    program.set("u_specular_colour", glm::vec3(shading.specular_colour));
    const glm::dvec3 plain = variant_.diffuse ? glm::dvec3(1.0) : liver_colour;
    program.set("u_colour", glm::vec3(params_.colour.value_or(plain)));
    const auto picture = [&](const AssetPath& file, std::string_view uniform, std::string_view port) {
        if (file.empty()) {
            pass.bind(program, uniform, port, gl::Filter::linear);
        } else {
            pass.bind(program, uniform, *colour_texture(pass, file), gl::Filter::trilinear, gl::Wrap::repeat);
        }
    };
    if (variant_.diffuse) {
        picture(params_.diffuse_map, "u_diffuse", "diffuse");
        real("u_diffuse_repeat", params_.diffuse_repeat);
    }
    if (has_relief()) {
        pass.bind(program, "u_slopes", *slope_texture(pass, params_.normal_map), gl::Filter::trilinear,
                  gl::Wrap::repeat);
        program.set("u_bump", glm::vec2(params_.normal_map.strength, params_.coagulation.bump_gain));
        real("u_bump_repeat", params_.normal_map.repeat);
    }
    if (variant_.energy) {
        pass.bind(program, "u_energy", "energy", gl::Filter::linear);
        program.set("u_coagulation_colour", glm::vec3(params_.coagulation.colour));
        program.set("u_coagulation",
                    glm::vec2(params_.coagulation.saturation, params_.coagulation.brightness));
    }
    if (variant_.blood) {
        pass.bind(program, "u_blood", "blood_colour", gl::Filter::linear);
        pass.bind(program, "u_blood_normal", "blood_normal", gl::Filter::linear);
        pass.bind(program, "u_blood_height", "blood_height", gl::Filter::linear);
        real("u_blood_bump", params_.blood.bump);
    }
    if (variant_.cut) {
        picture(params_.cut.map, "u_cut", "cut");
    }
    if (variant_.hint) {
        picture(params_.hint.map, "u_hint", "hint");
        real("u_hint_share", hint_share_);
    }
    if (params_.focus) {
        program.set("u_focus",
                    glm::vec3(params_.focus->near_mm, params_.focus->focus_mm, params_.focus->far_mm));
        program.set("u_focus_clamp", glm::vec2(params_.focus->clamp_near, params_.focus->clamp_far));
    }
    if (params_.blending == Blending::blended) {
        constexpr double densest = 60.0;
        real("u_depth_of_slab", std::min(-std::log1p(-params_.opacity), densest));
    }
}

void SurfaceEffect::set_raster(const Pass& pass, const View& view) const {
    gl::RasterState state = params_.blending == Blending::blended ? blended_state : opaque_state;
    if (params_.faces != Faces::both) {
        state.cull = params_.faces == Faces::front ? GL_BACK : GL_FRONT;
    }
    const bool mirrored = view.mirrored != (glm::determinant(glm::dmat3(to_world_)) < 0.0);
    state.front_face = mirrored ? GL_CW : GL_CCW;
    pass.raster(state);
}

void SurfaceEffect::draw(const Pass& pass) {
    const View& view = pass.frame().eye();
    const glm::dmat4 to_eye = view.view * to_world_;
    const gl::Mesh& triangles = mesh(pass, to_eye);
    const auto chosen = std::ranges::find(variants_, variant_);
    const gl::Program& program = pass.use(static_cast<std::size_t>(chosen - variants_.begin()));
    set_view(pass, program, view, to_eye);
    set_material(pass, program);
    if (variant_.hematoma) {
        hematoma_.set(pass, program, params_.hematoma, view,
                      glm::dvec3(to_eye * glm::dvec4(surface_->centre(), 1.0)));
    }
    set_raster(pass, view);
    triangles.draw();
}

}  // namespace viscera::organ
