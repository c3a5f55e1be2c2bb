#include "effects/volume/brick_distances.h"

#include <algorithm>
#include <array>
#include <bit>
#include <experimental/simd>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/pixel_index.h"

namespace viscera::volume {
namespace {

template <class Visit>
void each_row(const glm::ivec3& dims, const Visit& visit) {
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            visit(y, z);
        }
    }
}

std::size_t checked_count(const glm::ivec3& dims, std::span<const std::uint8_t> kinds) {
    const bool any = dims.x > 0 && dims.y > 0 && dims.z > 0;
    if (kinds.size() != (any ? voxel_index(dims - 1, dims) + 1 : 0)) {
        throw Error(ErrorCode::usage, "distances of bricks", "kinds and grid differ in size");
    }
    return kinds.size();
}

/// Distances of a grid with a margin around it, in which every brick is as far as can be told: no neighbour
/// then needs a test of whether it exists.
class DistanceGrid {
  public:
    /// As wide as a row's longest step below, in bytes.
    static constexpr int margin_x = 16;

    DistanceGrid(const glm::ivec3& dims, std::vector<std::uint8_t>& values, std::vector<std::uint8_t>& row)
        : dims_(dims), stride_(dims.x + 2 * margin_x), values_(values), row_(row) {
        values_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(dims.y + 2) *
                           static_cast<std::size_t>(dims.z + 2),
                       distance_reach);
        row_.assign(2 * static_cast<std::size_t>(stride_), distance_reach);
    }

    /// Row of bricks, without its margin.
    [[nodiscard]] std::uint8_t* row(int y, int z) const {
        const std::ptrdiff_t line = y + 1 + static_cast<std::ptrdiff_t>(dims_.y + 2) * (z + 1);
        return values_.data() + line * stride_ + margin_x;
    }

    /// Spreads the distances from the bricks where they are 0. A shortest path of Chebyshev steps may take
    /// its steps in any order: first those along its row, then those forward through memory, then those
    /// back. So one pass each finds it.
    void spread() const {
        each_row(dims_, [&](int y, int z) {
            spread_along(row(y, z));
            approach(row(y, z), {row(y - 1, z), row(y - 1, z - 1), row(y, z - 1), row(y + 1, z - 1)});
        });
        for (int z = dims_.z - 1; z >= 0; --z) {
            for (int y = dims_.y - 1; y >= 0; --y) {
                approach(row(y, z), {row(y + 1, z), row(y + 1, z + 1), row(y, z + 1), row(y - 1, z + 1)});
            }
        }
    }

  private:
    struct Neighbours {
        const std::uint8_t *a, *b, *c, *d;
    };

    /// Lets the bricks of a row know how near the others of the row are: steps of 1, 2, 4, 8 and 16 in both
    /// directions reach as far as is told, a whole row at a time.
    void spread_along(std::uint8_t* row) const {
        const int count = dims_.x;
        std::uint8_t* now = row_.data() + margin_x;
        std::uint8_t* next = now + stride_;
        std::copy_n(row, count, now);
        for (int step = 1; step <= margin_x; step *= 2) {
            const std::uint8_t* before = now - step;
            const std::uint8_t* after = now + step;
            for (int x = 0; x < count; ++x) {
                const auto side = static_cast<std::uint8_t>(std::min(before[x], after[x]) + step);
                next[x] = std::min(now[x], side);
            }
            std::swap(now, next);
        }
        std::copy_n(now, count, row);
    }

    /// Lets a row know how near its neighbour rows are.
    void approach(std::uint8_t* row, const Neighbours& near) const {
        const int count = dims_.x;
        std::uint8_t* nearest = row_.data() + margin_x;
        for (int x = -1; x <= count; ++x) {
            nearest[x] = std::min(std::min(near.a[x], near.b[x]), std::min(near.c[x], near.d[x]));
        }
        for (int x = 0; x < count; ++x) {
            const std::uint8_t beside = std::min(std::min(nearest[x - 1], nearest[x + 1]), nearest[x]);
            row[x] = std::min(row[x], static_cast<std::uint8_t>(beside + 1));
        }
    }

    glm::ivec3 dims_;
    int stride_;
    std::vector<std::uint8_t>& values_;
    std::vector<std::uint8_t>& row_;  ///< two rows to work in, with their margins
};
static_assert(2 * DistanceGrid::margin_x > distance_reach);

/// Bricks of a row that are looked at together. The compiler makes no vectors of loops like those below by
/// itself.
using BrickRow = std::experimental::native_simd<std::uint8_t>;
constexpr int lanes = static_cast<int>(BrickRow::size());

BrickRow load(const std::uint8_t* from) {
    return {from, std::experimental::element_aligned};
}

void store(const BrickRow& bricks, std::uint8_t* to) {
    bricks.copy_to(to, std::experimental::element_aligned);
}

