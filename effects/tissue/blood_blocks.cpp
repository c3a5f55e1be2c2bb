#include "effects/tissue/blood_blocks.h"

#include <algorithm>
#include <utility>

#include "effects/tissue/blood_programs.h"
#include "effects/tissue/seam_reach.h"
#include "engine/core/pixel_index.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

constexpr int tile_side = 32;  // a multiple of a block's
// How far across a seam blood goes until the next plan, beyond where it lies or gutters lead.
constexpr int past_seam = 4;
// A film that creeps more slowly stands [mm/s].
constexpr float still_mm_s = 5e-4F;
constexpr int points_per_drop = 2;  // as blood_mark.vert
// Marks are points as large as what they mark, beside what the film does.
constexpr gl::RasterState drop_mark_state = [] {
    gl::RasterState state = gl::max_blend_state;
    state.program_point_size = true;
    state.colour_mask = {false, false, false, true};
    return state;
}();

std::array<gl::Texture, 2> pair_of(const gl::Functions& gl, int side, PixelFormat format, const char* label) {
    return {gl::Texture::make_2d(gl, side, side, format, label),
            gl::Texture::make_2d(gl, side, side, format, label)};
}

std::array<gl::Framebuffer, 2> targets_of(const gl::Functions& gl, const std::array<gl::Texture, 2>& textures,
                                          const char* label) {
    return {gl::Framebuffer(gl, textures[0], label), gl::Framebuffer(gl, textures[1], label)};
}

}  // namespace

BloodBlocks::BloodBlocks(const gl::Functions& gl, int size)
    : gl_(&gl),
      size_(size),
      tiles_(SquareGrid{size, tile_side}.count()),
      blocks_(SquareGrid{size, block_side}.count()),
      first_tile_(gl::Texture::make_2d(gl, tiles_, tiles_, PixelFormat::rg32f, "tiles across seams")),
      first_pair_(gl::Texture::make_2d(gl, blocks_, blocks_, PixelFormat::rg32f, "pairs of blocks")),
      surface_(gl::Texture::make_2d(gl, blocks_, blocks_, PixelFormat::r8, "blocks with a surface")),
      marks_(gl::Texture::make_2d(gl, tiles_, tiles_, PixelFormat::rg8, "tiles of blood")),
      reach_(gl::Texture::make_2d(gl, tiles_, tiles_, PixelFormat::rg8, "tiles in reach of blood")),
      held_(pair_of(gl, blocks_, PixelFormat::rgba8, "blocks of blood")),
      near_(gl::Texture::make_2d(gl, blocks_, blocks_, PixelFormat::rg8, "blocks near blood")),
      plan_(pair_of(gl, blocks_, PixelFormat::rg8, "blocks to be stepped")),
      stepped_(gl::Texture::make_2d(gl, blocks_, blocks_, PixelFormat::r8, "blocks stepped")),
      marks_target_(gl, marks_, "tiles of blood"),
      reach_target_(gl, reach_, "tiles in reach of blood"),
      held_target_(targets_of(gl, held_, "blocks of blood")),
      near_target_(gl, near_, "blocks near blood"),
      plan_target_(targets_of(gl, plan_, "blocks to be stepped")),
      stepped_target_(gl, stepped_, "blocks stepped"),
      answers_(gl) {}

