#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/mesh_data.h"

namespace viscera::tissue {

/// What came of holding vertices, besides the triangles that are held.
struct HoldResult {
    std::uint64_t useless = 0;           ///< numbers that are no vertex
    std::uint64_t connecting = 0;        ///< triangles that touch them but connect
    float shortest_uv_perimeter = 0.0F;  ///< of those
};

/// Which triangles a tool holds by some vertices: all that touch them, but no connecting ones. Those are
/// triangles that a simulation has put between parts that lie apart in the texture; painting on them would
/// paint on whatever lies between.
class HeldTriangles {
  public:
    /// `place`: per vertex the vertex that stands for its place. `max_uv_perimeter`: longer triangles
    /// connect.
    HeldTriangles(const MeshData& mesh, std::span<const std::uint32_t> place, double max_uv_perimeter);

    /// Marks the triangles that touch these vertices, or others at the same places. Allocates nothing.
    HoldResult hold(std::span<const float> vertices);
    /// By triangle: 1 held, 0 not.
    [[nodiscard]] std::span<const char> held() const { return held_; }
    [[nodiscard]] std::size_t count() const { return count_; }

    /// By triangle: whether it connects, and so is never held.
    [[nodiscard]] std::span<const char> connecting() const { return connecting_; }

  private:
    std::vector<std::uint32_t> place_;
    std::vector<std::uint32_t> first_;  ///< by place, and the end: into triangles_
    std::vector<std::uint32_t> triangles_;
    std::vector<float> uv_perimeter_;  ///< by triangle
    std::vector<char> connecting_;
    std::vector<char> held_;
    std::size_t count_ = 0;
};

}  // namespace viscera::tissue
