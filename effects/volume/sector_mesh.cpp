#include "effects/volume/sector_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace viscera::volume {
namespace {

using std::numbers::pi;
constexpr double facet = pi / 32.0;  // angle of a facet at most

/// The range as a bent box with the axes radius, angle and third coordinate.
class BentBox {
  public:
    BentBox(const Space& space, const Space::Range& range)
        : kind_(space.shape.kind),
          r_(axis(range, space.shape.radius_axis())),
          angle_(axis(range, space.shape.angle_axis())),
          third_(axis(range, kind_ == VolumeKind::spherical ? 1 : 2)) {
        full_ = angle_.y - angle_.x >= 2.0 * pi - 1e-9;
        parts_ = {1, facets(angle_), kind_ == VolumeKind::spherical ? facets(third_) : 1};
        const double half = 0.5 * (angle_.y - angle_.x) / parts_[1];
        double outwards = std::cos(half);
        if (kind_ == VolumeKind::spherical) {
            outwards *= std::cos(0.5 * (third_.y - third_.x) / parts_[2]);
            // Cones that bulge outwards: their facets would cut what they hold.
            const auto widened = [&](double latitude) {
                return std::atan(std::tan(latitude) * std::cos(half));
            };
            third_.x = third_.x > 0.0 ? widened(third_.x) : third_.x;
            third_.y = third_.y < 0.0 ? widened(third_.y) : third_.y;
        }
        r_.y *= (1.0 + 1e-6) / outwards;
        r_.x *= 1.0 - 1e-6;
    }

    [[nodiscard]] MeshData mesh() const {
        MeshData mesh;
        const glm::ivec3 n(parts_[0] + 1, parts_[1] + 1, parts_[2] + 1);
        for (int k = 0; k < n.z; ++k) {
            for (int j = 0; j < n.y; ++j) {
                for (int i = 0; i < n.x; ++i) {
                    mesh.positions.emplace_back(place({i, full_ && j == parts_[1] ? 0 : j, k}));
                }
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            if (axis == 1 && full_) {
                continue;
            }
            add_face(mesh, axis, true);
            if (axis != 0 || r_.x > 0.0) {
                add_face(mesh, axis, false);
            }
        }
        return mesh;
    }

  private:
    static glm::dvec2 axis(const Space::Range& range, int a) { return {range.low[a], range.high[a]}; }
    static int facets(const glm::dvec2& range) {
        return std::max(static_cast<int>(std::ceil((range.y - range.x) / facet - 1e-9)), 1);
    }
    [[nodiscard]] glm::dvec3 place(const glm::ivec3& i) const {
        const double r = i.x == 0 ? r_.x : r_.y;
        const double angle = std::lerp(angle_.x, angle_.y, static_cast<double>(i.y) / parts_[1]);
        const double third = std::lerp(third_.x, third_.y, static_cast<double>(i.z) / parts_[2]);
        double across = kind_ == VolumeKind::spherical ? r * std::cos(third) : r;
        across = across < 1e-12 ? 0.0 : across;  // one place on the axis, whatever the angle
        return {across * std::cos(angle), across * std::sin(angle),
                kind_ == VolumeKind::spherical ? r * std::sin(third) : third};
    }
    void add_face(MeshData& mesh, int axis, bool high) const {
        const int b = (axis + 1) % 3;
        const int c = (axis + 2) % 3;
        const auto index = [&](int u, int v) {
            glm::ivec3 i(0);
            i[axis] = high ? parts_.at(static_cast<std::size_t>(axis)) : 0;
            i[b] = u;
            i[c] = v;
            return static_cast<std::uint32_t>(i.x + (parts_[0] + 1) * (i.y + (parts_[1] + 1) * i.z));
        };
        for (int v = 0; v < parts_.at(static_cast<std::size_t>(c)); ++v) {
            for (int u = 0; u < parts_.at(static_cast<std::size_t>(b)); ++u) {
                std::array<std::uint32_t, 4> q{index(u, v), index(u + 1, v), index(u + 1, v + 1),
                                               index(u, v + 1)};
                if (!high) {
                    std::swap(q[1], q[3]);
                }
                for (const auto& [a, b2, c2] : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
                    const glm::vec3& p = mesh.positions[a];
                    const glm::vec3& p1 = mesh.positions[b2];
                    const glm::vec3& p2 = mesh.positions[c2];
                    if (p != p1 && p1 != p2 && p2 != p) {  // not at the axis
                        mesh.indices.insert(mesh.indices.end(), {a, b2, c2});
                    }
                }
            }
        }
    }

    VolumeKind kind_;
    glm::dvec2 r_;
    glm::dvec2 angle_;
    glm::dvec2 third_;
    bool full_ = false;
    std::array<int, 3> parts_{};
};

}  // namespace

MeshData sector_mesh(const Space& space, const Space::Range& range) {
    return BentBox(space, range).mesh();
}

}  // namespace viscera::volume
