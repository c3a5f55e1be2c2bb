#include "assets/generate/hook.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace viscera::assets {
namespace {

constexpr int around = 20;

struct Station {
    glm::dvec3 at{0.0};  ///< along the middle line [mm]; z along the shaft, away from the heel
    double radius = 0.0;
};

std::vector<Station> stations() {
    std::vector<Station> line{{{-4.9, 0.0, 0.0}, 0.02}, {{-4.8, 0.0, 0.0}, 0.6}, {{-4.4, 0.0, 0.0}, 0.9}};
    constexpr double bend_mm = 1.6;
    constexpr int steps = 8;
    for (int i = 0; i <= steps; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / steps;
        line.push_back({{bend_mm * (std::sin(angle) - 1.0), 0.0, bend_mm * (1.0 - std::cos(angle))}, 0.9});
    }
    const auto shaft = [&](double z, double radius) { line.push_back({{0.0, 0.0, z}, radius}); };
    shaft(11.0, 0.9);
    shaft(11.2, 1.7);
    shaft(14.0, 1.8);
    shaft(14.6, 2.4);
    shaft(15.2, 2.5);
    for (int i = 1; i <= 6; ++i) {
        shaft(15.2 + 29.1 * i, 2.5);
    }
    shaft(189.9, 2.4);
    shaft(190.0, 0.02);
    return line;
}

/// The tool's axes in the world: it comes from the left, from the feet and a little from behind.
glm::dmat3 tool_axes() {
    const glm::dvec3 shaft = glm::normalize(glm::dvec3(130.0, 62.0, -118.0));
    const glm::dvec3 side = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), shaft));
    return {side, glm::cross(shaft, side), shaft};
}

}  // namespace

MeshData make_hook() {
    const std::vector<Station> line = stations();
    const glm::dmat3 axes = tool_axes();
    const std::size_t rings = line.size();
    MeshData mesh;
    mesh.name = "hook";
    for (std::size_t k = 0; k < rings; ++k) {
        const Station& before = line[k == 0 ? 0 : k - 1];
        const Station& after = line[k + 1 == rings ? k : k + 1];
        const glm::dvec3 along = glm::normalize(after.at - before.at);
        const glm::dvec3 up(0.0, 1.0, 0.0);  // the line lies in the plane y = 0
        const glm::dvec3 out = glm::cross(up, along);
        const double slope = (after.radius - before.radius) / glm::distance(after.at, before.at);
        for (int i = 0; i <= around; ++i) {
            const double angle = 2.0 * std::numbers::pi * (i % around) / around;
            const glm::dvec3 radial = std::cos(angle) * out + std::sin(angle) * up;
            mesh.positions.emplace_back(axes * (line[k].at + line[k].radius * radial));
            mesh.normals.emplace_back(axes * glm::normalize(radial - slope * along));
            mesh.uvs.emplace_back(0.05 + 0.9 * i / around,
                                  0.05 + 0.9 * static_cast<double>(k) / static_cast<double>(rings - 1));
        }
    }
    const auto row = static_cast<std::uint32_t>(around + 1);
    for (std::uint32_t k = 0; k + 1 < rings; ++k) {
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = k * row + i;
            for (const std::uint32_t corner : {a, a + 1, a + row + 1, a, a + row + 1, a + row}) {
                mesh.indices.push_back(corner);
            }
        }
    }
    return mesh;
}

}  // namespace viscera::assets
