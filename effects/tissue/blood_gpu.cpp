#include "effects/tissue/blood_gpu.h"

#include <algorithm>

#include "effects/tissue/blood_programs.h"
#include "effects/tissue/gravity.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

constexpr int deposit_points = 4;
constexpr int cap_points = 5;  // as blood_cap.vert

// A new drop, whose age in alpha is 0, takes the place of what was there; what is given, with an alpha of 1,
// is added up.
constexpr gl::RasterState spawn_state{
    .blend = gl::Blend{.destination_rgb = GL_SRC_ALPHA, .destination_alpha = GL_SRC_ALPHA}};

std::array<gl::Texture, 2> pair_of(const gl::Functions& gl, int width, int height, const char* label) {
    return {gl::Texture::make_2d(gl, width, height, PixelFormat::rgba32f, label),
            gl::Texture::make_2d(gl, width, height, PixelFormat::rgba32f, label)};
}

}  // namespace

BloodGpu::BloodGpu(const gl::Functions& gl, int size, int max_drops)
    : gl_(&gl),
      size_(size),
      blocks_(gl, size),
      film_(pair_of(gl, size, size, "film of blood")),
      relief_(gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "relief of blood")),
      groups_(gl, max_drops),
      drops_(pair_of(gl, groups_.width(), groups_.height(), "drops of blood")),
      deposit_(gl::Texture::make_2d(gl, drops_[0].width(), drops_[0].height(), PixelFormat::rgba32f,
                                    "what drops leave behind")),
      ledger_(
          gl::Texture::make_2d(gl, drops_[0].width(), drops_[0].height(), PixelFormat::r32f, "blood given")),
      film_target_{target_of(gl, film_[0], relief_, "film of blood"),
                   target_of(gl, film_[1], relief_, "film of blood")},
      drops_target_{target_of(gl, drops_[0], deposit_, "drops of blood"),
                    target_of(gl, drops_[1], deposit_, "drops of blood")},
      spawn_target_{target_of(gl, drops_[0], ledger_, "new drops of blood"),
                    target_of(gl, drops_[1], ledger_, "new drops of blood")},
      relief_target_(gl, relief_, "relief of blood") {}

BloodBlocks::Blood BloodGpu::blood() const {
    return {film(), film_[1 - film_now_], drops(), groups_};
}

void BloodGpu::bind_place(const Pass& pass, const gl::Program& program, const gl::Texture& film) const {
    bind(pass, program, "u_film", film);
    jumps_->bind(pass, program);
}

void BloodGpu::set_medium(const gl::Program& program, const BloodMedium& medium) const {
    program.set("u_flow", medium.flow);
    program.set("u_drop", medium.drop);
    program.set("u_down", medium.down);
    program.set("u_strength", medium.strength);
    program.set("u_open", medium.open_edges);
    program.set("u_spreading", medium.spreading);
    program.set("u_pinning", medium.pinning);
}

void BloodGpu::set_tools(const Pass& pass, const gl::Program& program, const BloodMedium& medium) const {
    if (!medium.tools.empty()) {
        pass.bind(program, "u_position", "position");
        program.set("u_tool_count", static_cast<int>(medium.tools.size()));
        program.set("u_tool", std::span<const glm::vec4>(medium.tools));
        program.set("u_tool_power", std::span<const glm::vec2>(medium.tool_powers));
    }
}

void BloodGpu::cover_changed(const Pass& pass, const gl::Program& program, Shown before) const {
    bind(pass, program, "u_relief", relief_);
    bind(pass, program, "u_lengths", ground_.lengths());
    blocks_.cover_changed(pass, program, before == Shown::nothing);
}

