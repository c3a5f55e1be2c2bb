#include "effects/tissue/blood_effect.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "effects/tissue/baked_surface.h"
#include "effects/tissue/blood_programs.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/core/mesh_adjacency.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

// A gap between frames of more than this is not made up for.
constexpr double longest_gap_s = 0.5;
constexpr double smallest_drop_share = 0.02;
constexpr double latest_s = 1.0e9;
// Half a second or so, in which nobody misses what is not saved.
constexpr std::uint64_t looks_per_question = 8;

std::int64_t step_at(double time_s, double steps_per_s) {
    // A frame's time that should lie on the grid may miss it by its own rounding.
    const double clamped = std::isfinite(time_s) ? std::clamp(time_s, -latest_s, latest_s) : 0.0;
    return static_cast<std::int64_t>(std::floor(clamped * steps_per_s + 1e-6 * (1.0 + std::abs(clamped))));
}

/// A name that a port reads, with a default target of the same name.
Port read(const char* name, const char* target, const char* doc, bool optional = false) {
    return {.name = name, .access = Access::read, .target = target, .doc = doc, .optional = optional};
}

}  // namespace

BloodEffect::BloodEffect() : programs_(blood_programs()) {
    programs_.push_back({"tissue/blood_tile.vert", "tissue/blood_look.frag", {"CHANGED"}});
}

BloodEffect::~BloodEffect() = default;

void BloodEffect::validate() const {
    if (params_.wounds.size() > most_wounds) {
        throw Error(ErrorCode::scene, "/wounds", "has more than 65536 wounds");
    }
    if (params_.tools.size() > most_tools) {
        throw Error(ErrorCode::scene, "/tools", "has more than 16 tools");
    }
}

std::vector<Port> BloodEffect::ports() const {
    const SizeRule size{.width = params_.size, .height = params_.size};
    return {
        read_bake("position"),
        read_bake("normal"),
        read_bake("metric"),
        read_bake("seam"),
        read("gravity", "tissue.gravity", "Of tissue.gravity."),
        read("flow_right", "tissue.flow_right", "Of tissue.gravity."),
        read("flow_top", "tissue.flow_top", "Of tissue.gravity."),
        read_relief(),
        read("energy", "tissue.energy", "Where tissue is coagulated, wounds do not bleed.", true),
        read("spill", "tissue.blood_spill", "Thickness [mm] of blood that lies there at the start.", true),
        {.name = "height",
         .access = Access::write,
         .target = "tissue.blood_height",
         .doc = "Thickness of the blood [mm].",
         .format = PixelFormat::r16f,
         .size = size},
        {.name = "colour",
         .access = Access::write,
         .target = "tissue.blood_color",
         .doc = "What the tissue's colour is multiplied by; alpha: how much blood covers it.",
         .format = PixelFormat::rgba16f,
         .size = size,
         .clear = {1.0F, 1.0F, 1.0F, 0.0F},
         .optional = true},
        {.name = "normal_map",
         .access = Access::write,
         .target = "tissue.blood_normal",
         .doc = "Normal of the blood's surface: -x/z and -y/z are its slopes [mm/mm] along u and v.",
         .format = PixelFormat::rgba16f,
         .size = size,
         .clear = {0.0F, 0.0F, 1.0F, 1.0F},
         .optional = true}};
}

void BloodEffect::check_sizes(const Prepare& prepare) const {
    for (const char* port : {"position", "gravity"}) {
        if (prepare.size(port) != prepare.size("height")) {
            throw Error(ErrorCode::scene, "/size",
                        "differs from the size of '" + std::string(port) + "', which the pass reads");
        }
    }
}

/// Whether the bake is of the mesh that the parameters name, and what its flow was made by.
void BloodEffect::check_inputs(Prepare& prepare) {
    check_mesh(prepare, "tissue.blood", mesh_->key(), params_.mesh.file.path.native());
    flow_ = *flow_over(prepare.assets(), prepare.subject("position"));
    if (!flow_.known) {
        prepare.log().fault("tissue.no_flow",
                            "no tissue.gravity reads the bake that tissue.blood reads: blood stops at seams");
    }
    if (flow_.relief_pull > 0.0 && !prepare.has("relief")) {
        prepare.log().fault("tissue.no_relief",
                            "tissue.gravity reads a relief and tissue.blood does not: blood stops at seams");
        flow_.relief_pull = 0.0;
    }
}

