#include "effects/tissue/blood_gpu.h"

#include <algorithm>

#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

/// Index into programs().
enum class Shader : std::size_t {
    start,
    start_spill,
    link,
    film,
    film_seams,
    film_tools,
    film_tools_seams,
    move,
    move_tools,
    deposited,
    spawned,
    spawned_energy,
    counted,
    counted_energy,
    scan,
    search,
    reach,
    plan,
    mark_of_drops,
    mark_of_seams,
    settle,
    note,
    relief,
    relief_changed,
    cap,
};

constexpr int tile_side = 32;
constexpr int block_side = 8;  // divides a tile's
constexpr int ring_width = 256;
constexpr int deposit_points = 4;
constexpr int ledger_width = 1024;
// Marks are points as large as what they mark.
constexpr gl::RasterState mark_state = [] {
    gl::RasterState state = gl::max_blend_state;
    state.program_point_size = true;
    return state;
}();
// Drops mark where blood is, not where it was found.
constexpr gl::RasterState held_mark_state = [] {
    gl::RasterState state = mark_state;
    state.colour_mask = {true, false, false, false};
    return state;
}();
// A film that creeps more slowly stands [mm/s].
constexpr float still_mm_s = 5e-4F;

std::array<gl::Texture, 2> pair_of(const gl::Functions& gl, int width, int height, PixelFormat format,
                                   const char* label) {
    return {gl::Texture::make_2d(gl, width, height, format, label),
            gl::Texture::make_2d(gl, width, height, format, label)};
}

std::array<gl::Framebuffer, 2> targets_of(const gl::Functions& gl, const std::array<gl::Texture, 2>& textures,
                                          const char* label) {
    return {gl::Framebuffer(gl, textures[0], label), gl::Framebuffer(gl, textures[1], label)};
}

gl::Framebuffer with_deposit(const gl::Functions& gl, const gl::Texture& drops, const gl::Texture& deposit) {
    const std::array<const gl::Texture*, 2> colours{&drops, &deposit};
    return {gl, colours, nullptr, "drops of blood"};
}

const gl::Program& use(const Pass& pass, Shader shader) {
    return pass.use(static_cast<std::size_t>(shader));
}

void draw_into(const Pass& pass, const gl::Framebuffer& target, const gl::RasterState& state) {
    target.bind();
    gl::apply(pass.gl(), state, {0, 0, target.width(), target.height()});
}

void clear(const Pass& pass, const gl::Framebuffer& target, float value = 0.0F) {
    draw_into(pass, target, gl::overwrite_state);
    target.clear_colour(0, {value, value, value, value});
}

void bind(const Pass& pass, const gl::Program& program, std::string_view uniform,
          const gl::Texture& texture) {
    pass.bind(program, uniform, texture, gl::Filter::nearest);
}

}  // namespace

std::vector<ProgramDesc> BloodGpu::programs() {
    const char* whole = "common/fullscreen.vert";
    const char* tile = "tissue/blood_tile.vert";
    return {{whole, "tissue/blood_start.frag", {}},
            {whole, "tissue/blood_start.frag", {"SPILL"}},
            {whole, "tissue/blood_link.frag", {}},
            {tile, "tissue/blood_film.frag", {}},
            {tile, "tissue/blood_film.frag", {"SEAMS"}},
            {tile, "tissue/blood_film.frag", {"TOOLS"}},
            {tile, "tissue/blood_film.frag", {"TOOLS", "SEAMS"}},
            {whole, "tissue/blood_move.frag", {}},
            {whole, "tissue/blood_move.frag", {"TOOLS"}},
            {"tissue/blood_deposit.vert", "tissue/blood_add.frag", {}},
            {"tissue/blood_spawn.vert", "tissue/blood_spawn.frag", {}},
            {"tissue/blood_spawn.vert", "tissue/blood_spawn.frag", {"ENERGY"}},
            {"tissue/blood_spawn.vert", "tissue/blood_spawn.frag", {"LEDGER"}},
            {"tissue/blood_spawn.vert", "tissue/blood_spawn.frag", {"LEDGER", "ENERGY"}},
            {whole, "tissue/blood_scan.frag", {}},
            {whole, "tissue/blood_search.frag", {}},
            {whole, "tissue/blood_reach.frag", {}},
            {whole, "tissue/blood_plan.frag", {}},
            {"tissue/blood_mark.vert", "tissue/blood_mark.frag", {}},
            {"tissue/blood_mark.vert", "tissue/blood_mark.frag", {"SEAMS"}},
            {tile, "tissue/blood_copy.frag", {"SETTLED"}},
            {whole, "tissue/blood_copy.frag", {}},
            {whole, "tissue/blood_relief.frag", {}},
            {tile, "tissue/blood_relief.frag", {"CHANGED"}},
            {"tissue/blood_cap.vert", "tissue/blood_cap.frag", {}}};
}

