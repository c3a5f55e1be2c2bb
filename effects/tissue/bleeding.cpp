#include "effects/tissue/bleeding.h"

#include <algorithm>
#include <string>
#include <utility>

#include "effects/tissue/blood_sources.h"
#include "engine/core/log.h"

namespace viscera::tissue {
namespace {

// For as many wounds each triangle is looked at; for more they are put into a tree first.
constexpr std::size_t few_wounds = 16;
// Drops of a jet in those of a wound: it is finer.
constexpr double jet_drop_share = 0.25;
// A jet's wound this close to the surface lies on it: else one a little beneath would never get out.
constexpr double on_surface_mm = 0.5;
// Where drops of a jet come down no plan has looked, so that they ask for one: they wait for each other, as
// many steps as a plan holds for, and no longer than is seen.
constexpr double longest_landing_s = 1.0 / 30.0;

}  // namespace

void Bleeding::collect(const BloodParams& params, const HostValues* values, Log& log) {
    liquid_ = params.liquid;
    collect_wounds(params, values, log, wounds_);
}

void Bleeding::lie_on(std::shared_ptr<const SurfaceMesh> mesh, const glm::dmat4& to_world,
                      std::uint64_t key) {
    mesh_ = std::move(mesh);
    to_world_ = to_world;
    surface_key_ = key;
}

bool Bleeding::bleeds(const WoundParams& wound, double from_s, double to_s) {
    return to_s > from_s && wound.rate_mm3_s > 0.0 && wound.start_s < to_s && wound.stop_s > from_s;
}

bool Bleeding::bleeds(double from_s, double to_s) const {
    return std::ranges::any_of(wounds_,
                               [&](const WoundParams& wound) { return bleeds(wound, from_s, to_s); });
}

bool Bleeding::sends_jets(double from_s, double to_s) const {
    return std::ranges::any_of(wounds_, [&](const WoundParams& wound) {
        return wound.kind == BleedingKind::jet && bleeds(wound, from_s, to_s);
    });
}

void Bleeding::find_places(BloodState& state, Log& log) {
    places_.resize(wounds_.size());
    const auto is_old = [this](std::size_t i) {
        return places_[i].wound_mm != wounds_[i].position_mm || places_[i].surface_key != surface_key_;
    };
    std::size_t old = 0;
    for (std::size_t i = 0; i < wounds_.size(); ++i) {
        old += is_old(i) ? 1 : 0;
    }
    if (old > few_wounds) {
        update_tree();
    }
    std::size_t without_place = 0;
    for (std::size_t i = 0; old > 0 && i < wounds_.size(); ++i) {
        if (!is_old(i)) {
            continue;
        }
        const glm::dvec3& at = wounds_[i].position_mm;
        Place& place = places_[i] = {.wound_mm = at, .surface_key = surface_key_, .start_mm = at};
        const auto nearest =
            tree_key_ == surface_key_ ? tree_.nearest(at) : nearest_point(mesh_->data(), to_world_, at);
        if (nearest) {
            place.found = true;
            place.uv = within_texture(nearest->uv);
            place.start_mm = nearest->distance <= on_surface_mm ? nearest->position_mm : at;
        }
        without_place += nearest ? 0 : 1;
    }
    if (without_place > 0) {
        log.fault("tissue.wound_no_place", "the surface has no triangle with an extent; wounds do not bleed",
                  without_place);
    }
    if (state.meters.size() < wounds_.size()) {
        state.meters.resize(wounds_.size());
    }
}

void Bleeding::update_tree() {
    if (tree_key_ != surface_key_) {
        tree_key_ = surface_key_;
        tree_ = TriangleTree(mesh_->data(), to_world_);
    }
}

void Bleeding::expect_drops(BloodState& state, int steps) const {
    const double dt = 1.0 / liquid_.steps_per_s;
    const double from = static_cast<double>(state.step) * dt;
    const double to = from + static_cast<double>(steps) * dt;
    state.expected.begin(liquid_.drop_aspect);
    for (std::size_t i = 0; i < std::min(places_.size(), wounds_.size()); ++i) {
        const WoundParams& wound = wounds_[i];
        // One without a rate would keep its blocks from resting.
        if (places_[i].found && wound.kind == BleedingKind::ooze && bleeds(wound, from, to)) {
            state.expected.add(i, places_[i].uv, wound.radius_mm,
                               DropMeter::drop_volume(wound.rate_mm3_s * dt, liquid_.drop_mm3));
        }
    }
}

void Bleeding::step(BloodState& state, const glm::dvec3& gravity_mm_s2, Log& log,
                    std::vector<DropSpawn>& drops) {
    drops.clear();
    const double dt = 1.0 / liquid_.steps_per_s;
    const double time = (static_cast<double>(state.step) + 0.5) * dt;
    const std::uint64_t refused = state.jets.refused();
    for (std::size_t i = 0; i < wounds_.size(); ++i) {
        const WoundParams& wound = wounds_[i];
        const double pulse = pulse_of(wound, time);
        if (!places_[i].found || time < wound.start_s || time >= wound.stop_s ||
            !(wound.rate_mm3_s * pulse > 0.0)) {
            continue;
        }
        const glm::vec2& uv = places_[i].uv;
        const bool flies = wound.kind == BleedingKind::jet;
        const auto fallen = state.meters[i].flow(wound.rate_mm3_s * pulse * dt,
                                                 liquid_.drop_mm3 * (flies ? jet_drop_share : 1.0));
        if (flies) {
            WoundParams opening = wound;
            opening.position_mm = places_[i].start_mm;
            state.jets.leave(opening, uv, fallen, pulse, dt);
            continue;
        }
        for (int n = 0; n < fallen.count; ++n) {
            drops.push_back({.uv = uv,
                             .volume_mm3 = static_cast<float>(fallen.volume_mm3),
                             .radius_mm = static_cast<float>(wound.radius_mm),
                             .expected = state.expected.covers(i, uv, wound.radius_mm, fallen.volume_mm3)});
        }
    }
    if (state.jets.refused() > refused) {
        log.fault("tissue.too_much_in_the_air",
                  "more than " + std::to_string(Jets::most_particles) +
                      " pieces of jets are in the air; the others are lost",
                  state.jets.refused() - refused);
    }
    fly(state, gravity_mm_s2);
    const auto wait = static_cast<std::int64_t>(longest_landing_s / dt + 1e-6);
    if (state.step % std::clamp<std::int64_t>(wait, 1, BloodBlocks::steps_per_plan) == 0) {
        drops.insert(drops.end(), state.landed.begin(), state.landed.end());
        state.landed.clear();
    }
    for (DropSpawn& drop : drops) {
        drop.seed = static_cast<float>(state.seed++ & 0xffffffU);
    }
}

void Bleeding::fly(BloodState& state, const glm::dvec3& gravity_mm_s2) {
    if (state.jets.particles().empty()) {
        return;
    }
    update_tree();
    state.jets.step(tree_, gravity_mm_s2, 1.0 / liquid_.steps_per_s, state.landed);
    state.bled = true;
    state.stir();
}

}  // namespace viscera::tissue