Work BloodEffect::prepare(Prepare& prepare) {
    if (!prepare.has("position") || !prepare.has("gravity") || !prepare.has("flow_right")) {
        return Work::idle("there is no surface");
    }
    if (!state_ || parameters_key_ != prepare.parameters_key()) {
        check_sizes(prepare);
        parameters_key_ = prepare.parameters_key();
        mesh_ = SurfaceMesh::load(prepare.assets(), params_.mesh);
        to_world_ = placement_matrix(params_.mesh.placement, mesh_->centre());
        state_ = BloodState::find(prepare.assets(), params_.state);
        const std::uint64_t shape =
            Hash().add(params_.size).add(params_.liquid.max_drops).add(mesh_->key()).value();
        if (state_->shape_key != shape) {
            state_->shape_key = shape;
            state_->surface_ends = find_adjacency(mesh_->data().indices, mesh_->places()).open_edges > 0;
            state_->begun = false;
        }
    }
    const Frame& frame = prepare.frame();
    mesh_->move(frame.values, params_.mesh.host_positions, prepare.log());
    check_inputs(prepare);
    surface_key_ = Hash().add(mesh_->shape_key()).add(to_world_).add(flow_.key()).value();
    bleeding_.collect(params_, frame.values, prepare.log());
    bleeding_.lie_on(mesh_, to_world_, surface_key_);
    collect_tools(params_, frame.values, prepare.log(), tools_);

    BloodState& state = *state_;
    const double rate = params_.liquid.steps_per_s;
    target_step_ = step_at(frame.time_s, rate);
    if (!state.begun || target_step_ < state.step || state.steps_per_s != rate) {
        state.begin_anew(target_step_, rate);
        state.bled = state.moving = prepare.has("spill");
    }
    take_liquid();
    const double first = static_cast<double>(std::max(state.step, target_step_ - longest_gap())) / rate;
    const double last = static_cast<double>(target_step_) / rate;
    const bool runs = bleeding_.bleeds(first, last);
    state.jets_bleed = bleeding_.sends_jets(first, last);
    state.there = state.bled || runs;
    if (!state.there) {
        state.step = target_step_;
        return Work::idle("there is no blood");
    }
    source_key_ = Hash()
                      .add(bleeding_.key(first, last))
                      .add(runs ? prepare.content("energy") : 0)
                      .add(params_.sealed_energy)
                      .value();
    const bool sealed = runs && !state.moving && state.sealed_key == source_key_;
    const bool disturbed = state.moving || state.woken || (runs && !sealed) || tools_work(first, last) ||
                           state.tool_count > 0 || surface_key_ != state.surface_key;
    if (!disturbed) {
        let_time_pass(sealed, prepare.log());
    }
    if (last > first) {
        state.sealed = sealed && !disturbed;
    }
    const bool steps = target_step_ > state.step;
    const std::uint64_t key =
        Hash().add(parameters_key_).add(state.version + (steps ? 1 : 0)).add(surface_key_).value();
    return disturbed ? Work::go_on(key) : Work::rest("all blood stands still", key);
}

/// Steps in which the GPU has nothing to do. Wounds that are sealed go on dripping nothing, so that others
/// find them as if they had been watched.
void BloodEffect::let_time_pass(bool sealed, Log& log) {
    BloodState& state = *state_;
    if (sealed) {
        bleeding_.find_places(state, log);
        for (state.step = std::max(state.step, target_step_ - longest_gap()); state.step < target_step_;
             ++state.step) {
            bleeding_.step(state, gravity_mm_s2(), log, spawns_);
            const auto most = static_cast<std::size_t>(state.gpu->capacity());
            for (std::size_t first = 0; first < spawns_.size(); first += most) {
                const std::size_t count = std::min(most, spawns_.size() - first);
                (void)state.ring.add(static_cast<std::int64_t>(count), state.gpu->capacity());
            }
        }
        state.moving = false;
        // The next step looks, whenever that is.
        state.steps_since_look = BloodBlocks::steps_per_look;
    }
    state.step = target_step_;
}

std::int64_t BloodEffect::longest_gap() const {
    return std::max(static_cast<std::int64_t>(longest_gap_s * params_.liquid.steps_per_s), std::int64_t{1});
}

