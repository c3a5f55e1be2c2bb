#include "effects/tissue/drop_groups.h"

#include <bit>

#include "effects/tissue/blood_programs.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

constexpr int groups_in_row = 64;  // as glsl/tissue/drop_ring.glsl
constexpr int group_side = 4;      // the same
constexpr std::size_t most_questions = 3;
constexpr int group_size = static_cast<int>(DropRing::group_size);

int groups_for(int drops) {
    return (drops + group_size - 1) / group_size;
}

}  // namespace

DropGroups::DropGroups(const gl::Functions& gl, int capacity)
    : gl_(&gl),
      capacity_(groups_for(capacity) * group_size),
      lives_(gl::Texture::make_2d(gl, groups_in_row, (groups_for(capacity) - 1) / groups_in_row + 1,
                                  PixelFormat::rg8, "drops that live")),
      lives_target_(gl, lives_, "drops that live"),
      answers_(gl) {
    drop_list_.upload(gl, {}, "drops that live");
    group_list_.upload(gl, {}, "groups of drops");
}

int DropGroups::width() const {
    return lives_.width() * group_side;
}

int DropGroups::height() const {
    return lives_.height() * group_side;
}

void DropGroups::update(DropRing& ring) {
    while (answers_.poll(answer_)) {
        ring.hear(answer_.tag, answer_.image.data);
    }
    if (listed_version_ == ring.version()) {
        return;
    }
    listed_version_ = ring.version();
    drops_ = 0;
    drop_items_.clear();
    group_items_.clear();
    const std::span<const std::uint16_t> lives = ring.lives();
    for (std::size_t group = 0; group < lives.size(); ++group) {
        if (lives[group] != 0) {
            group_items_.emplace_back(group, 0.0F, 0.0F, 0.0F);
        }
        for (unsigned left = lives[group]; left != 0; left &= left - 1) {
            if (drops_ % 4 == 0) {
                drop_items_.emplace_back(0.0F);
            }
            drop_items_.back()[drops_++ % 4] =
                static_cast<float>(group * DropRing::group_size) + static_cast<float>(std::countr_zero(left));
        }
    }
    if (drops_ > 0) {
        drop_list_.upload(*gl_, drop_items_, "drops that live");
        group_list_.upload(*gl_, group_items_, "groups of drops");
    }
}

void DropGroups::ask(const Pass& pass, DropRing& ring, const gl::Texture& drops, const gl::Texture& before) {
    if (drops_ == 0 || answers_.in_flight() >= most_questions) {
        return;
    }
    const gl::Program& program = use(pass, BloodShader::lives);
    tissue::bind(pass, program, "u_drops", drops);
    tissue::bind(pass, program, "u_drops_before", before);
    draw_into(pass, lives_target_, {.program_point_size = true});
    cover(pass, program, 1);
    answers_.start(lives_, ring.ask());
}

void DropGroups::bind(const Pass& pass, const gl::Program& program, int first) const {
    tissue::bind(pass, program, "u_living", drop_list_.texture());
    program.set("u_first", first);
    program.set("u_capacity", capacity_);
}

void DropGroups::bind(const Pass& pass, const gl::Program& program) const {
    bind(pass, program, -1);
}

void DropGroups::bind(const Pass& pass, const gl::Program& program, const DropRange& run) const {
    bind(pass, program, static_cast<int>(run.first % capacity_));
}

void DropGroups::cover(const Pass& pass, const gl::Program& program) const {
    cover(pass, program, group_side);
}

void DropGroups::cover(const Pass& pass, const gl::Program& program, int side) const {
    tissue::bind(pass, program, "u_groups", group_list_.texture());
    program.set("u_size", glm::vec2(side * lives_.width(), side * lives_.height()));
    program.set("u_side", side);
    pass.draw_generated(GL_POINTS, static_cast<int>(group_items_.size()), 1);
}

}  // namespace viscera::tissue
