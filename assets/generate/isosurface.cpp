#include "assets/generate/isosurface.h"

#include <numeric>
#include <unordered_map>

#include "assets/generate/vessel_field.h"

namespace viscera::assets {
namespace {

constexpr int cell_edges = 12;
constexpr std::uint32_t no_vertex = 0xffffffffU;
using EdgeVertices = std::array<std::uint32_t, cell_edges>;  // the vertex that each crossed edge belongs to

glm::ivec3 unit(int axis) {
    glm::ivec3 v(0);
    v[axis] = 1;
    return v;
}

/// Edge of a cell: parallel to axis, offset by 0 or 1 along the next axis and the one after it.
int edge_index(int axis, int offset_next, int offset_after) {
    return axis * 4 + offset_next + 2 * offset_after;
}

/// The sampled band.
class Samples {
  public:
    Samples(const std::function<double(const glm::dvec3&)>& field, const std::vector<glm::ivec3>& blocks,
            double spacing) {
        for (const glm::ivec3& block : blocks) {
            std::vector<double>& values = blocks_[grid_key(block)];
            values.reserve(block_size * block_size * block_size);
            for (int i = 0; i < block_size * block_size * block_size; ++i) {
                const glm::ivec3 local(i % block_size, i / block_size % block_size,
                                       i / (block_size * block_size));
                values.push_back(field(glm::dvec3(block * block_size + local) * spacing));
            }
        }
    }
    [[nodiscard]] double at(const glm::ivec3& p) const {
        const auto found = blocks_.find(grid_key(p >> 3));
        if (found == blocks_.end()) {
            return 1.0;
        }
        const glm::ivec3 local = p & (block_size - 1);
        return found
            ->second[static_cast<std::size_t>(local.x + block_size * (local.y + block_size * local.z))];
    }

  private:
    static_assert(block_size == 8);
    std::unordered_map<std::uint64_t, std::vector<double>> blocks_;
};

using Corners = std::array<double, 8>;  // bit 0: x, bit 1: y, bit 2: z

double corner_value(const Corners& corners, const glm::ivec3& offset) {
    return corners[static_cast<std::size_t>(offset.x + 2 * offset.y + 4 * offset.z)];
}

/// Groups the crossed edges of a cell into pieces of surface: joins the edges that share a face segment.
class Pieces {
  public:
    explicit Pieces(const Corners& corners) {
        std::iota(parent_.begin(), parent_.end(), 0);
        for (int normal = 0; normal < 3; ++normal) {
            for (int side = 0; side < 2; ++side) {
                join_face(corners, normal, side);
            }
        }
    }
    [[nodiscard]] int root(int edge) const {
        while (parent_[static_cast<std::size_t>(edge)] != edge) {
            edge = parent_[static_cast<std::size_t>(edge)];
        }
        return edge;
    }

  private:
    void join(int a, int b) { parent_[static_cast<std::size_t>(root(a))] = root(b); }

    void join_face(const Corners& corners, int normal, int side) {
        const int u = (normal + 1) % 3;
        const int v = (normal + 2) % 3;
        const glm::ivec3 base = unit(normal) * side;
        const double a = corner_value(corners, base);
        const double b = corner_value(corners, base + unit(u));
        const double c = corner_value(corners, base + unit(u) + unit(v));
        const double d = corner_value(corners, base + unit(v));
        // Around the face: a-b, b-c, c-d, d-a.
        const std::array<int, 4> edges{edge_index(u, 0, side), edge_index(v, side, 1), edge_index(u, 1, side),
                                       edge_index(v, side, 0)};
        const std::array<bool, 4> crossed{(a < 0) != (b < 0), (b < 0) != (c < 0), (c < 0) != (d < 0),
                                          (d < 0) != (a < 0)};
        if (crossed[0] && crossed[1] && crossed[2] && crossed[3]) {
            // The saddle of the bilinear field tells which pair of corners is joined across the face.
            const double saddle = (a * c - b * d) / (a + c - b - d);
            const bool ac_joined = (saddle < 0) == (a < 0);
            join(edges[0], edges[ac_joined ? 1U : 3U]);
            join(edges[2], edges[ac_joined ? 3U : 1U]);
            return;
        }
        int first = -1;
        for (std::size_t e = 0; e < 4; ++e) {
            if (crossed[e] && first < 0) {
                first = edges[e];
            } else if (crossed[e]) {
                join(first, edges[e]);
            }
        }
    }

