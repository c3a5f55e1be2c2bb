#include "tests/reference/volume_ray.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <thread>

namespace viscera::reference {
namespace {

/// Cuts the interval to where offset + s slope >= 0.
void cut(Interval& interval, double offset, double slope) {
    if (slope > 0.0) {
        interval.begin = std::max(interval.begin, -offset / slope);
    } else if (slope < 0.0) {
        interval.end = std::min(interval.end, -offset / slope);
    } else if (!(offset >= 0.0)) {
        interval.end = -std::numeric_limits<double>::infinity();
    }
}

}  // namespace

std::optional<Interval> intersect(const Ray& ray, const glm::dmat4& texture_to_world, const Limits& limits) {
    const glm::dmat4 world_to_texture = glm::inverse(texture_to_world);
    const glm::dvec3 origin(world_to_texture * glm::dvec4(ray.origin_mm, 1.0));
    const glm::dvec3 direction(world_to_texture * glm::dvec4(ray.direction, 0.0));
    Interval interval{limits.near_mm, limits.far_mm};
    for (int axis = 0; axis < 3; ++axis) {
        cut(interval, origin[axis] - limits.crop_min[axis], direction[axis]);
        cut(interval, limits.crop_max[axis] - origin[axis], -direction[axis]);
    }
    for (const glm::dvec4& plane : limits.clip_planes) {
        cut(interval, glm::dot(plane, glm::dvec4(ray.origin_mm, 1.0)),
            glm::dot(glm::dvec3(plane), ray.direction));
    }
    if (!(interval.begin < interval.end)) {
        return {};
    }
    return interval;
}

Ray ray_through(const View& view, const glm::dvec2& uv) {
    const glm::dvec2 ndc = 2.0 * uv - 1.0;
    const glm::dmat4 to_eye = glm::inverse(view.projection);
    const glm::dmat4 to_world = glm::inverse(view.view);
    const glm::dvec4 near = to_eye * glm::dvec4(ndc, -1.0, 1.0);
    const glm::dvec3 place = glm::dvec3(near) / near.w;
    if (view.orthographic) {
        const glm::dvec4 far = to_eye * glm::dvec4(ndc, 1.0, 1.0);
        const glm::dvec3 along = glm::normalize(glm::dvec3(far) / far.w - place);
        // Back to the plane of the eye, z = 0.
        const glm::dvec3 start = place - along * (place.z / along.z);
        return {glm::dvec3(to_world * glm::dvec4(start, 1.0)),
                glm::normalize(glm::dvec3(to_world * glm::dvec4(along, 0.0)))};
    }
    return {glm::dvec3(to_world[3]), glm::normalize(glm::dvec3(to_world * glm::dvec4(place, 0.0)))};
}

Ray pixel_ray(const View& view, int x, int y, int width, int height) {
    return ray_through(view, {(x + 0.5) / width, (y + 0.5) / height});
}

Buffer render(const View& view, int width, int height, const RayColour& colour, int threads) {
    Buffer picture(width, height, 4);
    std::atomic<int> next_row = 0;
    std::vector<std::exception_ptr> failures(static_cast<std::size_t>(std::max(threads, 1)));
    const auto work = [&](std::exception_ptr& failure) {
        try {
            for (int y = next_row++; y < height; y = next_row++) {
                for (int x = 0; x < width; ++x) {
                    const glm::dvec4 pixel = colour(pixel_ray(view, x, y, width, height));
                    for (int c = 0; c < 4; ++c) {
                        picture.at(x, y, c) = pixel[c];
                    }
                }
            }
        } catch (...) {
            failure = std::current_exception();
            next_row = height;
        }
    };
    {
        std::vector<std::jthread> helpers;
        for (std::size_t i = 1; i < failures.size(); ++i) {
            helpers.emplace_back(work, std::ref(failures[i]));
        }
        work(failures[0]);
    }
    for (const std::exception_ptr& failure : failures) {
        if (failure) {
            std::rethrow_exception(failure);
        }
    }
    return picture;
}

Buffer render(const View& view, int width, int height, const Field& field, const Limits& limits,
              const StretchColour& colour, const glm::dvec4& background, int threads) {
    return render(
        view, width, height,
        [&](const Ray& ray) {
            const std::optional<Interval> stretch = intersect(ray, field.texture_to_world(), limits);
            return stretch ? colour(ray, *stretch) : background;
        },
        threads);
}

}  // namespace viscera::reference
