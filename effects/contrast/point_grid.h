#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace viscera::contrast {

/// Points sorted into cubic cells, to find those near a place.
class PointGrid {
  public:
    PointGrid() = default;

    /// Takes the points `chosen` out of `positions_mm`; all finite. cell_mm > 0.
    PointGrid(std::span<const glm::vec3> positions_mm, std::span<const std::uint32_t> chosen, double cell_mm)
        : cell_mm_(cell_mm) {
        entries_.reserve(chosen.size());
        for (const std::uint32_t point : chosen) {
            entries_.push_back({cell_of(glm::dvec3(positions_mm[point])), positions_mm[point], point});
        }
        std::ranges::sort(entries_, {}, &Entry::cell);
    }

    /// Calls visit(point) for every point within radius_mm <= cell_mm of a place.
    template <class Visit>
    void for_each_near(const glm::dvec3& place, double radius_mm, Visit&& visit) const {
        const Cell centre = cell_of(place);
        for (const double x : {-1.0, 0.0, 1.0}) {
            for (const double y : {-1.0, 0.0, 1.0}) {
                // Cells that differ in z only stand together.
                const Cell low{centre[0] + x, centre[1] + y, centre[2] - 1.0};
                const Cell high{centre[0] + x, centre[1] + y, centre[2] + 1.0};
                for (auto at = std::ranges::lower_bound(entries_, low, {}, &Entry::cell);
                     at != entries_.end() && at->cell <= high; ++at) {
                    if (const glm::dvec3 apart = glm::dvec3(at->position_mm) - place;
                        glm::dot(apart, apart) <= radius_mm * radius_mm) {
                        visit(at->point);
                    }
                }
            }
        }
    }

  private:
    using Cell = std::array<double, 3>;  // whole numbers; doubles, so that no mesh is too large
    struct Entry {
        Cell cell{};
        glm::vec3 position_mm{0.0F};
        std::uint32_t point = 0;
    };

    [[nodiscard]] Cell cell_of(const glm::dvec3& p) const {
        return {std::floor(p.x / cell_mm_), std::floor(p.y / cell_mm_), std::floor(p.z / cell_mm_)};
    }

    std::vector<Entry> entries_;
    double cell_mm_ = 1.0;
};

}  // namespace viscera::contrast
