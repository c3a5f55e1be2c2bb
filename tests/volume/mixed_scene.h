#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/core/mesh_data.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {

/// A host's volume of bytes about the world's origin; value(x, y, z) of the voxel's centre [mm].
inline Volume byte_volume(int n, double spacing_mm, const std::function<double(glm::dvec3)>& value) {
    Volume volume;
    volume.grid.dims = glm::ivec3(n);
    volume.grid.spacing_mm = glm::dvec3(spacing_mm);
    volume.grid.origin_mm = glm::dvec3(-0.5 * spacing_mm * (n - 1));
    for (int z = 0; z < n; ++z) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                const glm::dvec3 at = volume.grid.origin_mm + spacing_mm * glm::dvec3(x, y, z);
                volume.voxels.push_back(static_cast<std::byte>(std::lround(value(at))));
            }
        }
    }
    return volume;
}

/// A ball of several shells with a soft edge and some relief, so that no two rays are alike.
inline Volume shell_volume(int n = 48, double spacing_mm = 4.0) {
    return byte_volume(n, spacing_mm, [](const glm::dvec3& p) {
        const double r = glm::length(p * glm::dvec3(1.0, 1.2, 0.9));
        const double relief = 6.0 * std::sin(0.11 * p.x) * std::cos(0.13 * p.y + 0.07 * p.z);
        const double shells = 110.0 + 90.0 * std::cos(0.12 * (r + relief));
        return shells / (1.0 + std::exp((r - 75.0 + relief) / 3.0));
    });
}

/// Colour and opacity of shell_volume.
inline nlohmann::json shell_function() {
    return {{"points",
             {{{"value", 20}, {"colour", {0.2, 0.1, 0.1}}, {"opacity", 0.0}},
              {{"value", 90}, {"colour", {0.9, 0.5, 0.3}}, {"opacity", 0.01}},
              {{"value", 200}, {"colour", {1.0, 0.95, 0.8}}, {"opacity", 0.06}}}}};
}

/// A scene about the host's volume "host"; `passes` before volume.ray_cast.
inline nlohmann::json mixed_scene(nlohmann::json passes, nlohmann::json parameters,
                                  const nlohmann::json& camera, int width = 96, int height = 80) {
    parameters["volume"]["host"] = "host";
    passes.push_back({{"name", "cast"}, {"effect", "volume.ray_cast"}, {"parameters", parameters}});
    nlohmann::json targets{{"volume.colour", {{"format", "rgba32f"}}}};
    for (const nlohmann::json& pass : passes) {
        if (pass["effect"] == "mesh.surface") {
            targets["mesh.colour"] = {{"format", "rgba32f"}};
        }
    }
    return {{"version", 1},       {"resolution", {width, height}}, {"camera", camera}, {"passes", passes},
            {"targets", targets}, {"outputs", {"volume.colour"}}};
}

inline nlohmann::json camera_at(glm::dvec3 eye, double near_mm = 20.0, double far_mm = 1500.0) {
    return {{"eye_mm", {eye.x, eye.y, eye.z}},
            {"target_mm", {1.0, -2.0, 3.0}},
            {"vertical_fov_deg", 34},
            {"near_mm", near_mm},
            {"far_mm", far_mm}};
}

inline nlohmann::json orthographic_at(glm::dvec3 eye) {
    nlohmann::json camera = camera_at(eye);
    camera["kind"] = "orthographic";
    camera["height_mm"] = 230;
    return camera;
}

/// Renders a scene with one host volume and reads one target.
inline Image mixed_shot(Stage& stage, const nlohmann::json& scene, const LiveVolume& volume,
                        std::string_view target = "volume.colour", FrameReport* report = nullptr) {
    stage.make_current();
    stage.load(scene);
    stage.renderer().keep({std::string(target)});
    const HostVolume given{"host", &volume};
    Frame frame = stage.renderer().still(0.0);
    frame.volumes = std::span(&given, 1);
    const FrameReport& made = stage.renderer().render(frame);
    if (report != nullptr) {
        *report = made;
    }
    return stage.renderer().read(target);
}

struct Difference {
    double max = 0.0;
    double mean = 0.0;
    std::size_t above = 0;  ///< pixels that differ by more than the limit
    std::size_t seen = 0;   ///< pixels in which either picture shows anything
};
inline Difference difference(const Image& a, const Image& b, double limit = 0.0) {
    Difference found;
    const std::vector<float> x = to_floats(a);
    const std::vector<float> y = to_floats(b);
    if (x.size() != y.size() || a.channels() != 4) {
        throw std::invalid_argument("pictures of different kinds");
    }
    for (std::size_t p = 0; p < x.size(); p += 4) {
        double most = 0.0;
        for (std::size_t c = 0; c < 4; ++c) {
            const double d = std::abs(static_cast<double>(x[p + c]) - static_cast<double>(y[p + c]));
            most = std::isfinite(d) ? std::max(most, d) : 1e30;
        }
        found.max = std::max(found.max, most);
        found.mean += 4.0 * most / static_cast<double>(x.size());
        found.above += most > limit ? 1U : 0U;
        found.seen += x[p + 3] > 0.0F || y[p + 3] > 0.0F ? 1U : 0U;
    }
    return found;
}