void BloodGpu::take_surface(const Pass& pass, const BloodMedium& medium, bool empty) {
    const bool spill = empty && pass.has("spill");
    const gl::Program& program = use(pass, spill ? BloodShader::start_spill : BloodShader::start);
    if (spill) {
        pass.bind(program, "u_spill", "spill");
    }
    pass.bind(program, "u_metric", "metric");
    pass.bind(program, "u_position", "position");
    pass.bind(program, "u_seam", "seam");
    program.set("u_empty", empty);
    // Again into the other one, whose areas are then the new ones: nothing changes its volume twice.
    for (int i = 0; i < 2; ++i) {
        bind(pass, program, "u_film", film());
        draw_into(pass, film_target_[1 - film_now_], gl::overwrite_state);
        pass.draw_fullscreen();
        film_now_ = i == 0 ? 1 - film_now_ : film_now_;
    }
    ground_.take(pass, blocks_, film(), seams_->first_of_cell);
    jumps_->take(pass, film());
    if (empty) {
        for (const gl::Framebuffer& target : spawn_target_) {
            clear(pass, target);
            target.clear_colour(1, {0.0F, 0.0F, 0.0F, 0.0F});
        }
        blocks_.begin(pass, spill);
    }
    if (!seams_->empty) {
        const bool relief = medium.relief_pull > 0.0F;
        const gl::Program& links = use(pass, relief ? BloodShader::link_relief : BloodShader::link);
        if (relief) {
            bind_relief(pass, links, static_cast<double>(medium.relief_pull));
        }
        bind(pass, links, "u_links", seams_->links.texture());
        bind(pass, links, "u_parts", seams_->parts.texture());
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
    const Image position = gl::read_texture(*gl_, *pass.texture("position"));
    std::vector<SeamLink> links;
    std::vector<SeamJump> jumps;
    std::vector<int> gutters;
    if (pass.has("seam")) {
        const Image seam = gl::read_texture(*gl_, *pass.texture("seam"));
        links = seam_links(position, seam);
        jumps = seam_jumps(position, seam);
        gutters = seam_gutters(position, seam);
    }
    seams_.emplace(make_seams(*gl_, links, size_));
    jumps_.emplace(*gl_, gutters, size_);
    blocks_.lie_on(position, links, jumps);
}

void BloodGpu::look_at_tiles(const Pass& pass, const BloodMedium& medium, DropRing& ring, bool wake) {
    plan(pass, medium, false);  // of the last look, should no step have come since
    groups_.update(ring);
    groups_.ask(pass, ring, drops(), drops_[1 - drops_now_]);
    blocks_.look(pass, medium, blood(), wake);
}

void BloodGpu::plan(const Pass& pass, const BloodMedium& medium, bool for_step) {
    if (blocks_.plan(pass, medium, blood(), for_step)) {
        // A block that is no longer stepped must be the same in both textures, which take turns.
        const gl::Program& copy = use(pass, BloodShader::settle);
        bind(pass, copy, "u_film", film());
        film_target_[1 - film_now_].bind();
        blocks_.cover(pass, copy, BloodBlocks::Drawn::settled);
    }
}

const gl::Program& BloodGpu::use_deposit(const Pass& pass, const BloodMedium& medium, BloodShader shader,
                                         const gl::Texture& drops, const gl::Texture& areas) const {
    const gl::Program& program = use(pass, shader);
    blocks_.bind_plan(pass, program);
    bind_place(pass, program, areas);
    bind(pass, program, "u_drops", drops);
    pass.bind(program, "u_metric", "metric");
    set_medium(program, medium);
    return program;
}

void BloodGpu::deposit(const Pass& pass, const BloodMedium& medium, std::int64_t step) const {
    const gl::Program& program =
        use_deposit(pass, medium, BloodShader::deposited, drops_[1 - drops_now_], film());
    bind(pass, program, "u_deposit", deposit_);
    groups_.bind(pass, program);
    program.set("u_salt", static_cast<int>(step & 0xffffff));
    draw_into(pass, film_target_[1 - film_now_], gl::add_blend_state);
    pass.draw_generated(GL_POINTS, groups_.count() * deposit_points, 1);
}

void BloodGpu::give_up(const Pass& pass, const BloodMedium& medium, const DropRange& evicted) const {
    // Into the texture that is read next: what is added to it is owed to the film in the next step. The
    // other one, which stands for the areas here, has the same.
    const gl::Program& program =
        use_deposit(pass, medium, BloodShader::given_up, drops(), film_[1 - film_now_]);
    groups_.bind(pass, program, evicted);
    program.set("u_salt", 0);
    draw_into(pass, film_target_[film_now_], gl::add_blend_state);
    pass.draw_generated(GL_POINTS, static_cast<int>(evicted.count) * deposit_points, 1);
}

void BloodGpu::spawn(const Pass& pass, const BloodMedium& medium, std::span<const DropSpawn> spawns,
                     const DropRange& evicted) {
    if (evicted.count > 0) {
        // Blood is laid down where it is stepped.
        plan(pass, medium, false);
        blocks_.drops_end(pass, medium, blood(), evicted);
        give_up(pass, medium, evicted);
    }
    spawn_items_.clear();
    for (const DropSpawn& drop : spawns) {
        spawn_items_.emplace_back(drop.uv, drop.volume_mm3, drop.radius_mm);
        spawn_items_.emplace_back(drop.slot, drop.seed, drop.sealed_at);
    }
    spawn_.upload(*gl_, spawn_items_, "new drops of blood");
    const bool energy = pass.has("energy");
    const gl::Program& program = use(pass, energy ? BloodShader::spawned_energy : BloodShader::spawned);
    bind_place(pass, program, film());
    bind(pass, program, "u_spawn", spawn_.texture());
    pass.bind(program, "u_metric", "metric");
    if (energy) {
        pass.bind(program, "u_energy", "energy");
        program.set("u_sealed", medium.sealed_energy);
    }
    program.set("u_ring", glm::vec2(groups_.width(), groups_.height()));
    draw_into(pass, spawn_target_[drops_now_], spawn_state);
    pass.draw_generated(GL_POINTS, static_cast<int>(spawns.size()), 1);
    if (!std::ranges::all_of(spawns, &DropSpawn::expected)) {
        blocks_.drops_came();
    }
}

void BloodGpu::move_drops(const Pass& pass, const BloodMedium& medium) {
    const gl::Program& program =
        use(pass, medium.tools.empty() ? BloodShader::move : BloodShader::move_tools);
    bind_place(pass, program, film());
    blocks_.bind_plan(pass, program);
    bind(pass, program, "u_drops", drops());
    pass.bind(program, "u_gravity", "gravity");
    set_medium(program, medium);
    set_tools(pass, program, medium);
    draw_into(pass, drops_target_[1 - drops_now_], {.program_point_size = true});
    groups_.cover(pass, program);
    drops_now_ = 1 - drops_now_;
}

void BloodGpu::step_cells(const Pass& pass, const BloodMedium& medium, BloodShader shader,
                          BloodBlocks::Drawn drawn) const {
    const gl::Program& program = use(pass, shader);
    bind(pass, program, "u_film", film());
    bind(pass, program, "u_faces", ground_.faces());
    program.set("u_one", 1.0F);
    program.set("u_dries", !medium.tools.empty() || medium.flow.w > 0.0F);
    if (drawn == BloodBlocks::Drawn::at_seams) {
        bind(pass, program, "u_across", ground_.across());
        bind(pass, program, "u_pulls", seams_->pulls);
    }
    set_medium(program, medium);
    set_tools(pass, program, medium);
    blocks_.cover(pass, program, drawn);
}

void BloodGpu::step_film(const Pass& pass, const BloodMedium& medium) const {
    const bool tools = !medium.tools.empty();
    film_target_[1 - film_now_].bind();
    using Drawn = BloodBlocks::Drawn;
    step_cells(pass, medium, tools ? BloodShader::film_tools : BloodShader::film, Drawn::beside_no_seam);
    if (!seams_->empty) {
        step_cells(pass, medium, tools ? BloodShader::film_tools_seams : BloodShader::film_seams,
                   Drawn::at_seams);
        const gl::Program& gutters = use(pass, BloodShader::gutter);
        bind(pass, gutters, "u_film", film());
        bind(pass, gutters, "u_across", ground_.across());
        blocks_.cover(pass, gutters, Drawn::gutters);
    }
}

void BloodGpu::step(const Pass& pass, const BloodMedium& medium, DropRing& ring, std::int64_t step) {
    groups_.update(ring);
    const bool drops_live = groups_.count() > 0;
    plan(pass, medium, true);
    if (drops_live) {
        move_drops(pass, medium);
    }
    step_film(pass, medium);
    if (drops_live) {
        deposit(pass, medium, step);
    }
    film_now_ = 1 - film_now_;
}

void BloodGpu::begin_picture(const Pass& pass, const BloodMedium& medium, Shown before) {
    plan(pass, medium, false);
    if (before == Shown::unknown) {
        blocks_.forget_picture(pass);
    }
    if (!seams_->empty) {
        const gl::Program& gutters = use(pass, BloodShader::gutter_seen);
        bind(pass, gutters, "u_film", film_[1 - film_now_]);
        bind(pass, gutters, "u_across", ground_.across());
        relief_target_.bind();
        blocks_.cover_changed(pass, gutters, before == Shown::nothing, true);
    }
    if (groups_.count() == 0) {
        return;
    }
    const gl::Program& program = use(pass, BloodShader::cap);
    bind_place(pass, program, film());
    blocks_.bind_plan(pass, program);
    bind(pass, program, "u_drops", drops());
    pass.bind(program, "u_position", "position");
    pass.bind(program, "u_metric", "metric");
    pass.bind(program, "u_right", "flow_right");
    set_medium(program, medium);
    groups_.bind(pass, program);
    gl::RasterState state = gl::max_blend_state;
    state.program_point_size = true;
    draw_into(pass, relief_target_, state);
    pass.draw_generated(GL_POINTS, cap_points * groups_.count(), 1);
}

}  // namespace viscera::tissue
