#include "tests/reference/volume_sector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace viscera::reference {
namespace {

using std::numbers::pi;

/// Roots of a t^2 + 2 b t + c.
void add_roots(double a, double b, double c, std::vector<double>& roots) {
    const double disc = b * b - a * c;
    if (!(disc >= 0.0)) {
        return;
    }
    const double q = -(b + std::copysign(std::sqrt(disc), b));
    if (a != 0.0) {
        roots.push_back(q / a);
    }
    if (q != 0.0) {
        roots.push_back(c / q);
    }
}

void add_root(double height, double rise, std::vector<double>& roots) {
    if (rise != 0.0) {
        roots.push_back(-height / rise);
    }
}

}  // namespace

SectorRange whole(const VolumeShape& shape) {
    const ShapeAxes axes = axes_of(shape, glm::ivec3(2));
    return {axes.first, axes.first + axes.extent};
}

bool inside(const VolumeShape& shape, const SectorRange& range, const glm::dvec3& frame) {
    const glm::dvec3 c = from_frame(shape, frame);
    const int angle = shape.angle_axis();
    for (int a = 0; a < 3; ++a) {
        if (a != angle && (c[a] < range.low[a] || c[a] > range.high[a])) {
            return false;
        }
    }
    const double turn = range.high[angle] - range.low[angle];
    if (turn >= 2.0 * pi - 1e-9) {
        return true;
    }
    const double from_low = c[angle] - range.low[angle];
    return from_low - 2.0 * pi * std::floor(from_low / (2.0 * pi)) <= turn;
}

std::vector<Interval> intersect(const VolumeShape& shape, const SectorRange& range, const glm::dvec3& o,
                                const glm::dvec3& direction) {
    // From the closest approach to the origin, so that no distance costs digits.
    const double size = glm::length(direction);
    const glm::dvec3 d = direction / size;
    double t0 = -glm::dot(o, d);
    glm::dvec3 p = o + t0 * d;
    const double again = -glm::dot(p, d);
    p += again * d;
    t0 += again;

    const bool spherical = shape.kind == VolumeKind::spherical;
    const int radius = shape.radius_axis();
    std::vector<double> roots;
    for (const double r : {range.low[radius], range.high[radius]}) {
        const glm::dvec3 mask(1.0, 1.0, spherical ? 1.0 : 0.0);
        add_roots(glm::dot(d * mask, d), glm::dot(p * mask, d), glm::dot(p * mask, p) - r * r, roots);
    }
    for (const double angle : {range.low[shape.angle_axis()], range.high[shape.angle_axis()]}) {
        const glm::dvec2 normal(-std::sin(angle), std::cos(angle));
        add_root(glm::dot(normal, glm::dvec2(p)), glm::dot(normal, glm::dvec2(d)), roots);
    }
    const int third = spherical ? 1 : 2;
    for (const double end : {range.low[third], range.high[third]}) {
        if (spherical) {
            const double c = std::cos(end) * std::cos(end);
            const double s = std::sin(end) * std::sin(end);
            const auto form = [&](const glm::dvec3& u, const glm::dvec3& v) {
                return c * u.z * v.z - s * (u.x * v.x + u.y * v.y);
            };
            add_roots(form(d, d), form(p, d), form(p, p), roots);
        } else {
            add_root(p.z - end, d.z, roots);
        }
    }
    std::ranges::sort(roots);
    std::vector<Interval> found;
    for (std::size_t i = 0; i + 1 < roots.size(); ++i) {
        const double begin = roots[i];
        const double end = roots[i + 1];
        if (!(end > begin) || !inside(shape, range, p + 0.5 * (begin + end) * d)) {
            continue;
        }
        const Interval stretch{(begin + t0) / size, (end + t0) / size};
        if (!found.empty() && stretch.begin - found.back().end <= 1e-14 * (end - begin) / size) {
            found.back().end = stretch.end;
        } else {
            found.push_back(stretch);
        }
    }
    return found;
}

std::vector<Interval> intersect(const VolumeShape& shape, const SectorRange& range,
                                const glm::dmat4& frame_to_world, const Ray& ray) {
    const glm::dmat4 to_frame = glm::inverse(frame_to_world);
    return intersect(shape, range, to_frame * glm::dvec4(ray.origin_mm, 1.0),
                     to_frame * glm::dvec4(ray.direction, 0.0));
}

double sector_value(const Volume& volume, const glm::dvec3& frame) {
    const VolumeShape& shape = volume.grid.shape;
    const ShapeAxes axes = axes_of(shape, volume.grid.dims);
    const glm::dvec3 place = (from_frame(shape, frame) - axes.first) / axes.step;
    const glm::dvec3 low = glm::floor(place);
    const glm::dvec3 t = place - low;
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        glm::ivec3 voxel(low);
        double weight = 1.0;
        for (int a = 0; a < 3; ++a) {
            const bool up = ((corner >> a) & 1) != 0;
            const int n = volume.grid.dims[a];
            const int i = voxel[a] + (up ? 1 : 0);
            weight *= up ? t[a] : 1.0 - t[a];
            voxel[a] = a == shape.wrap_axis() ? ((i % n) + n) % n : std::clamp(i, 0, n - 1);
        }
        sum += weight * volume.value_of(volume.stored(voxel));
    }
    return sum;
}

double integral(const Interval& interval, int parts, const std::function<double(double)>& f) {
    static constexpr std::array<double, 4> nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                                 0.9602898564975363};
    static constexpr std::array<double, 4> weights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                   0.1012285362903763};
    const double half = 0.5 * interval.length() / parts;
    double sum = 0.0;
    for (int i = 0; i < parts; ++i) {
        const double middle = interval.begin + half * (2 * i + 1);
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            sum += weights[k] * (f(middle - half * nodes[k]) + f(middle + half * nodes[k]));
        }
    }
    return half * sum;
}

}  // namespace viscera::reference
