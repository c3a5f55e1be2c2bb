#include "effects/tissue/blood_account_effect.h"

#include "engine/core/log.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

constexpr int side = 64;  // of the target, as in blood_account.frag

}  // namespace

BloodAccountEffect::BloodAccountEffect()
    : programs_{{"common/fullscreen.vert", "tissue/blood_account.frag", {}}} {}

void BloodAccountEffect::visit(ParamVisitor& v) {
    v.field({.name = "state", .doc = "Name of the blood, as its pass has it."}, state_name_);
}

std::vector<Port> BloodAccountEffect::ports() const {
    return {
        {.name = "height",
         .access = Access::read,
         .target = "tissue.blood_height",
         .doc = "Of the pass that makes the blood."},
        {.name = "account",
         .access = Access::write,
         .target = "tissue.blood_account",
         .doc = "Volumes [mm^3] whose sums over all texels are: given by wounds, on the surface as film, as "
                "drops or in the air, gone (run off, dried, sucked off or rinsed away).",
         .format = PixelFormat::rgba32f,
         .size = {.width = side, .height = side},
         .overwrites = true}};
}

Work BloodAccountEffect::prepare(Prepare& prepare) {
    state_ = BloodState::find(prepare.assets(), state_name_);
    if (!prepare.has("height")) {
        return Work::idle("there is no blood");
    }
    if (!state_->begun) {
        prepare.log().fault("tissue.no_blood_of_name",
                            "no tissue.blood has the state '" + state_name_ + "' that a pass asks for");
    }
    if (!state_->there) {
        return Work::idle("there is no blood of this name");
    }
    return Work::all(prepare.parameters_key());
}

void BloodAccountEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(0);
    pass.bind(program, "u_film", state_->gpu->film(), gl::Filter::nearest);
    pass.bind(program, "u_drops", state_->gpu->drops(), gl::Filter::nearest);
    pass.bind(program, "u_ledger", state_->gpu->ledger(), gl::Filter::nearest);
    program.set("u_flying", static_cast<float>(state_->flying_mm3()));
    program.set("u_lost", static_cast<float>(state_->jets.lost_mm3()));
    pass.draw_fullscreen();
}

}  // namespace viscera::tissue