/// Blood that rests would not notice that it is another liquid now.
void BloodEffect::take_liquid() {
    const std::uint64_t key = params_.liquid.key();
    // Of two passes that call it differently each is heard once.
    if (std::exchange(liquid_key_, key) != key && state_->liquid_key != key) {
        state_->liquid_key = key;
        state_->woken = state_->bled;
    }
}

bool BloodEffect::tools_work(double from_s, double to_s) const {
    return to_s > from_s && std::ranges::any_of(tools_, [&](const CleanerParams& tool) {
               return tool.rate > 0.0 && tool.start_s < to_s && tool.stop_s > from_s;
           });
}

void BloodEffect::set_medium() {
    const LiquidParams& liquid = params_.liquid;
    const double drop = liquid.drop_mm3;
    medium_.flow = glm::vec4(liquid.mobility_per_mm_s(), liquid.residual_mm, 1.0 / liquid.steps_per_s,
                             liquid.drying_mm_s);
    medium_.drop =
        glm::vec4(liquid.drop_aspect, liquid.trail_mm, liquid.drop_life_s, smallest_drop_share * drop);
    medium_.down = glm::vec3(flow_.gravity.down);
    medium_.strength = static_cast<float>(flow_.gravity.strength);
    medium_.spreading = static_cast<float>(flow_.spreading);
    medium_.relief_pull = static_cast<float>(flow_.relief_pull);
    medium_.pinning = static_cast<float>(liquid.pinning_mm);
    // Where a closed surface seems to end its charts touch the texture's border, or map it badly.
    medium_.open_edges = flow_.open_edges && state_->surface_ends;
    medium_.sealed_energy = static_cast<float>(params_.sealed_energy);
}

void BloodEffect::set_tools(std::int64_t step) {
    medium_.tools.clear();
    medium_.tool_powers.clear();
    const double time = (static_cast<double>(step) + 0.5) / params_.liquid.steps_per_s;
    for (const CleanerParams& tool : tools_) {
        if (tool.rate > 0.0 && time >= tool.start_s && time < tool.stop_s) {
            medium_.tools.emplace_back(glm::vec3(tool.position_mm), static_cast<float>(tool.radius_mm));
            medium_.tool_powers.push_back(tool_power(tool, 1.0 / params_.liquid.steps_per_s));
        }
    }
}

void BloodEffect::update_surface(const Pass& pass) {
    BloodState& state = *state_;
    if (state.surface_key == surface_key_) {
        return;
    }
    const bool empty = state.surface_key == 0;
    if (empty) {
        state.expected.clear();
    }
    state.surface_key = surface_key_;
    if (state.seam_key != mesh_->key()) {
        state.seam_key = mesh_->key();
        state.gpu->find_seams(pass);
    }
    state.gpu->take_surface(pass, medium_, empty);
    state.woken = state.bled;
}

void BloodEffect::wake(const Pass& pass) {
    BloodState& state = *state_;
    state.woken = false;
    look(pass, true);
    state.stir();
}

void BloodEffect::look(const Pass& pass, bool wake) {
    BloodState& state = *state_;
    bleeding_.expect_drops(state, BloodBlocks::steps_per_look, pass.has("energy"));
    state.gpu->expect(state.expected.places());
    state.gpu->look_at_tiles(pass, medium_, state.ring, wake);
    state.looked_at = state.step;
    state.steps_since_look = 0;
    ++state.looks;
}

glm::dvec3 BloodEffect::gravity_mm_s2() const {
    return flow_.gravity.down * (flow_.gravity.strength * standard_gravity_m_s2 * 1000.0);
}

void BloodEffect::spawn(const Pass& pass) {
    BloodState& state = *state_;
    const std::int64_t capacity = state.gpu->capacity();
    // More than the ring holds come in turns, each of which becomes film for the next.
    const std::size_t most = static_cast<std::size_t>(capacity);
    for (std::size_t first = 0; first < spawns_.size(); first += most) {
        const std::span<DropSpawn> drops =
            std::span(spawns_).subspan(first, std::min(most, spawns_.size() - first));
        const std::int64_t head = state.ring.head();
        const DropRange evicted = state.ring.add(static_cast<std::int64_t>(drops.size()), capacity);
        for (std::size_t i = 0; i < drops.size(); ++i) {
            drops[i].slot = static_cast<float>((head + static_cast<std::int64_t>(i)) % capacity);
        }
        state.gpu->spawn(pass, medium_, drops, evicted);
        state.bled = state.moving = true;
        // Whether any comes of those that the last look foresaw is what the answer to it says.
        if (!std::ranges::all_of(drops, &DropSpawn::foreseen)) {
            state.stir();
        }
    }
}

