#include "effects/tissue/seam_reach.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace viscera::tissue {
namespace {

template <std::size_t n>
void keep_once(std::vector<std::array<int, n>>& found) {
    std::ranges::sort(found);
    found.erase(std::ranges::unique(found).begin(), found.end());
}

/// `numbers`: square, number; by square.
SeamReach pack(std::span<const std::array<int, 2>> numbers, const SquareGrid& grid) {
    const auto count = static_cast<std::size_t>(grid.count());
    SeamReach reach{{}, std::vector<glm::vec2>(count * count, glm::vec2(0.0F))};
    int in_square = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto [square, number] = numbers[i];
        glm::vec2& first = reach.first[static_cast<std::size_t>(square)];
        in_square = i > 0 && numbers[i - 1][0] == square ? in_square + 1 : 0;
        if (in_square == 0) {
            first.x = static_cast<float>(reach.items.size());
        }
        if (in_square % 4 == 0) {
            reach.items.emplace_back(static_cast<float>(number));
            first.y += 1.0F;
        }
        reach.items.back()[in_square % 4] = static_cast<float>(number);
    }
    return reach;
}

/// From -1 to 1 each, for i from 0 to 8.
glm::ivec2 neighbour(int i) {
    return {i % 3 - 1, i / 3 - 1};
}

}  // namespace

int SquareGrid::square_of(int texel, const glm::ivec2& off) const {
    const glm::ivec2 at(texel % size, texel / size);
    const glm::ivec2 square = glm::clamp(at + off, 0, size - 1) / side;
    return square.y * count() + square.x;
}

SeamReach reach_beside_seams(const SquareGrid& grid, std::span<const SeamLink> links,
                             std::span<const SeamJump> jumps) {
    std::vector<std::array<int, 2>> joined;  // square, the one across
    const auto join = [&](int a, int b) {
        // What flows one way must be seen from the other side as well.
        joined.push_back({grid.square_of(a), grid.square_of(b)});
        joined.push_back({grid.square_of(b), grid.square_of(a)});
    };
    for (const SeamLink& link : links) {
        join(static_cast<int>(link.from), static_cast<int>(link.to));
    }
    for (const SeamJump& jump : jumps) {
        join(jump.gutter, jump.to);
    }
    keep_once(joined);
    const int count = grid.count();
    const auto inside = [&](const glm::ivec2& at) { return at == glm::clamp(at, 0, count - 1); };
    std::vector<std::array<int, 2>> found;
    for (const auto& [to, from] : joined) {
        for (int i = 0; i < 81; ++i) {
            const glm::ivec2 here = glm::ivec2(to % count, to / count) + neighbour(i / 9);
            const glm::ivec2 there = glm::ivec2(from % count, from / count) + neighbour(i % 9);
            if (inside(here) && inside(there)) {
                found.push_back({here.y * count + here.x, there.x + (there.y << 9)});
            }
        }
    }
    keep_once(found);
    return pack(found, grid);
}

SeamReach reach_across_seams(const SquareGrid& grid, int past_seam, std::span<const SeamLink> links,
                             std::span<const SeamJump> jumps) {
    std::vector<std::array<int, 3>> found;  // to, from, kind
    const auto add = [&](int from, int to, ReachKind kind) {
        if (from != to) {
            found.push_back({to, from, kind});
        }
    };
    const auto flow = [&](int from, int to, bool towards) {
        const int here = grid.square_of(from);
        const int there = grid.square_of(to);
        add(here, there, reach_from_where_it_lies);
        for (int i = 0; i < 9; ++i) {
            const glm::ivec2 way = past_seam * neighbour(i);
            add(here, grid.square_of(to, way), reach_from_where_it_runs_far);
            if (towards) {
                add(grid.square_of(from, way), there, reach_from_where_it_runs_far);
            }
        }
    };
    for (const SeamLink& link : links) {
        flow(static_cast<int>(link.from), static_cast<int>(link.to), true);
        flow(static_cast<int>(link.to), static_cast<int>(link.from), true);
    }
    // A drop leaves blood where the gutter below it leads, and the gutter shows what is there.
    for (const SeamJump& jump : jumps) {
        flow(jump.gutter, jump.to, false);
        add(grid.square_of(jump.to), grid.square_of(jump.gutter), reach_of_gutters);
    }
    keep_once(found);
    const int count = grid.count();
    std::vector<std::array<int, 2>> numbers;
    for (std::size_t i = 0; i < found.size();) {
        const auto [to, from, lowest] = found[i];
        int kind = lowest;
        for (++i; i < found.size() && found[i][0] == to && found[i][1] == from; ++i) {
            kind |= found[i][2] & reach_of_gutters;
        }
        numbers.push_back({to, kind + (from % count << 3) + (from / count << 12)});
    }
    return pack(numbers, grid);
}

}  // namespace viscera::tissue