/// The ray of a pixel's centre in the world, in double precision. `near`, `far`: the camera's planes along
/// it.
struct PixelRay {
    glm::dvec3 origin{0.0};  ///< on the near plane
    glm::dvec3 direction{0.0, 0.0, 1.0};
    double far = 0.0;  ///< [mm]
};
inline PixelRay pixel_ray(const View& view, int x, int y, int width, int height) {
    const glm::dmat4 back = glm::inverse(view.view_projection());
    const auto at = [&](double z) {
        const glm::dvec4 p =
            back * glm::dvec4((2.0 * x + 1.0) / width - 1.0, (2.0 * y + 1.0) / height - 1.0, z, 1.0);
        return glm::dvec3(p) / p.w;
    };
    PixelRay ray{.origin = at(-1.0)};
    const glm::dvec3 way = at(1.0) - ray.origin;
    ray.far = glm::length(way);
    ray.direction = way / ray.far;
    return ray;
}

/// Where a line is inside a box; x > y when it is nowhere.
inline glm::dvec2 box_interval(const PixelRay& ray, const glm::dvec3& low, const glm::dvec3& high) {
    glm::dvec2 interval(0.0, ray.far);
    for (int a = 0; a < 3; ++a) {
        const double s = (low[a] - ray.origin[a]) / ray.direction[a];
        const double t = (high[a] - ray.origin[a]) / ray.direction[a];
        interval = {std::max(interval.x, std::min(s, t)), std::min(interval.y, std::max(s, t))};
    }
    return interval;
}

/// Where a line passes the triangles of a mesh [mm from the ray's origin], unordered; negative: behind.
inline std::vector<double> crossings(const PixelRay& ray, const MeshData& mesh) {
    std::vector<double> found;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::dvec3 a = mesh.positions[mesh.indices[t]];
        const glm::dvec3 e = glm::dvec3(mesh.positions[mesh.indices[t + 1]]) - a;
        const glm::dvec3 f = glm::dvec3(mesh.positions[mesh.indices[t + 2]]) - a;
        const glm::dvec3 p = glm::cross(ray.direction, f);
        const double determinant = glm::dot(e, p);
        if (determinant == 0.0) {
            continue;
        }
        const glm::dvec3 s = ray.origin - a;
        const double u = glm::dot(s, p) / determinant;
        const glm::dvec3 q = glm::cross(s, e);
        const double v = glm::dot(ray.direction, q) / determinant;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) {
            found.push_back(glm::dot(f, q) / determinant);
        }
    }
    return found;
}

/// A ball of triangles that face outwards.
inline MeshData ball_mesh(const glm::vec3& centre, float radius, int rings = 12) {
    MeshData mesh;
    const int columns = 2 * rings;
    const auto pi = 3.14159265358979F;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < columns; ++j) {
            const float theta = pi * static_cast<float>(i) / static_cast<float>(rings);
            const float phi = 2.0F * pi * static_cast<float>(j) / static_cast<float>(columns);
            mesh.positions.push_back(centre + radius * glm::vec3(std::sin(theta) * std::cos(phi),
                                                                 std::sin(theta) * std::sin(phi),
                                                                 std::cos(theta)));
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * columns + j % columns); };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < columns; ++j) {
            if (i > 0) {
                mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
            }
            if (i + 1 < rings) {
                mesh.indices.insert(mesh.indices.end(), {at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
            }
        }
    }
    return mesh;
}

/// A mesh as an OBJ file, every number in full.
inline std::string obj_text(const MeshData& mesh) {
    std::string text;
    std::array<char, 96> line{};
    for (const glm::vec3& p : mesh.positions) {
        std::snprintf(line.data(), line.size(), "v %.9g %.9g %.9g\n", static_cast<double>(p.x),
                      static_cast<double>(p.y), static_cast<double>(p.z));
        text += line.data();
    }
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        std::snprintf(line.data(), line.size(), "f %u %u %u\n", mesh.indices[t] + 1, mesh.indices[t + 1] + 1,
                      mesh.indices[t + 2] + 1);
        text += line.data();
    }
    return text;
}

}  // namespace viscera::test
