#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "effects/tissue/texel_map.h"

namespace viscera::tissue {

/// What came of holding vertices, besides the triangles that are held.
struct HoldResult {
    std::uint64_t useless = 0;           ///< numbers that are no vertex
    std::uint64_t connecting = 0;        ///< triangles that touch them but connect
    float shortest_uv_perimeter = 0.0F;  ///< of those
};

/// By triangle: 1 where it connects parts that lie apart in the texture, as triangles do that a simulation
/// has put between them; painting on them would paint on whatever lies between. Such are those with a longer
/// perimeter in the texture than `max_uv_perimeter`, and those that span charts: each is more than twice
/// as long in the texture, and twice as stretched, as some triangle at each of its corners, and without them
/// its corners hang apart. So neither the scale of a chart tells, nor a row of narrower or larger triangles.
[[nodiscard]] std::vector<char> find_connecting(const TexelSurface& surface, double max_uv_perimeter);

/// Which triangles a tool holds by some vertices: all that touch them, but no connecting ones.
class HeldTriangles {
  public:
    /// `vertex_count`: vertices that a host knows by number, the first ones.
    HeldTriangles(const TexelSurface& surface, std::size_t vertex_count, double max_uv_perimeter);

    /// Marks the triangles that touch these vertices, or others at the same places. Allocates nothing.
    HoldResult hold(std::span<const float> vertices);
    /// By triangle: 1 held, 0 not.
    [[nodiscard]] std::span<const char> held() const { return held_; }
    [[nodiscard]] std::size_t count() const { return count_; }

    /// By triangle: whether it connects, and so is never held.
    [[nodiscard]] std::span<const char> connecting() const { return connecting_; }

  private:
    std::size_t vertex_count_;
    std::vector<std::uint32_t> place_;
    std::vector<std::uint32_t> first_;  ///< by place, and the end: into triangles_
    std::vector<std::uint32_t> triangles_;
    std::vector<float> uv_perimeter_;  ///< by triangle
    std::vector<char> connecting_;
    std::vector<char> held_;
    std::size_t count_ = 0;
};

}  // namespace viscera::tissue