    std::array<int, cell_edges> parent_{};
};

/// Vertices of one cell, one per piece, each at the mean of its edges' crossings.
EdgeVertices add_cell_vertices(const Corners& corners, const glm::ivec3& cell, double spacing,
                               std::vector<glm::dvec3>& vertices) {
    EdgeVertices result{};
    result.fill(no_vertex);
    const Pieces pieces(corners);
    std::array<glm::dvec3, cell_edges> sums{};
    std::array<int, cell_edges> counts{};
    std::array<int, cell_edges> roots{};
    roots.fill(-1);
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 4; ++k) {
            const glm::ivec3 from = unit((axis + 1) % 3) * (k & 1) + unit((axis + 2) % 3) * (k >> 1);
            const double a = corner_value(corners, from);
            const double b = corner_value(corners, from + unit(axis));
            if ((a < 0) == (b < 0)) {
                continue;
            }
            const int edge = axis * 4 + k;
            const auto root = static_cast<std::size_t>(pieces.root(edge));
            roots[static_cast<std::size_t>(edge)] = static_cast<int>(root);
            sums[root] += glm::dvec3(cell + from) + glm::dvec3(unit(axis)) * (a / (a - b));
            ++counts[root];
        }
    }
    for (std::size_t root = 0; root < cell_edges; ++root) {
        if (counts[root] == 0) {
            continue;
        }
        const auto vertex = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(sums[root] / static_cast<double>(counts[root]) * spacing);
        for (std::size_t edge = 0; edge < cell_edges; ++edge) {
            if (roots[edge] == static_cast<int>(root)) {
                result[edge] = vertex;
            }
        }
    }
    return result;
}

struct Cell {
    glm::ivec3 position{0};
    Corners corners{};
    EdgeVertices vertices{};
};

/// Every cell that the surface crosses, with its vertices.
std::vector<Cell> crossed_cells(const Samples& samples, const std::vector<glm::ivec3>& blocks, double spacing,
                                std::vector<glm::dvec3>& vertices) {
    std::vector<Cell> cells;
    for (const glm::ivec3& block : blocks) {
        for (int i = 0; i < block_size * block_size * block_size; ++i) {
            const glm::ivec3 local(i % block_size, i / block_size % block_size,
                                   i / (block_size * block_size));
            Cell cell{.position = block * block_size + local};
            int inside = 0;
            for (int c = 0; c < 8; ++c) {
                const glm::ivec3 offset(c & 1, (c >> 1) & 1, c >> 2);
                const double value = samples.at(cell.position + offset);
                cell.corners[static_cast<std::size_t>(c)] = value;
                inside += value < 0 ? 1 : 0;
            }
            if (inside > 0 && inside < 8) {
                cell.vertices = add_cell_vertices(cell.corners, cell.position, spacing, vertices);
                cells.push_back(cell);
            }
        }
    }
    return cells;
}

}  // namespace

QuadMesh extract_isosurface(const std::function<double(const glm::dvec3&)>& field,
                            const std::vector<glm::ivec3>& blocks, double spacing) {
    const Samples samples(field, blocks, spacing);
    QuadMesh mesh;
    const std::vector<Cell> cells = crossed_cells(samples, blocks, spacing, mesh.vertices);
    std::unordered_map<std::uint64_t, std::size_t> cell_at;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        cell_at[grid_key(cells[i].position)] = i;
    }
    // One quad around each crossed grid edge, which the cell at its upper side owns.
    for (const Cell& cell : cells) {
        for (int axis = 0; axis < 3; ++axis) {
            const int next = (axis + 1) % 3;
            const int after = (axis + 2) % 3;
            const double a = cell.corners[0];
            const double b = corner_value(cell.corners, unit(axis));
            if ((a < 0) == (b < 0)) {
                continue;
            }
            // Counter-clockwise around the axis; the edge's place in each of the four cells.
            const std::array<glm::ivec2, 4> turn{glm::ivec2(0, 0), {1, 0}, {1, 1}, {0, 1}};
            std::array<std::uint32_t, 4> quad{};
            for (std::size_t k = 0; k < 4; ++k) {
                const glm::ivec3 neighbour = cell.position - unit(next) * turn[k].x - unit(after) * turn[k].y;
                const Cell& around = cells[cell_at.at(grid_key(neighbour))];
                quad[k] = around.vertices[static_cast<std::size_t>(edge_index(axis, turn[k].x, turn[k].y))];
            }
            if (a > 0) {
                std::swap(quad[1], quad[3]);
            }
            mesh.quads.push_back(quad);
        }
    }
    return mesh;
}

}  // namespace viscera::assets
