#include "effects/tissue/bleeding.h"

#include <algorithm>
#include <string>
#include <utility>

#include "effects/tissue/blood_sources.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"

namespace viscera::tissue {
namespace {

// For as many wounds each triangle is looked at; for more they are put into a tree first.
constexpr std::size_t few_wounds = 16;
// Drops of a jet in those of a wound: it is finer.
constexpr double jet_drop_share = 0.25;
// A jet's wound this close to the surface lies on it: else one a little beneath would never get out.
constexpr double on_surface_mm = 0.5;
// A jet's wound is sealed where its place is: as large as that is said to be.
constexpr double jet_wound_mm = 1e-3;
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

std::uint64_t Bleeding::key(double from_s, double to_s) const {
    Hash hash;
    for (std::size_t i = 0; i < wounds_.size(); ++i) {
        const WoundParams& wound = wounds_[i];
        if (bleeds(wound, from_s, to_s)) {
            hash.add(i).add(wound.position_mm).add(wound.radius_mm).add(wound.kind);
        }
    }
    return hash.value();
}

std::size_t Bleeding::jet_at(const glm::vec2& uv, double from_s, double to_s) const {
    for (std::size_t i = 0; i < std::min(places_.size(), wounds_.size()); ++i) {
        if (wounds_[i].kind == BleedingKind::jet && places_[i].uv == uv && bleeds(wounds_[i], from_s, to_s)) {
            return i;
        }
    }
    return places_.size();
}

bool Bleeding::jets_explain(const BloodState& state, double from_s, double to_s) const {
    const auto is_known = [&](const auto& drop) {
        return jet_at(drop.sealed_at, from_s, to_s) < places_.size();
    };
    return std::ranges::all_of(state.jets.particles(), is_known) &&
           std::ranges::all_of(state.landed, is_known);
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

void Bleeding::expect_drops(BloodState& state, int steps, bool seals) const {
    const double dt = 1.0 / liquid_.steps_per_s;
    const double from = static_cast<double>(state.step) * dt;
    const double to = from + static_cast<double>(steps) * dt;
    state.expected.begin(liquid_.drop_aspect);
    for (std::size_t i = 0; i < std::min(places_.size(), wounds_.size()); ++i) {
        const WoundParams& wound = wounds_[i];
        // One without a rate would keep its blocks from resting.
        if (!places_[i].found || !bleeds(wound, from, to)) {
            continue;
        }
        if (wound.kind == BleedingKind::ooze) {
            state.expected.add(i, places_[i].uv, wound.radius_mm,
                               DropMeter::drop_volume(wound.rate_mm3_s * dt, liquid_.drop_mm3));
        } else if (seals) {
            state.expected.add(i, places_[i].uv, jet_wound_mm, 0.0);
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
            const bool expected = state.expected.covers(i, uv, wound.radius_mm, fallen.volume_mm3);
            drops.push_back({.uv = uv,
                             .volume_mm3 = static_cast<float>(fallen.volume_mm3),
                             .radius_mm = static_cast<float>(wound.radius_mm),
                             .expected = expected,
                             .foreseen = expected});
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
        for (DropSpawn& drop : state.landed) {
            const std::size_t jet = jet_at(drop.sealed_at, time - 0.5 * dt, time + 0.5 * dt);
            drop.foreseen =
                jet < places_.size() && state.expected.covers(jet, drop.sealed_at, jet_wound_mm, 0.0);
            drops.push_back(drop);
        }
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
    state.bled = state.moving = true;
}

}  // namespace viscera::tissue