/// What the search keeps of a brick: kind_step * kind + lack, where lack = distance_reach - size. The size of
/// the least cube is then the greatest lack; bits of another kind, which an exclusive or leaves standing, are
/// more than any lack; and another exclusive or makes a texel of it.
BrickRow texels_of(const BrickRow& bricks) {
    static_assert(kind_step == distance_reach + 1 && (kind_step & distance_reach) == 0);
    return bricks ^ BrickRow(distance_reach);
}

/// Bits of the kind.
BrickRow kinds_of(const BrickRow& bricks) {
    return bricks & BrickRow(static_cast<std::uint8_t>(~distance_reach));
}

/// What cubes lack that are larger by some bricks.
BrickRow larger(const BrickRow& lack, int bricks) {
    const BrickRow by(static_cast<std::uint8_t>(bricks));
    return max(lack, by) - by;
}

/// Rows of bricks in memory, with room before and behind each of them for what limits nothing: bricks of the
/// kind at that end that lack nothing. So ends need no care.
class Rows {
  public:
    explicit Rows(const glm::ivec3& dims)
        : dims_(dims), padded_((dims.x + lanes - 1) / lanes * lanes), stride_(padded_ + 2 * room) {}

    [[nodiscard]] std::size_t bytes(int layers) const {
        return static_cast<std::size_t>(stride_) * static_cast<std::size_t>(dims_.y) *
               static_cast<std::size_t>(layers);
    }
    template <class Byte>
    [[nodiscard]] Byte* row(Byte* first, int y, int z) const {
        return first + room +
               static_cast<std::ptrdiff_t>(stride_) * (y + static_cast<std::ptrdiff_t>(dims_.y) * z);
    }
    /// Visits x in steps of whole lanes.
    template <class Visit>
    void each(const Visit& visit) const {
        for (int x = 0; x < padded_; x += lanes) {
            visit(x);
        }
    }
    /// The same against `step` (1 or -1), so that what lies ahead has been changed by no visit yet.
    template <class Visit>
    void each_before(int step, const Visit& visit) const {
        for (int x = 0; x < padded_; x += lanes) {
            visit(step > 0 ? x : padded_ - lanes - x);
        }
    }
    /// A row that lacks nothing.
    void take_kinds(const std::uint8_t* kinds, std::uint8_t* row) const {
        // Shifted, since libstdc++ 12 multiplies bytes as signed words, which overflow.
        constexpr int kind_bits = std::countr_zero(static_cast<unsigned>(kind_step));
        copy_lanes(kinds, row, [](const BrickRow& kind) { return kind << kind_bits; });
        std::fill_n(row - room, room, row[0]);
        std::fill_n(row + dims_.x, padded_ - dims_.x + room, row[dims_.x - 1]);
    }
    /// Makes room again of what was written beyond the ends of a row that `kinds` are the kinds of.
    void clear_ends(const std::uint8_t* kinds, std::uint8_t* row) const {
        row[-1] = kinds[-1];
        store(load(kinds + dims_.x), row + dims_.x);
    }
    void give_texels(const std::uint8_t* row, std::uint8_t* texels) const {
        copy_lanes(row, texels, texels_of);
    }

  private:
    /// A row of bricks through `change`, where there may be no room behind either of the two.
    template <class Change>
    void copy_lanes(const std::uint8_t* from, std::uint8_t* to, const Change& change) const {
        const int last = dims_.x - lanes;
        for (int x = 0; x < last; x += lanes) {
            store(change(load(from + x)), to + x);
        }
        if (last >= 0) {
            store(change(load(from + last)), to + last);  // some of them once more
            return;
        }
        std::array<std::uint8_t, lanes> few{};
        std::copy_n(from, dims_.x, few.data());
        store(change(load(few.data())), few.data());
        std::copy_n(few.data(), dims_.x, to);
    }

    static constexpr int room = std::max(lanes, distance_reach / 2 + 1);  ///< as far as one step looks

    glm::ivec3 dims_;
    int padded_;  ///< bricks of a row in whole lanes
    int stride_;
};

/// What bricks lack because of the next one of another kind in their row, up (`step` 1) or down (-1) the row.
/// Ways of 1, 2, 4, 8 and 16 find it for all bricks at once; all rows of a layer are done with one way before
/// the next, since what was only just written is slow to read again. `along` begins as `kinds`.
void find_along(const glm::ivec3& dims, const Rows& rows, const std::uint8_t* kinds, int step,
                std::uint8_t* along) {
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            const std::uint8_t* own = rows.row(kinds, y, z);
            std::uint8_t* row = rows.row(along, y, z);
            rows.each([&](int x) {
                BrickRow lack(0);
                where(load(own + x) != load(own + x + step), lack) = distance_reach - 1;
                store(load(own + x) | lack, row + x);
            });
        }
        for (int way = 1; way <= distance_reach / 2 + 1; way *= 2) {
            const int next = step * way;
            for (int y = 0; y < dims.y; ++y) {
                std::uint8_t* row = rows.row(along, y, z);
                rows.each_before(step, [&](int x) {
                    const BrickRow ahead = load(row + x + next) & BrickRow(distance_reach);
                    const BrickRow here = load(row + x);
                    const BrickRow kind = kinds_of(here);
                    store(kind | max(here ^ kind, larger(ahead, way)), row + x);
                });
            }
        }
    }
}