BloodGpu::BloodGpu(const gl::Functions& gl, int size, int max_drops)
    : gl_(&gl),
      size_(size),
      tiles_((size + tile_side - 1) / tile_side),
      blocks_((size + block_side - 1) / block_side),
      film_(pair_of(gl, size, size, PixelFormat::rgba32f, "film of blood")),
      drops_(pair_of(gl, ring_width, (max_drops + ring_width - 1) / ring_width, PixelFormat::rgba32f,
                     "drops of blood")),
      deposit_(gl::Texture::make_2d(gl, drops_[0].width(), drops_[0].height(), PixelFormat::rgba32f,
                                    "what drops leave behind")),
      marks_(pair_of(gl, tiles_, tiles_, PixelFormat::rg8, "tiles of blood")),
      across_(pair_of(gl, tiles_, tiles_, PixelFormat::r8, "tiles of blood across seams")),
      reach_(gl::Texture::make_2d(gl, tiles_, tiles_, PixelFormat::rg8, "tiles in reach of blood")),
      held_(pair_of(gl, blocks_, blocks_, PixelFormat::rgba8, "blocks of blood")),
      beyond_(gl::Texture::make_2d(gl, blocks_, blocks_, PixelFormat::r8, "blocks of blood across seams")),
      plan_(pair_of(gl, blocks_, blocks_, PixelFormat::rg8, "blocks to be stepped")),
      stepped_(gl::Texture::make_2d(gl, blocks_, blocks_, PixelFormat::r8, "blocks stepped")),
      relief_(gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "relief of blood")),
      ledger_(gl::Texture::make_2d(gl, ledger_width, 1, PixelFormat::r32f, "blood given")),
      film_target_(targets_of(gl, film_, "film of blood")),
      drops_target_{with_deposit(gl, drops_[0], deposit_), with_deposit(gl, drops_[1], deposit_)},
      drops_alone_(targets_of(gl, drops_, "drops of blood")),
      marks_target_(targets_of(gl, marks_, "tiles of blood")),
      across_target_(targets_of(gl, across_, "tiles of blood across seams")),
      held_target_(targets_of(gl, held_, "blocks of blood")),
      reach_target_(gl, reach_, "tiles in reach of blood"),
      beyond_target_(gl, beyond_, "blocks of blood across seams"),
      plan_target_(targets_of(gl, plan_, "blocks to be stepped")),
      stepped_target_(gl, stepped_, "blocks stepped"),
      relief_target_(gl, relief_, "relief of blood"),
      ledger_target_(gl, ledger_, "blood given"),
      tile_answers_(gl) {}

std::int64_t BloodGpu::capacity() const {
    return static_cast<std::int64_t>(ring_width) * drops_[0].height();
}

void BloodGpu::bind_place(const Pass& pass, const gl::Program& program) const {
    bind(pass, program, "u_film", film());
    pass.bind(program, "u_right", "flow_right");
}

void BloodGpu::set_medium(const gl::Program& program, const BloodMedium& medium) const {
    program.set("u_flow", medium.flow);
    program.set("u_drop", medium.drop);
    program.set("u_down", medium.down);
    program.set("u_strength", medium.strength);
    program.set("u_open", medium.open_edges);
    program.set("u_spreading", medium.spreading);
}