void BloodEffect::run_step(const Pass& pass) {
    BloodState& state = *state_;
    const std::int64_t step = state.step;
    set_tools(step);
    bleeding_.step(state, gravity_mm_s2(), pass.log(), spawns_);
    // Two looks without a step between them would find that nothing has changed.
    // Gaps between frames may leave out steps at which a look is due.
    const bool due = step != state.looked_at && (step % BloodBlocks::steps_per_look == 0 ||
                                                 state.steps_since_look >= BloodBlocks::steps_per_look);
    if (due || medium_.tools.size() != state.tool_count) {
        look(pass, !medium_.tools.empty());
    }
    if (!medium_.tools.empty() || state.tool_count != 0) {
        state.stir();
    }
    state.tool_count = medium_.tools.size();
    spawn(pass);
    state.gpu->step(pass, medium_, state.ring, step);
    ++state.step;
    ++state.steps_since_look;
}

void BloodEffect::draw(const Pass& pass) {
    BloodState& state = *state_;
    if (!state.gpu || state.gpu_shape_key != state.shape_key) {
        state.gpu_shape_key = state.shape_key;
        state.gpu = std::make_unique<BloodGpu>(pass.gl(), params_.size, params_.liquid.max_drops);
        state.surface_key = state.seam_key = 0;
    }
    set_medium();
    set_tools(state.step);
    if (target_step_ > state.step) {
        bleeding_.find_places(state, pass.log());
    }
    update_surface(pass);
    if (state.woken) {
        wake(pass);
    }
    if (target_step_ > state.step) {
        if (std::exchange(state.source_key, source_key_) != source_key_) {
            state.stir();
        }
        state.step = std::max(state.step, target_step_ - longest_gap());
        while (state.step < target_step_) {
            run_step(pass);
        }
        ++state.version;
        see_whether_it_rests(pass.has("energy"));
    }
    show(pass);
}

void BloodEffect::see_whether_it_rests(bool seals) {
    BloodState& state = *state_;
    const double now = static_cast<double>(target_step_) / state.steps_per_s;
    const double before = now - 1.0 / state.steps_per_s;
    const bool bleeds = bleeding_.bleeds(before, now);
    const std::optional<std::uint64_t> still = state.gpu->all_still();
    // What comes back is a picture in memory: while wounds bleed it is asked for now and then.
    const bool due = !bleeds || state.looks >= state.asked_look + looks_per_question;
    if (!still && !due) {
        return;  // before all that is in the air is looked at
    }
    if (bleeds ? !seals || !bleeding_.jets_explain(state, before, now)
               : !state.jets.particles().empty() || !state.landed.empty()) {
        return;
    }
    if (still && *still >= state.disturbed_at) {
        state.moving = false;
        if (bleeds) {
            state.sealed_key = source_key_;
        } else {
            state.ring.clear();
        }
    }
    if (state.moving && due && state.looks >= state.disturbed_at) {
        state.asked_look = state.looks;
        state.gpu->ask_tiles(state.looks);
    }
}

void BloodEffect::show(const Pass& pass) {
    BloodState& state = *state_;
    using Shown = BloodGpu::Shown;
    const bool same = shown_version_ != 0 && shown_version_ == state.shown_version;
    const Shown before = !pass.kept() ? Shown::nothing : same ? Shown::last : Shown::unknown;
    state.gpu->begin_picture(pass, medium_, before);
    pass.bind_target();  // the steps draw elsewhere
    const gl::Program& program = pass.use(programs_.size() - 1);
    program.set("u_extinction", glm::vec3(params_.look.extinction_per_mm));
    program.set("u_deep", glm::vec3(params_.look.deep_colour));
    program.set("u_covering", static_cast<float>(params_.look.covering_mm));
    program.set("u_bump", static_cast<float>(params_.look.bump));
    state.gpu->cover_changed(pass, program, before);
    state.gpu->end_picture(pass);
    shown_version_ = state.shown_version = state.version;
}

}  // namespace viscera::tissue
