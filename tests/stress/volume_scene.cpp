#include "tests/stress/volume_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace viscera::test {
namespace {

using nlohmann::json;

template <class T>
void fill(std::vector<std::byte>& bytes, double stored) {
    const T value = static_cast<T>(stored);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(T)) {
        std::memcpy(bytes.data() + at, &value, sizeof(T));
    }
}

Volume blank(const glm::ivec3& dims, const glm::dvec3& spacing_mm, ScalarType type) {
    Volume volume{.grid = {.dims = dims,
                           .spacing_mm = spacing_mm,
                           .origin_mm = -0.5 * spacing_mm * (glm::dvec3(dims) - 1.0)},
                  .type = type,
                  .voxels = {},
                  .source = "test"};
    volume.voxels.resize(volume.grid.voxel_count() * bytes_of(type));
    return volume;
}

}  // namespace

Volume make_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                   const std::function<double(const glm::ivec3&)>& value) {
    Volume volume = blank(dims, spacing_mm, ScalarType::f32);
    std::byte* to = volume.voxels.data();
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            for (int x = 0; x < dims.x; ++x) {
                const auto number = static_cast<float>(value({x, y, z}));
                std::memcpy(to, &number, sizeof number);
                to += sizeof number;
            }
        }
    }
    return volume;
}

Volume constant_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm, double stored, ScalarType type) {
    Volume volume = blank(dims, spacing_mm, type);
    switch (type) {
        case ScalarType::u8:
            fill<std::uint8_t>(volume.voxels, stored);
            break;
        case ScalarType::i8:
            fill<std::int8_t>(volume.voxels, stored);
            break;
        case ScalarType::u16:
            fill<std::uint16_t>(volume.voxels, stored);
            break;
        case ScalarType::i16:
            fill<std::int16_t>(volume.voxels, stored);
            break;
        case ScalarType::f32:
            fill<float>(volume.voxels, stored);
            break;
    }
    return volume;
}

Volume ball_volume(int n) {
    return make_volume(glm::ivec3(n), glm::dvec3(10.0 / n), [n](const glm::ivec3& i) {
        const double r = glm::length((glm::dvec3(i) + 0.5) / static_cast<double>(n) - 0.5);
        return 100.0 * std::clamp((0.45 - r) / 0.1, 0.0, 1.0);
    });
}

json VolumeStress::homogeneous() {
    return {
        {"transfer_function", {{"points", {{{"value", 0}, {"colour", {0.25, 0.5, 1}}, {"opacity", 0.1}}}}}},
        {"sampling", {{"termination", 0}}}};
}

json VolumeStress::ramp() {
    return {{"transfer_function",
             {{"points",
               {{{"value", 0}, {"colour", {1, 0.5, 0.25}}, {"opacity", 0}},
                {{"value", 100}, {"colour", {0.25, 0.5, 1}}, {"opacity", 0.5}}}}}}};
}

json VolumeStress::camera(const json& eye_mm, const json& target_mm, double near_mm, double far_mm) {
    return {{"eye_mm", eye_mm},       {"target_mm", target_mm}, {"up", {0.01, 0.02, 1}},
            {"vertical_fov_deg", 40}, {"near_mm", near_mm},     {"far_mm", far_mm}};
}

json VolumeStress::orthographic(const json& eye_mm, const json& target_mm, double height_mm) {
    return {{"kind", "orthographic"}, {"eye_mm", eye_mm}, {"target_mm", target_mm}, {"up", {0, 0, 1}},
            {"height_mm", height_mm}, {"near_mm", 0.01},  {"far_mm", 1000}};
}

json VolumeStress::front() {
    return camera({3, -25, 4}, {0, 0, 0});
}

json VolumeStress::scene(json parameters, const json& camera) {
    parameters["volume"]["host"] = "host";
    return {{"version", 1},
            {"resolution", {20, 16}},
            {"camera", camera},
            {"passes", {{{"name", "cast"}, {"effect", "volume.ray_cast"}, {"parameters", parameters}}}},
            {"targets", {{"volume.colour", {{"format", "rgba32f"}}}}},
            {"outputs", {"volume.colour"}}};
}

void VolumeStress::give(std::string_view name, const LiveVolume* volume) {
    std::erase_if(given_, [&](const HostVolume& given) { return given.name == name; });
    if (volume != nullptr) {
        given_.push_back({name, volume});
    }
}

Frame VolumeStress::volume_frame() {
    Frame frame = renderer().still(0.0);
    frame.volumes = given_;
    return frame;
}

Image VolumeStress::cast(const LiveVolume& volume, const json& parameters, const json& camera) {
    SCOPED_TRACE(parameters.dump());
    give("host", &volume);
    load(scene(parameters, camera));
    return picture();
}

void VolumeStress::expect_homogeneous(const Image& image, const glm::dmat4& local_to_world, double tolerance,
                                      const std::string& what, const glm::dvec3& low,
                                      const glm::dvec3& high) {
    const View view = renderer().still(0.0).eye();
    const glm::dmat4 from_clip = glm::inverse(view.projection);
    const glm::dmat4 to_local = glm::inverse(view.view * local_to_world);
    double worst = 0.0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto at = [&](double depth) {
                const glm::dvec4 p = from_clip * glm::dvec4(2.0 * (x + 0.5) / image.width - 1.0,
                                                            2.0 * (y + 0.5) / image.height - 1.0, depth, 1.0);
                return glm::dvec4(glm::dvec3(p) / p.w, 1.0);
            };
            const glm::dvec4 a = at(-1.0);
            const glm::dvec4 b = at(1.0);
            const glm::dvec3 origin = to_local * a;
            const glm::dvec3 way = to_local * (b - a);
            double enter = 0.0;
            double leave = 1.0;
            for (int axis = 0; axis < 3; ++axis) {
                const double s = (low[axis] - origin[axis]) / way[axis];
                const double t = (high[axis] - origin[axis]) / way[axis];
                if (way[axis] == 0.0) {
                    leave = origin[axis] < low[axis] || origin[axis] > high[axis] ? -1.0 : leave;
                    continue;
                }
                enter = std::max(enter, std::min(s, t));
                leave = std::min(leave, std::max(s, t));
            }
            const double length_mm = std::max(leave - enter, 0.0) * glm::length(glm::dvec3(b - a));
            const double opacity = 1.0 - std::pow(0.9, length_mm);
            const glm::dvec4 wanted(0.25 * opacity, 0.5 * opacity, opacity, opacity);
            for (int c = 0; c < 4; ++c) {
                worst = std::max(worst, std::abs(image.at(x, y, c) - wanted[c]));
            }
        }
    }
    EXPECT_LE(worst, tolerance) << what;
}

void VolumeStress::expect_refused(const json& scene, ErrorCode code, const std::string& key) {
    try {
        load(scene);
        (void)picture();
        ADD_FAILURE() << "was taken; should name " << key;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        EXPECT_THAT(error.what(), testing::HasSubstr(key));
    }
}

double difference(const Image& a, const Image& b) {
    const std::vector<float> left = to_floats(a);
    const std::vector<float> right = to_floats(b);
    double worst = left.size() == right.size() ? 0.0 : 1e30;
    for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
        worst = std::max(worst, std::abs(static_cast<double>(left[i]) - static_cast<double>(right[i])));
    }
    return worst;
}

void expect_near(const Image& a, const Image& b, double tolerance, const std::string& what) {
    EXPECT_LE(difference(a, b), tolerance) << what;
}

bool is_empty(const Image& image) {
    return std::ranges::all_of(to_floats(image), [](float value) { return value == 0.0F; });
}

}  // namespace viscera::test
