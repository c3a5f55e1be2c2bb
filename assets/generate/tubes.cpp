#include "assets/generate/tubes.h"

#include <algorithm>
#include <cmath>

namespace viscera::assets {

void draw_tube(const Tube& tube, double weight, const ConeBeam& beam, GrayImage& image) {
    std::vector<glm::dvec3> projected;
    glm::dvec2 low(1e9);
    glm::dvec2 high(-1e9);
    for (const Tube::Point& point : tube.points) {
        const glm::dvec3 q = beam.project(point.position_mm);
        projected.push_back(q);
        low = glm::min(low, glm::dvec2(q) - q.z * point.radius_mm);
        high = glm::max(high, glm::dvec2(q) + q.z * point.radius_mm);
    }
    const int left = std::max(0, static_cast<int>(std::floor(low.x)));
    const int top = std::max(0, static_cast<int>(std::floor(low.y)));
    const int right = std::min(image.width - 1, static_cast<int>(std::ceil(high.x)));
    const int bottom = std::min(image.height - 1, static_cast<int>(std::ceil(high.y)));
    if (left > right || top > bottom) {
        return;
    }
    GrayImage longest(right - left + 1, bottom - top + 1);
    for (std::size_t i = 1; i < tube.points.size(); ++i) {
        const glm::dvec2 a(projected[i - 1]);
        const glm::dvec2 along = glm::dvec2(projected[i]) - a;
        const double span = glm::dot(along, along);
        const glm::dvec3 axis = glm::normalize(tube.points[i].position_mm - tube.points[i - 1].position_mm);
        const glm::dvec3 sight = glm::normalize(tube.points[i].position_mm - beam.source());
        const double slant = 1.0 / std::max(0.5, glm::length(glm::cross(axis, sight)));
        const double reach = std::max(projected[i - 1].z * tube.points[i - 1].radius_mm,
                                      projected[i].z * tube.points[i].radius_mm);
        const int x0 = std::max(left, static_cast<int>(std::floor(std::min(a.x, a.x + along.x) - reach)));
        const int x1 = std::min(right, static_cast<int>(std::ceil(std::max(a.x, a.x + along.x) + reach)));
        const int y0 = std::max(top, static_cast<int>(std::floor(std::min(a.y, a.y + along.y) - reach)));
        const int y1 = std::min(bottom, static_cast<int>(std::ceil(std::max(a.y, a.y + along.y) + reach)));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const glm::dvec2 from_a = glm::dvec2(x, y) - a;
                const double t = span > 0.0 ? std::clamp(glm::dot(from_a, along) / span, 0.0, 1.0) : 0.0;
                const double magnification = glm::mix(projected[i - 1].z, projected[i].z, t);
                const double radius = glm::mix(tube.points[i - 1].radius_mm, tube.points[i].radius_mm, t);
                const double off = glm::length(from_a - t * along) / magnification;
                if (off < radius) {
                    float& thickness = longest.at(x - left, y - top);
                    const double density = glm::mix(tube.points[i - 1].density, tube.points[i].density, t);
                    const double here = 2.0 * std::sqrt(radius * radius - off * off) * slant * density;
                    thickness = std::max(thickness, static_cast<float>(here));
                }
            }
        }
    }
    for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
            image.at(x, y) += static_cast<float>(weight) * longest.at(x - left, y - top);
        }
    }
}

}  // namespace viscera::assets