void BloodGpu::set_tools(const Pass& pass, const gl::Program& program, const BloodMedium& medium) const {
    if (!medium.tools.empty()) {
        pass.bind(program, "u_position", "position");
        program.set("u_tool_count", static_cast<int>(medium.tools.size()));
        program.set("u_tool", std::span<const glm::vec4>(medium.tools));
        program.set("u_tool_power", std::span<const glm::vec2>(medium.tool_powers));
    }
}

void BloodGpu::cover_tiles(const Pass& pass, const gl::Program& program) const {
    bind(pass, program, "u_plan", plan_[marks_now_]);
    program.set("u_size", glm::vec2(static_cast<float>(size_)));
    pass.draw_generated(GL_POINTS, blocks_ * blocks_, 1);
}

void BloodGpu::cover_changed(const Pass& pass, const gl::Program& program, Shown before) const {
    bind(pass, program, "u_stepped", stepped_);
    program.set("u_whole", before == Shown::nothing);
    cover_tiles(pass, program);
}

void BloodGpu::end_picture(const Pass& pass) const {
    clear(pass, stepped_target_);
}

void BloodGpu::take_surface(const Pass& pass, const BloodMedium& medium, bool empty) {
    const bool spill = empty && pass.has("spill");
    const gl::Program& program = use(pass, spill ? Shader::start_spill : Shader::start);
    if (spill) {
        pass.bind(program, "u_spill", "spill");
    }
    pass.bind(program, "u_metric", "metric");
    pass.bind(program, "u_position", "position");
    pass.bind(program, "u_seam", "seam");
    bind(pass, program, "u_film", film());
    program.set("u_empty", empty);
    draw_into(pass, film_target_[1 - film_now_], gl::overwrite_state);
    pass.draw_fullscreen();
    film_now_ = 1 - film_now_;
    relief_known_ = false;
    // Again into the other one, whose areas are now the new ones: nothing changes its volume twice.
    bind(pass, program, "u_film", film());
    draw_into(pass, film_target_[1 - film_now_], gl::overwrite_state);
    pass.draw_fullscreen();
    if (empty) {
        for (std::size_t i = 0; i < 2; ++i) {
            clear(pass, drops_alone_[i]);
            clear(pass, marks_target_[i], spill ? 1.0F : 0.0F);
            clear(pass, across_target_[i]);
            draw_into(pass, held_target_[i], gl::overwrite_state);
            held_target_[i].clear_colour(0, {spill ? 1.0F : 0.0F, 0.0F, 0.0F, 0.0F});
            clear(pass, plan_target_[i], spill ? 1.0F : 0.0F);
        }
        clear(pass, reach_target_, spill ? 1.0F : 0.0F);
        clear(pass, beyond_target_);
        clear(pass, stepped_target_);
        clear(pass, ledger_target_);
    }
    if (!seams_->empty()) {
        const gl::Program& links = use(pass, Shader::link);
        bind(pass, links, "u_links", seams_->links.texture());
        pass.bind(links, "u_position", "position");
        pass.bind(links, "u_normal", "normal");
        pass.bind(links, "u_metric", "metric");
        bind(pass, links, "u_film", film());
        pass.bind(links, "u_gravity", "gravity");
        set_medium(links, medium);
        draw_into(pass, seams_->pulls_target, gl::overwrite_state);
        pass.draw_fullscreen();
    }
}

void BloodGpu::find_seams(const Pass& pass) {
    std::vector<SeamLink> links;
    std::vector<SeamJump> jumps;
    if (pass.has("seam")) {
        const Image position = gl::read_texture(*gl_, *pass.texture("position"));
        const Image seam = gl::read_texture(*gl_, *pass.texture("seam"));
        links = seam_links(position, seam);
        jumps = seam_jumps(position, seam);
    }
    seams_.emplace(make_seams(*gl_, links, jumps, size_, tile_side, block_side));
}

