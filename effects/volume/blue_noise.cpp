#include <algorithm>
#include <cmath>

#include "effects/volume/sampling.h"

namespace viscera::volume {
namespace {

/// How crowded each place is by the points set, on a torus: a Gaussian of 1.5 places around each point.
class Crowd {
  public:
    explicit Crowd(int size) : size_(size), points_(count()), energy_(count(), 0.0) {
        for (int dy = 0; dy < size; ++dy) {
            for (int dx = 0; dx < size; ++dx) {
                const double x = std::min(dx, size - dx);
                const double y = std::min(dy, size - dy);
                kernel_.push_back(std::exp(-(x * x + y * y) / (2.0 * 1.5 * 1.5)));
            }
        }
    }
    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_);
    }
    [[nodiscard]] bool has(std::size_t i) const { return points_[i]; }
    void set(std::size_t i, bool point) {
        points_[i] = point;
        const double sign = point ? 1.0 : -1.0;
        const int x0 = static_cast<int>(i) % size_;
        const int y0 = static_cast<int>(i) / size_;
        for (int y = 0; y < size_; ++y) {
            const int row = ((y - y0 + size_) % size_) * size_;
            for (int x = 0; x < size_; ++x) {
                energy_[static_cast<std::size_t>(y * size_ + x)] +=
                    sign * kernel_[static_cast<std::size_t>(row + (x - x0 + size_) % size_)];
            }
        }
    }
    /// The most crowded point, or the emptiest place; the first of equals.
    [[nodiscard]] std::size_t extreme(bool point) const {
        std::size_t best = count();
        for (std::size_t i = 0; i < count(); ++i) {
            if (points_[i] == point &&
                (best == count() || (point ? energy_[i] > energy_[best] : energy_[i] < energy_[best]))) {
                best = i;
            }
        }
        return best;
    }

  private:
    int size_;
    std::vector<bool> points_;
    std::vector<double> energy_;
    std::vector<double> kernel_;
};

}  // namespace

std::vector<std::uint16_t> blue_noise(int size, std::uint32_t seed) {
    Crowd crowd(size);
    const std::size_t count = crowd.count();
    std::uint32_t state = seed * 2654435761U + 12345U;
    std::size_t points = 0;
    while (points < count / 10 + 1) {
        state = state * 1664525U + 1013904223U;
        const std::size_t place = (state >> 8) % count;
        if (!crowd.has(place)) {
            crowd.set(place, true);
            ++points;
        }
    }
    // Points move from the tightest cluster to the largest void until that is one and the same place.
    for (std::size_t from = count, to = 0; from != to;) {
        from = crowd.extreme(true);
        crowd.set(from, false);
        to = crowd.extreme(false);
        crowd.set(to, true);
    }
    std::vector<std::uint16_t> rank(count);
    Crowd shrinking = crowd;
    for (std::size_t n = points; n-- > 0;) {
        const std::size_t place = shrinking.extreme(true);
        shrinking.set(place, false);
        rank[place] = static_cast<std::uint16_t>(n);
    }
    for (std::size_t n = points; n < count; ++n) {
        const std::size_t place = crowd.extreme(false);
        crowd.set(place, true);
        rank[place] = static_cast<std::uint16_t>(n);
    }
    return rank;
}

}  // namespace viscera::volume