/// Bricks for rays that go along each axis as `up` says. A cube ends at the row's next brick of another kind,
/// and is larger by one than the least of those that begin at the six neighbours ahead in other rows. Bricks
/// are visited from the far end, so that these are known; two layers are kept. A neighbour row outside of the
/// grid limits nothing: the kinds of the row itself take its place.
template <class Write>
void cubes_one_way(const glm::ivec3& dims, const Rows& rows, const std::uint8_t* kinds,
                   const std::uint8_t* along, const glm::bvec3& up, std::uint8_t* layers,
                   const Write& write) {
    const int step = up.x ? 1 : -1;
    for (int z = dims.z - 1; z >= 0; --z) {
        for (int y = dims.y - 1; y >= 0; --y) {
            const glm::ivec2 place(up.y ? y : dims.y - 1 - y, up.z ? z : dims.z - 1 - z);
            const std::uint8_t* own_kinds = rows.row(kinds, place.x, place.y);
            const std::uint8_t* own_along = rows.row(along, place.x, place.y);
            const auto ahead = [&](int dy, int dz) {
                const bool inside = y + dy < dims.y && z + dz < dims.z;
                return inside ? rows.row(std::as_const(layers), y + dy, (z + dz) % 2) : own_kinds;
            };
            const std::uint8_t* beside = ahead(1, 0);
            const std::uint8_t* above = ahead(0, 1);
            const std::uint8_t* across = ahead(1, 1);
            std::uint8_t* row = rows.row(layers, y, z % 2);
            rows.each([&](int x) {
                const BrickRow here = load(own_along + x);
                const BrickRow kind = kinds_of(here);
                const auto lack = [&](const std::uint8_t* from) {
                    return max(load(from + x) ^ kind, load(from + x + step) ^ kind);
                };
                const BrickRow most = max(max(lack(beside), lack(above)), lack(across));
                store(kind | max(here ^ kind, larger(min(most, BrickRow(distance_reach)), 1)), row + x);
            });
            rows.clear_ends(own_kinds, row);
            write(place.x, place.y, row);
        }
    }
}

}  // namespace

void distance_to_others(glm::ivec3 dims, std::span<const std::uint8_t> kinds, int kind,
                        std::vector<std::uint8_t>& distance, DistanceScratch& scratch) {
    distance.resize(checked_count(dims, kinds));
    if (kinds.empty()) {
        return;
    }
    const DistanceGrid grid(dims, scratch.grid, scratch.row);
    const auto width = static_cast<std::size_t>(dims.x);
    each_row(dims, [&](int y, int z) {
        const std::size_t begin = voxel_index({0, y, z}, dims);
        std::uint8_t* row = grid.row(y, z);
        for (std::size_t x = 0; x < width; ++x) {
            row[x] = kinds[begin + x] == kind ? distance_reach : 0;
        }
    });
    grid.spread();
    each_row(dims, [&](int y, int z) {
        const std::size_t begin = voxel_index({0, y, z}, dims);
        const std::uint8_t* row = grid.row(y, z);
        for (std::size_t x = 0; x < width; ++x) {
            distance[begin + x] = kinds[begin + x] == kind ? row[x] : distance[begin + x];
        }
    });
}

void CubesAhead::take(glm::ivec3 dims, std::span<const std::uint8_t> kinds) {
    dims_ = checked_count(dims, kinds) == 0 ? glm::ivec3(0) : dims;
    along_known_ = {};
    texels_.resize(kinds.size());
    const Rows rows(dims_);
    kinds_.resize(rows.bytes(dims_.z));
    layers_.resize(rows.bytes(2));
    each_row(dims_, [&](int y, int z) {
        rows.take_kinds(&kinds[voxel_index({0, y, z}, dims_)], rows.row(kinds_.data(), y, z));
    });
}

std::span<const std::uint8_t> CubesAhead::texels(const glm::bvec3& up) {
    const Rows rows(dims_);
    const std::size_t side = up.x ? 1 : 0;
    std::vector<std::uint8_t>& along = along_[side];
    if (!along_known_[side]) {
        along = kinds_;
        find_along(dims_, rows, kinds_.data(), up.x ? 1 : -1, along.data());
        along_known_[side] = true;
    }
    cubes_one_way(dims_, rows, kinds_.data(), along.data(), up, layers_.data(),
                  [&](int y, int z, const std::uint8_t* row) {
                      rows.give_texels(row, &texels_[voxel_index({0, y, z}, dims_)]);
                  });
    return texels_;
}

}  // namespace viscera::volume
