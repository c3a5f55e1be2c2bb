#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace viscera {

/// A connected piece of a surface laid on the plane at right angles to an axis that all its triangles face.
class FlatChart {
  public:
    explicit FlatChart(const glm::dvec3& axis);

    void add_triangle(const std::array<glm::dvec3, 3>& corners);
    /// An edge of the border. `ends`: numbers of the places where it begins and ends, by which neighbours are
    /// known.
    void add_border(const std::array<std::uint32_t, 2>& ends, const std::array<glm::dvec3, 2>& points);

    /// Neighbours do not cover each other, so its border crosses itself, or winds about a vertex more than
    /// once around, which a grid shows.
    [[nodiscard]] bool covers_itself() const { return border_crosses() || covers_twice(); }

  private:
    struct BorderEdge {
        std::array<std::uint32_t, 2> ends;
        glm::dvec2 a;
        glm::dvec2 b;
    };
    [[nodiscard]] glm::dvec2 flat(const glm::dvec3& p) const { return {glm::dot(p, u_), glm::dot(p, v_)}; }
    [[nodiscard]] static bool cross(const BorderEdge& one, const BorderEdge& other);
    [[nodiscard]] bool border_crosses() const;
    [[nodiscard]] bool covers_twice() const;

    glm::dvec3 u_;
    glm::dvec3 v_;
    std::vector<std::array<glm::dvec2, 3>> triangles_;
    std::vector<BorderEdge> border_;
};

}  // namespace viscera
