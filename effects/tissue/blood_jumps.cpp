#include "effects/tissue/blood_jumps.h"

#include <vector>

#include "effects/tissue/blood_programs.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

gl::Texture numbers_of(const gl::Functions& gl, std::span<const int> gutters, int size) {
    const auto width = static_cast<std::size_t>(size);
    std::vector<float> numbers(width * width, -1.0F);
    for (std::size_t i = 0; i < gutters.size(); ++i) {
        numbers[static_cast<std::size_t>(gutters[i])] = static_cast<float>(i);
    }
    gl::Texture texture = gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "gutters");
    texture.upload(std::as_bytes(std::span(numbers)));
    return texture;
}

ListTexture list_of(const gl::Functions& gl, std::span<const int> gutters, int size) {
    std::vector<glm::vec4> items;
    items.reserve(gutters.size());
    for (const int gutter : gutters) {
        items.emplace_back(gutter % size, gutter / size, 0.0F, 0.0F);
    }
    ListTexture list;
    list.upload(gl, items, "gutters");
    return list;
}

gl::Texture beside(const gl::Functions& gl, const ListTexture& list, std::string_view label) {
    return gl::Texture::make_2d(gl, list.texture().width(), list.rows(), PixelFormat::rgba32f, label);
}

}  // namespace

BloodJumps::BloodJumps(const gl::Functions& gl, std::span<const int> gutters, int size)
    : numbers_(numbers_of(gl, gutters, size)),
      gutters_(list_of(gl, gutters, size)),
      jumps_(beside(gl, gutters_, "where gutters lead")),
      slopes_(beside(gl, gutters_, "slopes of gutters")),
      target_(target_of(gl, jumps_, slopes_, "where gutters lead")) {}

void BloodJumps::take(const Pass& pass, const gl::Texture& film) const {
    const gl::Program& program = use(pass, BloodShader::jump);
    tissue::bind(pass, program, "u_gutters", gutters_.texture());
    tissue::bind(pass, program, "u_film", film);
    pass.bind(program, "u_right", "flow_right");
    draw_into(pass, target_, gl::overwrite_state);
    pass.draw_fullscreen();
}

void BloodJumps::bind(const Pass& pass, const gl::Program& program) const {
    tissue::bind(pass, program, "u_numbers", numbers_);
    tissue::bind(pass, program, "u_jumps", jumps_);
    tissue::bind(pass, program, "u_slopes", slopes_);
}

}  // namespace viscera::tissue
