#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/generate/heart.h"
#include "assets/generate/random.h"
#include "assets/generate/vessel_tree.h"

namespace viscera::assets {

/// Lays courses of vessels over a heart, none nearer to another than the lumens need.
class Grower {
  public:
    static constexpr double step_mm = 1.2;
    static constexpr double clearance_mm = 2.6;  ///< between the centrelines of different vessels

    Grower(const Heart& heart, std::uint64_t seed) : heart_(heart), random_(seed) {}

    /// Adds a course as it is.
    int add(Course course);
    /// A course over the surface through way points (beta, phi) [deg], gently tortuous; the first way point
    /// is the parent's point itself. Cut short where it would run into another vessel; -1 when less than
    /// 8 mm is left.
    int along(const std::string& name, int parent, std::size_t parent_point,
              const std::vector<glm::dvec2>& way, double tip_weight, double tortuosity_mm);
    /// A twig that leaves its parent at angle_deg (positive: to the left, seen from outside) and wanders
    /// over the surface, bending back to the parent's own direction. -1 when there is no room for 8 mm.
    int twig(const std::string& name, int parent, std::size_t parent_point, double angle_deg,
             double length_mm, double tip_weight);
    /// A course that dives from the surface into the muscle, slanting towards the apex.
    int septal(const std::string& name, int parent, std::size_t parent_point, double length_mm,
               double tip_weight);
    /// Twigs on alternating sides along a course; returns those that took root.
    std::vector<int> twigs_along(int parent, int count, double tip_weight);

    [[nodiscard]] const std::vector<Course>& courses() const { return courses_; }
    [[nodiscard]] const Course& course(int index) const { return courses_[static_cast<std::size_t>(index)]; }
    /// Index of the point of a course at a fraction in [0, 1] of its length, moved on to the next point that
    /// is 4 mm away from its other branchings.
    [[nodiscard]] std::size_t free_point(int course, double fraction) const;
    [[nodiscard]] Random& random() { return random_; }

  private:
    [[nodiscard]] std::size_t clear_points(int parent, std::size_t parent_point,
                                           const std::vector<glm::dvec3>& points) const;
    int add_if_clear(const std::string& name, int parent, std::size_t parent_point,
                     std::vector<glm::dvec3> points, double tip_weight);

    Heart heart_;
    Random random_;
    std::vector<Course> courses_;
};

}  // namespace viscera::assets
