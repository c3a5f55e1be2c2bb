#include "effects/tissue/blood_state.h"

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"

namespace viscera::tissue {
namespace {

// From its life's end on a drop is gone after 1 s at the latest (blood_move.frag); two more steps clear both
// textures.
constexpr double end_of_life_s = 1.1;

std::int64_t divided_down(std::int64_t a, std::int64_t b) {
    return a / b - (a % b < 0 ? 1 : 0);
}

}  // namespace

void DropRing::begin(std::int64_t step, std::int64_t longest_steps) {
    bin_steps_ = std::max<std::int64_t>((longest_steps + bins - 4) / (bins - 3), 1);
    bin_ = first_bin_ = divided_down(step, bin_steps_);
    head_ = first_ = 0;
    head_at_bin_.fill(0);
}

void DropRing::pass_to(std::int64_t step) {
    const std::int64_t bin = divided_down(step, bin_steps_);
    const auto slot = [](std::int64_t b) { return static_cast<std::size_t>(((b % bins) + bins) % bins); };
    for (std::int64_t b = std::max(bin_ + 1, bin - bins); b <= bin; ++b) {
        head_at_bin_[slot(b)] = head_;
    }
    if (bin > bin_) {
        bin_ = bin;
        if (bin - (bins - 2) > first_bin_) {
            first_ = std::max(first_, head_at_bin_[slot(bin - (bins - 2))]);
        }
    }
}

DropRange DropRing::add(std::int64_t count, std::int64_t capacity) {
    const DropRange evicted{first_, std::max<std::int64_t>(head_ + count - first_ - capacity, 0)};
    first_ += evicted.count;
    head_ += count;
    return evicted;
}

std::shared_ptr<BloodState> BloodState::find(Assets& assets, std::string_view name) {
    return assets.shared<BloodState>(Hash().add(name).value(), [] { return std::make_shared<BloodState>(); });
}

void BloodState::begin_anew(std::int64_t at, double rate, double drop_life_s) {
    begun = true;
    bled = moving = false;
    step = at;
    steps_per_s = rate;
    surface_key = 0;
    shown_version = 0;
    ++version;
    steps_run = looked_run = 0;
    ring.begin(0, static_cast<std::int64_t>(std::ceil((drop_life_s + end_of_life_s) * rate)) + 2);
    meters.clear();
    expected.clear();
    seed = 0;
    tool_count = 0;
    jets.clear();
}

}  // namespace viscera::tissue