void BloodGpu::mark_drops(const Pass& pass, const BloodMedium& medium, const DropRange& range,
                          bool blockwise) const {
    const gl::Program& program = use(pass, Shader::mark_of_drops);
    bind(pass, program, "u_drops", drops());
    pass.bind(program, "u_metric", "metric");
    program.set("u_drop", medium.drop);
    program.set("u_first", static_cast<int>(range.first % capacity()));
    program.set("u_tile_count", glm::ivec2(blockwise ? blocks_ : tiles_));
    program.set("u_film_size", glm::vec2(static_cast<float>(size_)));
    program.set("u_blockwise", blockwise);
    draw_into(pass, blockwise ? held_target_[marks_now_] : marks_target_[marks_now_],
              blockwise ? held_mark_state : mark_state);
    pass.draw_generated(GL_POINTS, static_cast<int>(range.count), 1);
}

void BloodGpu::mark_pairs(const Pass& pass, const SeamPairs& pairs, const gl::Texture& marked,
                          const gl::Framebuffer& target) const {
    const gl::Program& program = use(pass, Shader::mark_of_seams);
    bind(pass, program, "u_pairs", pairs.list.texture());
    bind(pass, program, "u_marked", marked);
    draw_into(pass, target, mark_state);
    pass.draw_generated(GL_POINTS, pairs.count, 1);
}

void BloodGpu::reach_from_tiles(const Pass& pass) const {
    if (!seams_->empty()) {
        mark_pairs(pass, seams_->tiles, marks_[marks_now_], across_target_[marks_now_]);
    }
    const gl::Program& program = use(pass, Shader::reach);
    bind(pass, program, "u_tiles", marks_[marks_now_]);
    bind(pass, program, "u_across", across_[marks_now_]);
    draw_into(pass, reach_target_, gl::overwrite_state);
    pass.draw_fullscreen();
}

/// Those to be stepped up to now have been.
void BloodGpu::note_stepped(const Pass& pass) const {
    const gl::Program& program = use(pass, Shader::note);
    bind(pass, program, "u_film", plan_[marks_now_]);
    draw_into(pass, stepped_target_, gl::max_blend_state);
    pass.draw_fullscreen();
}

void BloodGpu::plan(const Pass& pass, const BloodMedium& medium, const DropRange& alive) const {
    if (alive.count > 0) {
        mark_drops(pass, medium, alive, true);
    }
    if (!seams_->empty()) {
        mark_pairs(pass, seams_->blocks, held_[marks_now_], beyond_target_);
    }
    const gl::Program& program = use(pass, Shader::plan);
    bind(pass, program, "u_reach", reach_);
    bind(pass, program, "u_blocks", held_[marks_now_]);
    bind(pass, program, "u_beyond", beyond_);
    draw_into(pass, plan_target_[marks_now_], gl::overwrite_state);
    pass.draw_fullscreen();
}

void BloodGpu::look_at_tiles(const Pass& pass, const BloodMedium& medium, const DropRange& alive, bool wake) {
    const std::size_t before = marks_now_;
    const bool all = wake || !medium.tools.empty() || medium.flow.w > 0.0F;
    note_stepped(pass);
    const gl::Program& search = use(pass, Shader::search);
    bind(pass, search, "u_plan", plan_[before]);
    bind(pass, search, "u_blocks", held_[before]);
    bind(pass, search, "u_film", film());
    bind(pass, search, "u_film_before", film_[1 - film_now_]);
    search.set("u_still", still_mm_s * medium.flow.z);
    search.set("u_rest", medium.flow.y);
    search.set("u_all", all);
    search.set("u_wake", wake);
    draw_into(pass, held_target_[1 - before], gl::overwrite_state);
    pass.draw_fullscreen();
    const gl::Program& scan = use(pass, Shader::scan);
    bind(pass, scan, "u_tiles", marks_[before]);
    bind(pass, scan, "u_reach", reach_);
    bind(pass, scan, "u_blocks", held_[1 - before]);
    scan.set("u_all", all);
    draw_into(pass, marks_target_[1 - before], gl::overwrite_state);
    pass.draw_fullscreen();
    marks_now_ = 1 - before;
    clear(pass, across_target_[marks_now_]);
    clear(pass, beyond_target_);
    if (alive.count > 0) {
        mark_drops(pass, medium, alive, false);
    }
    reach_from_tiles(pass);
    plan(pass, medium, alive);

    // A block that is no longer stepped must be the same in both textures, which take turns.
    const gl::Program& copy = use(pass, Shader::settle);
    bind(pass, copy, "u_plan_before", plan_[before]);
    bind(pass, copy, "u_film", film());
    draw_into(pass, film_target_[1 - film_now_], cover_state);
    cover_tiles(pass, copy);
}

