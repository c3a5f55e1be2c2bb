#include "effects/tissue/jet_effect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

// Of the bits of a program's index.
constexpr std::size_t with_depth = 1;
constexpr std::size_t with_energy = 2;

// What is drawn over a picture leaves its alpha, which holds the blurriness of organs.
constexpr gl::RasterState over_picture{.blend = gl::Blend{.destination_rgb = GL_ONE_MINUS_SRC_ALPHA,
                                                          .source_alpha = GL_ZERO,
                                                          .destination_alpha = GL_ONE}};

}  // namespace

void JetParams::visit(ParamVisitor& v) {
    v.field({.name = "state", .doc = "Name of the blood, as its pass has it."}, state);
    v.field({.name = "exposure_s",
             .doc = "Time over which a picture is taken: drops blur along the way that they fly in it.",
             .unit = "s",
             .min = 0.0,
             .max = 1.0},
            exposure_s);
    v.field({.name = "colour", .doc = "Red, green and blue, linear.", .min = 0.0, .max = 1.0}, colour);
    v.field({.name = "sealed_energy",
             .doc = "Energy at which a wound is closed and its jet no longer shown.",
             .min = 0.0,
             .min_excluded = true},
            sealed_energy);
}

JetEffect::JetEffect() {
    for (std::size_t i = 0; i < 4; ++i) {
        ProgramDesc program{"tissue/jet.vert", "tissue/jet.frag", {}};
        if ((i & with_depth) != 0) {
            program.defines.emplace_back("DEPTH");
        }
        if ((i & with_energy) != 0) {
            program.defines.emplace_back("ENERGY");
        }
        programs_.push_back(std::move(program));
    }
}

JetEffect::~JetEffect() = default;

std::vector<Port> JetEffect::ports() const {
    return {{.name = "height",
             .access = Access::read,
             .target = "tissue.blood_height",
             .doc = "Of the pass that makes the blood."},
            {.name = "depth",
             .access = Access::read,
             .target = "organ.depth",
             .doc = "Depth of what hides jets, drawn with the same camera and of the picture's size.",
             .optional = true},
            {.name = "energy",
             .access = Access::read,
             .target = "tissue.energy",
             .doc = "Where tissue is coagulated, wounds are closed.",
             .optional = true},
            {.name = "picture",
             .access = Access::modify,
             .target = "organ.color",
             .doc = "The picture that jets are drawn over; its alpha stays."}};
}

Work JetEffect::prepare(Prepare& prepare) {
    state_ = BloodState::find(prepare.assets(), params_.state);
    if (prepare.has("height") && !state_->begun) {
        prepare.log().fault("tissue.no_blood_of_name",
                            "no tissue.blood has the state '" + params_.state + "' that a pass asks for");
    }
    if (state_->jets.particles().empty() && !state_->jets_bleed) {
        return Work::idle("no blood is in the air");
    }
    if (state_->sealed) {
        return Work::idle("all wounds are sealed");
    }
    const View& view = prepare.frame().eye();
    return Work::all(Hash()
                         .add(prepare.parameters_key())
                         .add(state_->version)
                         .add(prepare.frame().time_s)
                         .add(view.view)
                         .add(view.projection)
                         .value());
}

void JetEffect::draw(const Pass& pass) {
    const auto particles = state_->jets.particles();
    if (particles.empty()) {
        return;
    }
    items_.clear();
    for (const JetParticle& particle : particles) {
        const double radius = std::cbrt(particle.volume_mm3 * 3.0 / (4.0 * std::numbers::pi));
        items_.emplace_back(glm::vec3(particle.position_mm), static_cast<float>(radius));
        items_.emplace_back(glm::vec3(particle.velocity_mm_s), static_cast<float>(thread_s(particle)));
        items_.emplace_back(particle.sealed_at, 0.0F, 0.0F);
    }
    list_.upload(pass.gl(), items_, "jets of blood");
    const bool depth = pass.has("depth") && pass.texture("depth")->width() == pass.size().x &&
                       pass.texture("depth")->height() == pass.size().y;
    const bool energy = pass.has("energy");
    const gl::Program& program = pass.use((depth ? with_depth : 0) | (energy ? with_energy : 0));
    const View& view = pass.frame().eye();
    pass.bind(program, "u_particles", list_.texture(), gl::Filter::nearest);
    if (depth) {
        pass.bind(program, "u_depth", "depth");
    }
    if (energy) {
        pass.bind(program, "u_energy", "energy");
        program.set("u_sealed", static_cast<float>(params_.sealed_energy));
    }
    program.set("u_to_eye", glm::mat4(view.view));
    program.set("u_projection", glm::mat4(view.projection));
    program.set("u_exposure", static_cast<float>(params_.exposure_s));
    program.set("u_parallel", view.orthographic);
    // The projection's second row turns heights [mm, per mm of depth] into halves of the picture's height.
    program.set("u_pixel", static_cast<float>(2.0 / (std::abs(view.projection[1][1]) * pass.size().y)));
    program.set("u_colour", glm::vec3(params_.colour));
    pass.raster(over_picture);
    pass.draw_generated(GL_TRIANGLE_STRIP, 4, static_cast<int>(particles.size()));
}

}  // namespace viscera::tissue