void BloodBlocks::lie_on(const Image& position, std::span<const SeamLink> links,
                         std::span<const SeamJump> jumps) {
    const SeamReach tiles = reach_beside_seams({size_, tile_side}, links, jumps);
    tiles_across_.upload(*gl_, tiles.items, "tiles across seams");
    first_tile_.upload(std::as_bytes(std::span(tiles.first)));
    const SeamReach blocks = reach_across_seams({size_, block_side}, past_seam, links, jumps);
    block_pairs_.upload(*gl_, blocks.items, "blocks that seams join");
    first_pair_.upload(std::as_bytes(std::span(blocks.first)));
    const auto count = static_cast<std::size_t>(blocks_);
    const bool joined = !links.empty();  // else gutters lead nowhere
    std::vector<unsigned char> surface(count * count, 0);
    std::vector<unsigned char> cells(count * count, 0);
    std::vector<unsigned char> seams(count * count, 0);
    std::vector<unsigned char> beside_cells(count * count, 0);
    const auto is_cell = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < size_ && y < size_ && position.at(x, y, 3) > 0.75F;
    };
    for (int y = 0; y < size_; ++y) {
        for (int x = 0; x < size_; ++x) {
            const std::size_t block = pixel_index(x / block_side, y / block_side, blocks_);
            const float coverage = position.at(x, y, 3);
            surface[block] = coverage > 0.0F ? 255 : surface[block];
            cells[block] = coverage > 0.75F ? 1 : cells[block];
            const bool gutter = coverage > 0.0F && coverage < 0.75F;
            seams[block] = joined && gutter ? 1 : seams[block];
            for (int i = 0; gutter && i < 9; ++i) {
                beside_cells[block] = is_cell(x + i % 3 - 1, y + i / 3 - 1) ? 1 : beside_cells[block];
            }
        }
    }
    surface_.upload(std::as_bytes(std::span(surface)));
    const SquareGrid grid{size_, block_side};
    for (const SeamLink& link : links) {
        for (const float cell : {link.from, link.to}) {
            seams[static_cast<std::size_t>(grid.square_of(static_cast<int>(cell)))] = 1;
        }
    }
    std::vector<glm::vec4> list;
    const auto add = [&](auto&& wanted) {
        for (std::size_t i = 0; i < surface.size(); ++i) {
            if (surface[i] != 0 && wanted(i)) {
                list.emplace_back(i % count, i / count, 0.0F, 0.0F);
            }
        }
        return static_cast<int>(list.size());
    };
    without_seams_ = add([&](std::size_t i) { return cells[i] != 0 && seams[i] == 0; });
    with_cells_ = add([&](std::size_t i) { return cells[i] != 0 && seams[i] != 0; });
    stepped_blocks_ = add([&](std::size_t i) { return cells[i] == 0 && beside_cells[i] != 0; });
    listed_ = add([&](std::size_t i) { return cells[i] == 0 && beside_cells[i] == 0; });
    list_.upload(*gl_, list, "blocks with a surface");
}

void BloodBlocks::begin(const Pass& pass, bool everywhere) {
    const float value = everywhere ? 1.0F : 0.0F;
    for (std::size_t i = 0; i < 2; ++i) {
        draw_into(pass, held_target_[i], gl::overwrite_state);
        held_target_[i].clear_colour(0, {value, value, 0.0F, 0.0F});
        clear(pass, plan_target_[i], value);
    }
    clear(pass, stepped_target_);
    noted_ = false;
    steps_planned_ = 0;
    looked_ = false;
    tiles_old_ = true;
    expected_count_ = 0;
}

void BloodBlocks::expect(std::span<const glm::vec4> places) {
    expected_count_ = static_cast<int>(places.size());
    if (!places.empty()) {
        expected_.upload(*gl_, places, "places that bleed");
    }
}

const gl::Program& BloodBlocks::begin_mark(const Pass& pass, const BloodMedium& medium, BloodShader shader,
                                           const gl::Texture& drops) const {
    const gl::Program& program = use(pass, shader);
    bind(pass, program, "u_drops", drops);
    pass.bind(program, "u_metric", "metric");
    pass.bind(program, "u_gravity", "gravity");
    program.set("u_drop", medium.drop);
    program.set("u_flow", medium.flow);
    program.set("u_strength", medium.strength);
    program.set("u_steps", static_cast<float>(steps_per_plan));
    program.set("u_block_count", glm::ivec2(blocks_));
    program.set("u_film_size", glm::vec2(static_cast<float>(size_)));
    draw_into(pass, held_target_[now_], drop_mark_state);
    return program;
}

