#include "effects/volume/brick_distances.h"

#include <algorithm>
#include <array>
#include <experimental/simd>

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
using Bricks = std::experimental::native_simd<std::uint8_t>;
constexpr int lanes = static_cast<int>(Bricks::size());

/// Rows of bricks in memory. The room before and behind each of them holds what limits nothing: the kind of
/// the brick at that end, or the greatest size. So ends need no care.
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
    /// As texels have them, so that a size only has to be added.
    void copy_kinds(const std::uint8_t* kinds, std::uint8_t* row) const {
        const int count = dims_.x;  // a member could be among the bytes written, for all the compiler knows
        for (int x = 0; x < count; ++x) {
            row[x] = static_cast<std::uint8_t>(kind_step * kinds[x]);
        }
        std::fill_n(row - room, room, row[0]);
        std::fill_n(row + dims_.x, padded_ - dims_.x + room, row[dims_.x - 1]);
    }
    /// What lies behind a row's last brick in the same lanes is room, too.
    void clear_end(std::uint8_t* sizes) const {
        std::fill_n(sizes + dims_.x, padded_ - dims_.x, std::uint8_t{distance_reach});
    }

  private:
    static constexpr int room = std::max(lanes, distance_reach / 2 + 1);  ///< as far as one step looks

    glm::ivec3 dims_;
    int padded_;  ///< bricks of a row in whole lanes
    int stride_;
};

Bricks load(const std::uint8_t* from) {
    return {from, std::experimental::element_aligned};
}

void store(const Bricks& bricks, std::uint8_t* to) {
    bricks.copy_to(to, std::experimental::element_aligned);
}

/// Bricks from each brick to the next one of another kind in its row, up (`step` 1) or down (-1) the row.
/// Ways of 1, 2, 4, 8 and 16 find it for all bricks at once; all rows are done with one way before the next,
/// since what was only just written is slow to read again.
void find_along(const glm::ivec3& dims, const Rows& rows, const std::uint8_t* kinds, int step,
                std::uint8_t* along) {
    each_row(dims, [&](int y, int z) {
        const std::uint8_t* own = rows.row(kinds, y, z);
        std::uint8_t* row = rows.row(along, y, z);
        rows.each([&](int x) {
            Bricks size(distance_reach);
            where(load(own + x) != load(own + x + step), size) = 1;
            store(size, row + x);
        });
    });
    for (int way = 1; way <= distance_reach / 2 + 1; way *= 2) {
        each_row(dims, [&](int y, int z) {
            std::uint8_t* row = rows.row(along, y, z);
            rows.each([&](int x) {
                const Bricks ahead = load(row + x + step * way) + static_cast<std::uint8_t>(way);
                store(min(load(row + x), ahead), row + x);
            });
        });
    }
}

/// A row of bricks: their kinds, and the sizes of the cubes that begin at them.
struct Row {
    const std::uint8_t* kinds;
    const std::uint8_t* sizes;
};

/// Sizes of some bricks of a row where they are of the kinds given, else 0.
Bricks sizes_of(const Bricks& kinds, const Row& row, int x) {
    Bricks sizes = load(row.sizes + x);
    where(load(row.kinds + x) != kinds, sizes) = 0;
    return sizes;
}

/// Sizes for rays that go along each axis as `up` says. A cube ends at the row's next brick of another kind,
/// and is larger by one than the least of those that begin at the six neighbours ahead in other rows. Bricks
/// are visited from the far end, so that these are known; two layers of sizes are kept.
template <class Write>
void sizes_one_way(const glm::ivec3& dims, const Rows& rows, const std::uint8_t* kinds,
                   const std::uint8_t* along, const glm::bvec3& up, std::uint8_t* layers,
                   const Write& write) {
    const auto flip = [](int ahead, int count, bool upwards) { return upwards ? ahead : count - 1 - ahead; };
    const auto row_of = [&](int y, int z) {
        return Row{rows.row(kinds, flip(y, dims.y, up.y), flip(z, dims.z, up.z)), rows.row(layers, y, z % 2)};
    };
    const int step = up.x ? 1 : -1;
    std::array<Row, 3> ahead{};
    for (int z = dims.z - 1; z >= 0; --z) {
        for (int y = dims.y - 1; y >= 0; --y) {
            std::size_t known = 0;
            for (const glm::ivec2& next :
                 {glm::ivec2(y, z + 1), glm::ivec2(y + 1, z + 1), glm::ivec2(y + 1, z)}) {
                if (next.x < dims.y && next.y < dims.z) {
                    ahead[known++] = row_of(next.x, next.y);
                }
            }
            const Row own = row_of(y, z);
            const glm::ivec2 place(flip(y, dims.y, up.y), flip(z, dims.z, up.z));
            const std::uint8_t* limit = rows.row(along, place.x, place.y);
            std::uint8_t* sizes = rows.row(layers, y, z % 2);
            rows.each([&](int x) {
                const Bricks kind = load(own.kinds + x);
                Bricks least = load(limit + x) - 1;
                for (const Row& row : std::span(ahead).first(known)) {
                    least = min(least, min(sizes_of(kind, row, x), sizes_of(kind, row, x + step)));
                }
                store(least + 1, sizes + x);
            });
            rows.clear_end(sizes);
            write(place.x, place.y, own);
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
    sizes_.assign(rows.bytes(2), distance_reach);
    each_row(dims_, [&](int y, int z) {
        rows.copy_kinds(&kinds[voxel_index({0, y, z}, dims_)], rows.row(kinds_.data(), y, z));
    });
}

std::span<const std::uint8_t> CubesAhead::texels(const glm::bvec3& up) {
    const Rows rows(dims_);
    const std::size_t side = up.x ? 1 : 0;
    std::vector<std::uint8_t>& along = along_[side];
    if (!along_known_[side]) {
        along.assign(rows.bytes(dims_.z), distance_reach);
        find_along(dims_, rows, kinds_.data(), up.x ? 1 : -1, along.data());
        along_known_[side] = true;
    }
    sizes_one_way(dims_, rows, kinds_.data(), along.data(), up, sizes_.data(),
                  [&](int y, int z, const Row& row) {
                      std::uint8_t* target = &texels_[voxel_index({0, y, z}, dims_)];
                      const int count = dims_.x;  // as in copy_kinds()
                      for (int x = 0; x < count; ++x) {
                          target[x] = static_cast<std::uint8_t>(row.kinds[x] + row.sizes[x]);
                      }
                  });
    return texels_;
}

}  // namespace viscera::volume
