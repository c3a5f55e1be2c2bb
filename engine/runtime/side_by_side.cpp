#include "engine/runtime/side_by_side.h"

#include "engine/runtime/pass.h"

namespace viscera {

std::vector<Port> SideBySideEffect::ports() const {
    return {{.name = "left", .target = "", .doc = "The left eye's picture."},
            {.name = "right", .target = "", .doc = "The right eye's."},
            {.name = "picture",
             .access = Access::write,
             .target = "",
             .doc = "Both.",
             .format = format_,
             .clear = clear_,
             .overwrites = true}};
}

Work SideBySideEffect::prepare(Prepare& prepare) {
    if (!prepare.has("left") && !prepare.has("right")) {
        return Work::idle("both eyes' pictures are empty");
    }
    return Work::all(1);
}

void SideBySideEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(0);
    pass.bind(program, "u_left", "left");
    pass.bind(program, "u_right", "right");
    program.set("u_has", glm::ivec2(pass.has("left"), pass.has("right")));
    program.set("u_clear", glm::vec4(clear_[0], clear_[1], clear_[2], clear_[3]));
    program.set("u_width", pass.size().x / 2);
    pass.draw_fullscreen();
}

}  // namespace viscera
