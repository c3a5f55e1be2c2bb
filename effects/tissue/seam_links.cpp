#include "effects/tissue/seam_links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace viscera::tissue {
namespace {

// Weights below this are rounding.
constexpr double least_weight = 1e-3;

class Joiner {
  public:
    Joiner(const Image& position, const Image& seam) : position_(position), seam_(seam) {}

    [[nodiscard]] std::vector<int> gutters() const {
        std::vector<int> found;
        for (int y = 0; y < position_.height; ++y) {
            for (int x = 0; x < position_.width; ++x) {
                if (is_gutter({x, y})) {
                    found.push_back(y * position_.width + x);
                }
            }
        }
        return found;
    }

    [[nodiscard]] std::vector<SeamJump> jumps() const {
        std::vector<SeamJump> found;
        for (const int gutter : gutters()) {
            const glm::ivec2 to(
                glm::floor(place({gutter % position_.width, gutter / position_.width}) + 0.5));
            if (inside(to)) {
                found.push_back({gutter, to.y * position_.width + to.x});
            }
        }
        return found;
    }

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

    /// Where the surface goes on, in texels from the centre of the first.
    [[nodiscard]] glm::dvec2 place(const glm::ivec2& gutter) const {
        return glm::dvec2(seam_.at(gutter.x, gutter.y, 0), seam_.at(gutter.x, gutter.y, 1)) *
                   glm::dvec2(position_.width, position_.height) -
               0.5;
    }

    void join(const glm::ivec2& cell, const glm::ivec2& gutter, int side) {
        const glm::dvec2 at = place(gutter);
        const glm::ivec2 low(glm::floor(at));
        const glm::dvec2 t = at - glm::dvec2(low);
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

std::vector<SeamJump> seam_jumps(const Image& position, const Image& seam) {
    return Joiner(position, seam).jumps();
}

std::vector<int> seam_gutters(const Image& position, const Image& seam) {
    return Joiner(position, seam).gutters();
}

SeamParts seam_parts(std::span<const SeamLink> links, std::size_t cells) {
    SeamParts seams{{}, {}, std::vector<float>(cells, -1.0F)};
    seams.links.reserve(2 * links.size());
    for (SeamLink link : links) {
        seams.links.push_back(link);
        link.share = -link.share;
        seams.links.push_back(link);
    }
    const auto cell = [](const SeamLink& link) { return link.share > 0.0F ? link.from : link.to; };
    const auto across = [](const SeamLink& link) { return link.share > 0.0F ? link.to : link.from; };
    // Stable: sums must not hang on how a library sorts.
    std::ranges::stable_sort(seams.links, {},
                             [&](const SeamLink& link) { return std::pair(cell(link), across(link)); });
    for (std::size_t i = 0; i < seams.links.size(); ++i) {
        const SeamLink& link = seams.links[i];
        const bool cell_begins = i == 0 || cell(seams.links[i - 1]) != cell(link);
        if (cell_begins || across(seams.links[i - 1]) != across(link)) {
            if (cell_begins) {
                seams.first[static_cast<std::size_t>(cell(link))] = static_cast<float>(seams.parts.size());
            }
            seams.parts.push_back({static_cast<float>(i), 0.0F, across(link), 0.0F});
        }
        seams.parts.back().count += 1.0F;
        seams.parts.back().ends =
            i + 1 == seams.links.size() || cell(seams.links[i + 1]) != cell(link) ? 1.0F : 0.0F;
    }
    return seams;
}

}  // namespace viscera::tissue
