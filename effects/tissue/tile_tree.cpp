#include "effects/tissue/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/pixel_index.h"

namespace viscera::tissue {
namespace {

// Boxes are rounded apart by this share of the largest coordinate: the bake blends corners in floats.
constexpr float rounding = 2e-6F;
// Long ways are asked for in pieces, each by a ball around it; more pieces gain little.
constexpr double most_pieces = 64.0;

int tiles_for(int size) {
    return (size + TileTree::tile_texels - 1) / TileTree::tile_texels;
}

double distance2(const glm::dvec3& p, const glm::vec3& low, const glm::vec3& high) {
    const glm::dvec3 outside = glm::max(glm::max(glm::dvec3(low) - p, p - glm::dvec3(high)), 0.0);
    return glm::dot(outside, outside);
}

}  // namespace

void TileTree::Box::add(const Box& other) {
    if (other.empty()) {
        return;
    }
    low = empty() ? other.low : glm::min(low, other.low);
    high = empty() ? other.high : glm::max(high, other.high);
}

TileTree::TileTree(int size) : size_(size), side_(tiles_for(size)) {
    make_levels();
    const float step = 1.0F / static_cast<float>(size);
    for (int t = 0; t < side_ * side_; ++t) {
        const int row = t / side_;
        const glm::vec2 tile(static_cast<float>(t % side_), static_cast<float>(row));
        const glm::vec2 low = tile * (step * static_cast<float>(tile_texels));
        const glm::vec2 high = (tile + 1.0F) * (step * static_cast<float>(tile_texels));
        levels_[0].boxes[static_cast<std::size_t>(t)] = {{low, 0.0F}, {high, 0.0F}};
    }
    merge_levels();
}

TileTree::TileTree(const std::shared_ptr<const TexelMap>& map)
    : size_(map->size), side_(tiles_for(map->size)) {
    make_levels();
    find_shares(*map);
}

void TileTree::make_levels() {
    for (int side = side_;; side = (side + 1) / 2) {
        levels_.push_back(
            {side, std::vector<Box>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side))});
        if (side == 1) {
            break;
        }
    }
    seen_.assign(levels_[0].boxes.size(), 0);
}

void TileTree::find_shares(const TexelMap& map) {
    std::vector<Share> found;
    for (int t = 0; t < side_ * side_; ++t) {
        first_share_.push_back(static_cast<std::uint32_t>(shares_.size()));
        found.clear();
        const int x0 = t % side_ * tile_texels;
        const int y0 = t / side_ * tile_texels;
        for (int y = y0; y < std::min(y0 + tile_texels, size_); ++y) {
            for (int x = x0; x < std::min(x0 + tile_texels, size_); ++x) {
                const TexelPoint& point =
                    map.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                               static_cast<std::size_t>(x)];
                if (point.owner == 0.0F) {
                    continue;
                }
                const float triangle = point.triangle < 0.0F ? -point.triangle - 1.0F : point.triangle;
                found.push_back(
                    {static_cast<std::uint32_t>(triangle), {point.b1, point.b2}, {point.b1, point.b2}});
            }
        }
        std::ranges::sort(found, {}, &Share::triangle);
        for (const Share& share : found) {
            if (shares_.size() == first_share_.back() || shares_.back().triangle != share.triangle) {
                shares_.push_back(share);
                continue;
            }
            shares_.back().low = glm::min(shares_.back().low, share.low);
            shares_.back().high = glm::max(shares_.back().high, share.high);
        }
    }
    first_share_.push_back(static_cast<std::uint32_t>(shares_.size()));
}

void TileTree::place(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    for (std::size_t t = 0; t < levels_[0].boxes.size(); ++t) {
        Box box;
        for (std::uint32_t s = first_share_[t]; s < first_share_[t + 1]; ++s) {
            const Share& share = shares_[s];
            const auto corner = indices.subspan(3 * std::size_t{share.triangle}, 3);
            const glm::vec3& p = positions[corner[0]];
            const glm::vec3 e1 = positions[corner[1]] - p;
            const glm::vec3 e2 = positions[corner[2]] - p;
            const glm::vec3 low = p + glm::min(share.low.x * e1, share.high.x * e1) +
                                  glm::min(share.low.y * e2, share.high.y * e2);
            const glm::vec3 high = p + glm::max(share.low.x * e1, share.high.x * e1) +
                                   glm::max(share.low.y * e2, share.high.y * e2);
            const glm::vec3 most = glm::max(glm::abs(low), glm::abs(high)) + glm::abs(e1) + glm::abs(e2);
            const float margin = rounding * std::max({most.x, most.y, most.z});
            box.add({low - margin, high + margin});
        }
        levels_[0].boxes[t] = box;
    }
    merge_levels();
}

bool TileTree::holds_any(std::uint32_t tile, std::span<const char> marked) const {
    const auto begin = shares_.begin() + first_share_[tile];
    const auto end = shares_.begin() + first_share_[tile + 1];
    return std::any_of(begin, end, [&](const Share& share) { return marked[share.triangle] != 0; });
}

void TileTree::merge_levels() {
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        const Level& below = levels_[l - 1];
        Level& level = levels_[l];
        std::ranges::fill(level.boxes, Box{});
        for (int y = 0; y < below.side; ++y) {
            for (int x = 0; x < below.side; ++x) {
                level.boxes[pixel_index(x / 2, y / 2, level.side)].add(
                    below.boxes[pixel_index(x, y, below.side)]);
            }
        }
    }
}

void TileTree::near(const glm::dvec3& a, const glm::dvec3& b, double radius,
                    std::vector<std::uint32_t>& tiles) {
    ++question_;
    const double length = glm::distance(a, b);
    const double pieces = std::clamp(std::ceil(length / radius), 1.0, most_pieces);
    const double half = 0.5 * length / pieces;
    for (int i = 0; i + 0.5 < pieces; ++i) {
        visit(levels_.size() - 1, 0, 0, a + (b - a) * ((i + 0.5) / pieces), radius + half, tiles);
    }
}

void TileTree::visit(std::size_t level, int x, int y, const glm::dvec3& centre, double radius,
                     std::vector<std::uint32_t>& tiles) {
    const Level& here = levels_[level];
    if (x >= here.side || y >= here.side) {
        return;
    }
    const auto index = static_cast<std::uint32_t>(y * here.side + x);
    const Box& box = here.boxes[index];
    if (box.empty() || !(distance2(centre, box.low, box.high) <= radius * radius)) {
        return;
    }
    if (level == 0) {
        if (seen_[index] != question_) {
            seen_[index] = question_;
            tiles.push_back(index);
        }
        return;
    }
    for (int child = 0; child < 4; ++child) {
        visit(level - 1, 2 * x + child % 2, 2 * y + child / 2, centre, radius, tiles);
    }
}

}  // namespace viscera::tissue
