#include "effects/tissue/seam_links.h"

#include <array>
#include <cmath>

namespace viscera::tissue {
namespace {

// Weights below this are rounding.
constexpr double least_weight = 1e-3;

class Joiner {
  public:
    Joiner(const Image& position, const Image& seam) : position_(position), seam_(seam) {}

    std::vector<SeamLink> run() {
        static constexpr std::array<glm::ivec2, 4> sides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
        for (int y = 0; y < position_.height; ++y) {
            for (int x = 0; x < position_.width; ++x) {
                for (std::size_t side = 0; side < sides.size(); ++side) {
                    const glm::ivec2 gutter = glm::ivec2(x, y) + sides[side];
                    if (is_cell({x, y}) && is_gutter(gutter)) {
                        join({x, y}, gutter, static_cast<int>(side));
                    }
                }
            }
        }
        return std::move(links_);
    }

  private:
    [[nodiscard]] bool inside(const glm::ivec2& at) const {
        return at.x >= 0 && at.y >= 0 && at.x < position_.width && at.y < position_.height;
    }
    [[nodiscard]] bool is_cell(const glm::ivec2& at) const {
        return inside(at) && position_.at(at.x, at.y, 3) > 0.75F;
    }
    [[nodiscard]] bool is_gutter(const glm::ivec2& at) const {
        const float coverage = inside(at) ? position_.at(at.x, at.y, 3) : 0.0F;
        return coverage > 0.25F && coverage < 0.75F && seam_.at(at.x, at.y, 0) >= 0.0F;
    }
    [[nodiscard]] float index(const glm::ivec2& at) const {
        return static_cast<float>(at.y * position_.width + at.x);
    }

    void join(const glm::ivec2& cell, const glm::ivec2& gutter, int side) {
        const glm::dvec2 place =
            glm::dvec2(seam_.at(gutter.x, gutter.y, 0), seam_.at(gutter.x, gutter.y, 1)) *
                glm::dvec2(position_.width, position_.height) -
            0.5;
        const glm::ivec2 low(glm::floor(place));
        const glm::dvec2 t = place - glm::dvec2(low);
        std::array<double, 4> weight{};
        double sum = 0.0;
        for (int n = 0; n < 4; ++n) {
            const glm::ivec2 to = low + glm::ivec2(n & 1, n >> 1);
            const double w = ((n & 1) != 0 ? t.x : 1.0 - t.x) * ((n >> 1) != 0 ? t.y : 1.0 - t.y);
            if (w > least_weight && is_cell(to) && to != cell) {
                weight[static_cast<std::size_t>(n)] = w;
                sum += w;
            }
        }
        for (int n = 0; n < 4; ++n) {
            const double w = weight[static_cast<std::size_t>(n)];
            if (w > 0.0) {
                links_.push_back({index(cell), index(low + glm::ivec2(n & 1, n >> 1)),
                                  static_cast<float>(side), static_cast<float>(0.5 * w / sum)});
            }
        }
    }

    const Image& position_;
    const Image& seam_;
    std::vector<SeamLink> links_;
};

}  // namespace

std::vector<SeamLink> seam_links(const Image& position, const Image& seam) {
    return Joiner(position, seam).run();
}

}  // namespace viscera::tissue