void BloodBlocks::mark_alive(const Pass& pass, const BloodMedium& medium, const Blood& blood) const {
    if (blood.groups.count() > 0) {
        const gl::Program& program = begin_mark(pass, medium, BloodShader::mark_of_drops, blood.drops);
        blood.groups.bind(pass, program);
        pass.draw_generated(GL_POINTS, blood.groups.count() * points_per_drop, 1);
    }
    if (expected_count_ > 0) {
        const bool energy = pass.has("energy");
        const gl::Program& program = begin_mark(
            pass, medium, energy ? BloodShader::mark_of_places_energy : BloodShader::mark_of_places,
            expected_.texture());
        if (energy) {
            pass.bind(program, "u_energy", "energy");
            bind(pass, program, "u_film", blood.film);
            program.set("u_sealed", medium.sealed_energy);
        }
        pass.draw_generated(GL_POINTS, expected_count_ * points_per_drop, 1);
    }
}

void BloodBlocks::reach(const Pass& pass) const {
    const gl::Program& scan = use(pass, BloodShader::scan);
    bind(pass, scan, "u_blocks", held_[now_]);
    draw_into(pass, marks_target_, gl::overwrite_state);
    pass.draw_fullscreen();
    const gl::Program& program = use(pass, BloodShader::reach);
    bind(pass, program, "u_tiles", marks_);
    bind(pass, program, "u_first", first_tile_);
    bind(pass, program, "u_across", tiles_across_.texture());
    draw_into(pass, reach_target_, gl::overwrite_state);
    pass.draw_fullscreen();
}

bool BloodBlocks::plan(const Pass& pass, const BloodMedium& medium, const Blood& blood, bool for_step) {
    const bool due = looked_ || (for_step && steps_planned_ <= 0 && blood.groups.count() > 0);
    if (!due) {
        steps_planned_ -= for_step ? 1 : 0;
        return false;
    }
    mark_alive(pass, medium, blood);
    if (tiles_old_) {
        reach(pass);
        tiles_old_ = false;
    }
    const gl::Program& program = use(pass, BloodShader::near);
    bind(pass, program, "u_reach", reach_);
    bind(pass, program, "u_blocks", held_[now_]);
    bind(pass, program, "u_surface", surface_);
    draw_into(pass, near_target_, gl::overwrite_state);
    pass.draw_fullscreen();
    const gl::Program& across = use(pass, BloodShader::across);
    bind(pass, across, "u_near", near_);
    bind(pass, across, "u_reach", reach_);
    bind(pass, across, "u_first", first_pair_);
    bind(pass, across, "u_pairs", block_pairs_.texture());
    draw_into(pass, plan_target_[now_], gl::overwrite_state);
    pass.draw_fullscreen();
    steps_planned_ = steps_per_plan - (for_step ? 1 : 0);
    return std::exchange(looked_, false);
}

void BloodBlocks::look(const Pass& pass, const BloodMedium& medium, const Blood& blood, bool wake) {
    const std::size_t before = now_;
    const bool all = wake || !medium.tools.empty() || medium.flow.w > 0.0F;
    // Those to be stepped up to now have been.
    const gl::Program& note = use(pass, BloodShader::copy);
    bind(pass, note, "u_film", plan_[before]);
    draw_into(pass, stepped_target_, gl::max_blend_state);
    pass.draw_fullscreen();
    noted_ = true;
    const gl::Program& search = use(pass, BloodShader::search);
    bind_plan(pass, search);
    bind(pass, search, "u_blocks", held_[before]);
    bind(pass, search, "u_film", blood.film);
    bind(pass, search, "u_film_before", blood.film_before);
    search.set("u_still", still_mm_s * medium.flow.z);
    search.set("u_rest", medium.flow.y);
    // Of two heights h side by side one flows if h - residual > pinning - 4 h; see exchange() in
    // blood_common.glsl.
    search.set("u_stirs", std::max(medium.flow.y, 0.2F * (medium.flow.y + medium.pinning)));
    search.set("u_pinning", medium.pinning);
    search.set("u_all", all);
    // A relief pulls no more than gravity down a wall.
    const float steepest = medium.relief_pull > 0.0F ? 2.0F : 1.0F;
    search.set("u_run", static_cast<float>(steps_per_look) * medium.flow.z * medium.flow.x * medium.strength *
                            steepest);
    draw_into(pass, held_target_[1 - before], gl::overwrite_state);
    pass.draw_fullscreen();
    now_ = 1 - before;
    looked_ = tiles_old_ = true;
}

