#include "engine/core/rectangle_pack.h"

#include <algorithm>
#include <numeric>

namespace viscera {
namespace {

/// The upper edge of what has been placed: steps from left to right, each up to where the next one begins.
class Skyline {
  public:
    [[nodiscard]] std::optional<glm::dvec2> place(const glm::dvec2& size) {
        std::optional<glm::dvec2> best;
        for (std::size_t i = 0; i < steps_.size() && steps_[i].x + size.x <= 1.0; ++i) {
            const double height = height_over(i, size.x);
            if (height + size.y <= 1.0 && (!best || height < best->y)) {
                best = {steps_[i].x, height};
            }
        }
        if (best) {
            raise(best->x, best->x + size.x, best->y + size.y);
        }
        return best;
    }

  private:
    [[nodiscard]] double height_over(std::size_t first, double width) const {
        double height = 0.0;
        for (std::size_t i = first; i < steps_.size() && steps_[i].x < steps_[first].x + width; ++i) {
            height = std::max(height, steps_[i].y);
        }
        return height;
    }

    void raise(double left, double right, double height) {
        double height_at_right = 0.0;
        std::vector<glm::dvec2> steps;
        for (const glm::dvec2& step : steps_) {
            if (step.x <= right) {
                height_at_right = step.y;
            }
            if (step.x < left) {
                steps.push_back(step);
            }
        }
        steps.emplace_back(left, height);
        if (right < 1.0) {
            steps.emplace_back(right, height_at_right);
        }
        for (const glm::dvec2& step : steps_) {
            if (step.x > right) {
                steps.push_back(step);
            }
        }
        steps_ = std::move(steps);
    }

    std::vector<glm::dvec2> steps_{{0.0, 0.0}};
};

}  // namespace

std::optional<std::vector<glm::dvec2>> pack_rectangles(std::span<const glm::dvec2> sizes) {
    std::vector<std::size_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return sizes[a].y > sizes[b].y; });
    std::vector<glm::dvec2> corners(sizes.size());
    Skyline skyline;
    for (const std::size_t i : order) {
        const auto corner = skyline.place(sizes[i]);
        if (!corner) {
            return std::nullopt;
        }
        corners[i] = *corner;
    }
    return corners;
}

}  // namespace viscera