void BloodGpu::deposit(const Pass& pass, const BloodMedium& medium, const DropRange& range,
                       const gl::Texture& source, bool whole, std::int64_t step) const {
    const gl::Program& program = use(pass, Shader::deposited);
    bind_place(pass, program);
    bind(pass, program, "u_deposit", source);
    pass.bind(program, "u_metric", "metric");
    set_medium(program, medium);
    program.set("u_first", static_cast<int>(range.first % capacity()));
    program.set("u_salt", static_cast<int>(step & 0xffffff));
    program.set("u_whole", whole);
    pass.draw_generated(GL_POINTS, static_cast<int>(range.count) * deposit_points, 1);
}

void BloodGpu::spawn(const Pass& pass, const BloodMedium& medium, std::span<const DropSpawn> spawns,
                     const DropRange& evicted) {
    if (evicted.count > 0) {
        mark_drops(pass, medium, evicted, true);
        // Into the texture that is read next: what is added to it is owed to the film in the next step. The
        // other one, which stands for the areas here, has the same.
        const gl::Texture& areas = film_[1 - film_now_];
        const gl::Program& program = use(pass, Shader::deposited);
        pass.bind(program, "u_right", "flow_right");
        bind(pass, program, "u_film", areas);
        bind(pass, program, "u_deposit", drops());
        pass.bind(program, "u_metric", "metric");
        set_medium(program, medium);
        program.set("u_first", static_cast<int>(evicted.first % capacity()));
        program.set("u_salt", 0);
        program.set("u_whole", true);
        draw_into(pass, film_target_[film_now_], gl::add_blend_state);
        pass.draw_generated(GL_POINTS, static_cast<int>(evicted.count) * deposit_points, 1);
    }
    spawn_items_.clear();
    for (const DropSpawn& drop : spawns) {
        spawn_items_.emplace_back(drop.uv, drop.volume_mm3, drop.radius_mm);
        spawn_items_.emplace_back(drop.slot, drop.seed, drop.sealed_at);
    }
    spawn_.upload(*gl_, spawn_items_, "new drops of blood");
    const bool energy = pass.has("energy");
    for (const bool counts : {false, true}) {
        const gl::Program& program = use(pass, counts ? (energy ? Shader::counted_energy : Shader::counted)
                                                      : (energy ? Shader::spawned_energy : Shader::spawned));
        bind_place(pass, program);
        bind(pass, program, "u_spawn", spawn_.texture());
        pass.bind(program, "u_metric", "metric");
        if (energy) {
            pass.bind(program, "u_energy", "energy");
            program.set("u_sealed", medium.sealed_energy);
        }
        program.set("u_ring",
                    counts ? glm::ivec2(ledger_width, 1) : glm::ivec2(drops_[0].width(), drops_[0].height()));
        draw_into(pass, counts ? ledger_target_ : drops_alone_[drops_now_],
                  counts ? gl::add_blend_state : gl::overwrite_state);
        pass.draw_generated(GL_POINTS, static_cast<int>(spawns.size()), 1);
    }
    mark_drops(pass, medium,
               {static_cast<std::int64_t>(spawns[0].slot), static_cast<std::int64_t>(spawns.size())}, false);
    reach_from_tiles(pass);
}