void BloodBlocks::drops_came() {
    tiles_old_ = true;
    steps_planned_ = 0;
}

void BloodBlocks::drops_end(const Pass& pass, const BloodMedium& medium, const Blood& blood,
                            const DropRange& drops) {
    const gl::Program& program = begin_mark(pass, medium, BloodShader::mark_of_drops, blood.drops);
    blood.groups.bind(pass, program, drops);
    pass.draw_generated(GL_POINTS, static_cast<int>(drops.count) * points_per_drop, 1);
    drops_came();
}

void BloodBlocks::bind_plan(const Pass& pass, const gl::Program& program) const {
    bind(pass, program, "u_plan", plan_[now_]);
}

void BloodBlocks::draw(const Pass& pass, const gl::Program& program, int first, int last) const {
    // Blocks are drawn as points, of which OpenGL leaves out those whose centre lies outside the viewport.
    // So it covers whole blocks.
    const int side = blocks_ * block_side;
    gl::apply(pass.gl(), {.program_point_size = true}, {0, 0, side, side});
    bind_plan(pass, program);
    bind(pass, program, "u_list", list_.texture());
    program.set("u_first", first);
    program.set("u_ground_rows", static_cast<float>(rows()));
    pass.draw_generated(GL_POINTS, last - first, 1);
}

std::pair<int, int> BloodBlocks::range_of(Drawn drawn) const {
    switch (drawn) {
        case Drawn::beside_no_seam:
            return {0, without_seams_};
        case Drawn::at_seams:
            return {without_seams_, with_cells_};
        case Drawn::gutters:
            return {without_seams_, stepped_blocks_};
        case Drawn::settled:
            break;
    }
    return {0, stepped_blocks_};
}

void BloodBlocks::cover(const Pass& pass, const gl::Program& program, Drawn drawn) const {
    if (drawn == Drawn::settled) {
        bind(pass, program, "u_plan_before", plan_[1 - now_]);
    }
    program.set("u_with_cells", with_cells_);
    const auto [first, last] = range_of(drawn);
    draw(pass, program, first, last);
}

void BloodBlocks::cover_changed(const Pass& pass, const gl::Program& program, bool whole,
                                bool only_seen) const {
    bind(pass, program, "u_stepped", stepped_);
    program.set("u_whole", whole);
    program.set("u_stepped_blocks", stepped_blocks_);
    draw(pass, program, only_seen ? stepped_blocks_ : 0, listed_);
}

void BloodBlocks::forget_picture(const Pass& pass) {
    clear(pass, stepped_target_, 1.0F);
    noted_ = true;
}

void BloodBlocks::end_picture(const Pass& pass) {
    if (noted_) {
        clear(pass, stepped_target_);
        noted_ = false;
    }
}

void BloodBlocks::ask(std::uint64_t tag) {
    if (answers_.in_flight() < 3) {
        answers_.start(marks_, tag);
    }
}

std::optional<std::uint64_t> BloodBlocks::all_still() {
    std::optional<std::uint64_t> still;
    while (const auto answer = answers_.poll()) {
        bool moves = false;
        for (int y = 0; y < tiles_; ++y) {
            for (int x = 0; x < tiles_; ++x) {
                moves = moves || answer->image.at(x, y, 0) > 0.5F;
            }
        }
        if (!moves) {
            still = answer->tag;
        }
    }
    return still;
}

}  // namespace viscera::tissue