void BloodGpu::draw_rows(const Pass& pass, const DropRange& range) const {
    const std::int64_t first_row = range.first % capacity() / ring_width;
    const std::int64_t last_row = (range.first + range.count - 1) % capacity() / ring_width;
    const std::int64_t rows = drops_[0].height();
    const auto band = [&](std::int64_t from, std::int64_t to) {
        gl::RasterState state = gl::overwrite_state;
        state.scissor = gl::Rect{0, static_cast<int>(from), ring_width, static_cast<int>(to - from)};
        gl::apply(pass.gl(), state, {0, 0, ring_width, static_cast<int>(rows)});
        pass.draw_fullscreen();
    };
    if (range.count >= capacity() - ring_width) {
        band(0, rows);
    } else if (first_row <= last_row) {
        band(first_row, last_row + 1);
    } else {
        band(first_row, rows);
        band(0, last_row + 1);
    }
}

void BloodGpu::step(const Pass& pass, const BloodMedium& medium, const DropRange& alive, std::int64_t step) {
    const bool tools = !medium.tools.empty();
    const std::size_t next = 1 - film_now_;
    if (alive.count > 0) {
        plan(pass, medium, alive);
        const gl::Program& program = use(pass, tools ? Shader::move_tools : Shader::move);
        bind_place(pass, program);
        bind(pass, program, "u_drops", drops());
        pass.bind(program, "u_gravity", "gravity");
        set_medium(program, medium);
        set_tools(pass, program, medium);
        drops_target_[1 - drops_now_].bind();
        draw_rows(pass, alive);
        drops_now_ = 1 - drops_now_;
    }
    const bool seams = !seams_->empty();
    const gl::Program& program = use(pass, tools ? (seams ? Shader::film_tools_seams : Shader::film_tools)
                                                 : (seams ? Shader::film_seams : Shader::film));
    bind_place(pass, program);
    pass.bind(program, "u_top", "flow_top");
    program.set("u_one", 1.0F);
    program.set("u_dries", tools || medium.flow.w > 0.0F);
    if (seams) {
        bind(pass, program, "u_seam_parts", seams_->first);
        bind(pass, program, "u_pulls", seams_->pulls);
    }
    set_medium(program, medium);
    set_tools(pass, program, medium);
    draw_into(pass, film_target_[next], cover_state);
    cover_tiles(pass, program);
    if (alive.count > 0) {
        draw_into(pass, film_target_[next], gl::add_blend_state);
        deposit(pass, medium, alive, deposit_, false, step);
    }
    film_now_ = next;
}

void BloodGpu::begin_picture(const Pass& pass, const BloodMedium& medium, const DropRange& alive,
                             Shown before) {
    if (before == Shown::unknown) {
        clear(pass, stepped_target_, 1.0F);
    }
    const gl::Program& relief = use(pass, relief_known_ ? Shader::relief_changed : Shader::relief);
    bind(pass, relief, "u_film", film());
    draw_into(pass, relief_target_, cover_state);
    if (relief_known_) {
        cover_changed(pass, relief, before);
    } else {
        pass.draw_fullscreen();
    }
    relief_known_ = true;
    if (alive.count <= 0) {
        return;
    }
    const gl::Program& program = use(pass, Shader::cap);
    bind_place(pass, program);
    bind(pass, program, "u_drops", drops());
    bind(pass, program, "u_plan", plan_[marks_now_]);
    pass.bind(program, "u_position", "position");
    pass.bind(program, "u_metric", "metric");
    set_medium(program, medium);
    program.set("u_first", static_cast<int>(alive.first % capacity()));
    draw_into(pass, relief_target_, gl::max_blend_state);
    pass.draw_generated(GL_TRIANGLE_STRIP, 4, static_cast<int>(2 * alive.count));
}

void BloodGpu::ask_tiles(std::uint64_t tag) {
    if (tile_answers_.in_flight() < 3) {
        tile_answers_.start(marks_[marks_now_], tag);
    }
}

std::optional<std::uint64_t> BloodGpu::all_still() {
    std::optional<std::uint64_t> still;
    while (const auto answer = tile_answers_.poll()) {
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
