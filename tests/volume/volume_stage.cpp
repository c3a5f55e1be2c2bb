#include "tests/volume/volume_stage.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

#include "engine/runtime/embedded_shaders.h"

namespace viscera::test {
namespace {

template <class T>
void store(Volume& volume, std::size_t index, T value) {
    std::memcpy(volume.voxels.data() + index * sizeof(T), &value, sizeof(T));
}

Volume empty_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm, ScalarType type) {
    Volume volume{.grid = {.dims = dims,
                           .spacing_mm = spacing_mm,
                           .origin_mm = -0.5 * spacing_mm * (glm::dvec3(dims) - 1.0)},
                  .type = type,
                  .voxels = {},
                  .source = "test"};
    volume.voxels.resize(volume.grid.voxel_count() * bytes_of(type));
    return volume;
}

/// visit(index, p) for each voxel, p [mm] of its centre.
void each_voxel(const VolumeGrid& grid, const std::function<void(std::size_t, const glm::dvec3&)>& visit) {
    std::size_t index = 0;
    for (int z = 0; z < grid.dims.z; ++z) {
        for (int y = 0; y < grid.dims.y; ++y) {
            for (int x = 0; x < grid.dims.x; ++x) {
                visit(index++, grid.origin_mm + grid.spacing_mm * glm::dvec3(x, y, z));
            }
        }
    }
}

}  // namespace

ShaderReader with_texts(ShaderTexts texts) {
    return [texts = std::move(texts), engine = embedded_shader_reader()](std::string_view name) {
        const auto found = texts.find(name);
        return found == texts.end() ? engine(name) : std::optional(found->second);
    };
}

ShaderTexts as_on_hardware() {
    const std::string file = "volume/ray_cast_body.glsl";
    return {{file, "#define HARDWARE\n" + std::string(embedded_shader(file).value())}};
}

ShaderTexts slab_counting() {
    constexpr std::array<std::string_view, 2> functions{"take_slab", "finish"};
    return {{"volume/function_composite.glsl",
             wrapped("volume/function_composite.glsl", functions,
                     "float taken = 0.0;\nfloat needed = 0.0;\n"
                     "bool take_slab(inout State state, Slab slab) {\n"
                     "    float depth = state.depth;\n"
                     "    bool stop = plain_take_slab(state, slab);\n"
                     "    taken += 1.0;\n"
                     "    needed += state.depth > depth ? 1.0 : 0.0;\n"
                     "    return stop;\n"
                     "}\n"
                     "vec4 finish(State state) { return vec4(taken, needed, 0.0, 1.0); }\n")}};
}

std::string glsl(double value) {
    std::ostringstream text;
    text.precision(9);
    text << std::scientific << value;
    return text.str();
}

std::string glsl(const glm::dvec3& value) {
    return "vec3(" + glsl(value.x) + ", " + glsl(value.y) + ", " + glsl(value.z) + ")";
}

std::string field_text(std::string_view body, const glm::dvec3& box_mm) {
    return "const vec3 box_mm = " + glsl(box_mm) + ";\n" + std::string(body) +
           "\nfloat sample_volume(vec3 place) { return field((place - 0.5) * box_mm); }\n"
           "vec3 sample_gradient(vec3 place) { return vec3(0.0); }\n";
}

std::string classify_text(std::string_view body) {
    return std::string(body) + "\n";
}

std::string wrapped(std::string_view name, std::span<const std::string_view> functions,
                    std::string_view text) {
    std::string before;
    std::string after;
    for (const std::string_view function : functions) {
        const std::string f(function);
        before += "#define " + f + " plain_" + f + "\n";
        after += "#undef " + f + "\n";
    }
    return before + embedded_shader(name).value() + after + std::string(text);
}

Volume float_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                    const std::function<double(const glm::dvec3& p)>& value) {
    Volume volume = empty_volume(dims, spacing_mm, ScalarType::f32);
    each_voxel(volume.grid,
               [&](std::size_t i, const glm::dvec3& p) { store(volume, i, static_cast<float>(value(p))); });
    return volume;
}

Volume float_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm, std::span<const float> values) {
    Volume volume = empty_volume(dims, spacing_mm, ScalarType::f32);
    const auto bytes = std::as_bytes(values);
    volume.voxels.assign(bytes.begin(), bytes.end());
    return volume;
}

Volume noise_volume(const glm::ivec3& dims, const glm::dvec3& spacing_mm, unsigned seed) {
    std::mt19937 random(seed);
    return float_volume(dims, spacing_mm,
                        [&](const glm::dvec3&) { return static_cast<double>(random() >> 8U) / 16777216.0; });
}

Volume vessel_volume(int n, double spacing_mm, unsigned seed) {
    Volume volume = empty_volume(glm::ivec3(n), glm::dvec3(spacing_mm), ScalarType::u8);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto draw = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
    for (int vessel = 0; vessel < 6; ++vessel) {
        glm::dvec3 p = (0.5 + 0.4 * draw()) * static_cast<double>(n);
        glm::dvec3 direction = glm::normalize(draw());
        for (int step = 0; step < 3 * n; ++step) {
            direction = glm::normalize(direction + 0.15 * draw());
            p += 0.7 * direction;
            const glm::ivec3 i(glm::floor(p));
            if (glm::any(glm::lessThan(i, glm::ivec3(0))) ||
                glm::any(glm::greaterThanEqual(i, glm::ivec3(n)))) {
                direction = glm::normalize(glm::dvec3(0.5 * n) - p);
                continue;
            }
            const auto un = static_cast<std::size_t>(n);
            const std::size_t index =
                static_cast<std::size_t>(i.x) +
                un * (static_cast<std::size_t>(i.y) + un * static_cast<std::size_t>(i.z));
            store(volume, index, static_cast<std::uint8_t>(120 + random() % 80));
        }
    }
    return volume;
}

Volume head_volume(int n, double side_mm) {
    Volume volume = empty_volume(glm::ivec3(n), glm::dvec3(side_mm / n), ScalarType::i16);
    volume.unit = "HU";
    std::mt19937 random(3);
    const double half = 0.5 * side_mm;
    each_voxel(volume.grid, [&](std::size_t i, const glm::dvec3& p) {
        const double noise = static_cast<double>(random() % 21) - 10.0;
        const glm::dvec3 q = p / half;
        const double skin = glm::length(q / glm::dvec3(0.72, 0.86, 0.92));
        const double skull = glm::length(q / glm::dvec3(0.66, 0.80, 0.86));
        const double brain = glm::length(q / glm::dvec3(0.60, 0.74, 0.80));
        const double sinus = glm::length((q - glm::dvec3(0.0, -0.72, -0.1)) / glm::dvec3(0.12, 0.06, 0.1));
        const double ventricle = glm::length((q - glm::dvec3(0.1, 0.05, 0.1)) / glm::dvec3(0.08, 0.3, 0.15));
        double value = skin > 1.0 ? -1000.0 : 60.0 + noise;
        value = skull < 1.0 ? 1100.0 + 3.0 * noise : value;
        value = brain < 1.0 ? (ventricle < 1.0 ? 8.0 : 35.0) + noise : value;
        value = sinus < 1.0 ? -1000.0 : value;
        store(volume, i, static_cast<std::int16_t>(std::lround(value)));
    });
    return volume;
}

nlohmann::json to_json(const Look& look) {
    nlohmann::json camera{{"eye_mm", {look.eye_mm.x, look.eye_mm.y, look.eye_mm.z}},
                          {"target_mm", {look.target_mm.x, look.target_mm.y, look.target_mm.z}},
                          {"up", {look.up.x, look.up.y, look.up.z}},
                          {"vertical_fov_deg", look.fov_deg},
                          {"near_mm", look.near_mm},
                          {"far_mm", look.far_mm}};
    if (look.orthographic_mm > 0.0) {
        camera["kind"] = "orthographic";
        camera["height_mm"] = look.orthographic_mm;
    }
    return camera;
}

glm::dvec4 Shot::at(int x, int y) const {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2), image.at(x, y, 3)};
}

reference::Ray Shot::ray(int x, int y) const {
    return reference::pixel_ray(view, x, y, image.width, image.height);
}

double Shot::along(const reference::Ray& ray, double depth_mm) const {
    return depth_mm / glm::dot(ray.direction, view.forward);
}

bool same_bits(const Shot& a, const Shot& b) {
    return a.image.width == b.image.width && a.image.height == b.image.height && a.image.data == b.image.data;
}

VolumeStage::VolumeStage(ShaderTexts texts) : stage_(Backend::osmesa, with_texts(std::move(texts))) {}

Shot VolumeStage::cast(const LiveVolume& volume, nlohmann::json parameters, const Look& look,
                       const glm::ivec2& size) {
    stage_.make_current();
    parameters["volume"]["host"] = "host";
    stage_.load({{"version", 1},
                 {"resolution", {size.x, size.y}},
                 {"camera", to_json(look)},
                 {"passes", {{{"name", "cast"}, {"effect", "volume.ray_cast"}, {"parameters", parameters}}}},
                 {"targets", {{"volume.colour", {{"format", "rgba32f"}}}}},
                 {"outputs", {"volume.colour"}}});
    return cast_again(volume, stage_.renderer().still(0.0).eye(), size);
}

Shot VolumeStage::cast_again(const LiveVolume& volume, const View& view, const glm::ivec2& size) {
    stage_.make_current();
    const HostVolume given{"host", &volume};
    Frame frame = stage_.renderer().still(0.0);
    frame.width = size.x;
    frame.height = size.y;
    frame.eyes[0] = view;
    frame.volumes = std::span(&given, 1);
    stage_.renderer().render(frame);
    return {stage_.renderer().read("volume.colour"), view};
}

Miss miss(const Shot& shot, const WantedColour& wanted) {
    Miss found;
    double sum = 0.0;
    for (int y = 0; y < shot.image.height; ++y) {
        for (int x = 0; x < shot.image.width; ++x) {
            const std::optional<glm::dvec4> colour = wanted(shot.ray(x, y));
            if (!colour) {
                continue;
            }
            ++found.pixels;
            for (int c = 0; c < 4; ++c) {
                const double d = std::abs(shot.at(x, y)[c] - (*colour)[c]);
                const double error = std::isfinite(d) ? d : 1e30;
                found.most = std::max(found.most, (*colour)[c]);
                sum += error * error;
                if (error > found.worst) {
                    found.worst = error;
                    found.x = x;
                    found.y = y;
                }
            }
        }
    }
    found.rms = std::sqrt(sum / (4.0 * std::max(found.pixels, 1)));
    return found;
}

double order_of(std::span<const double> n, std::span<const double> error) {
    double sx = 0.0;
    double sy = 0.0;
    double sxx = 0.0;
    double sxy = 0.0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        const double x = std::log(n[i]);
        const double y = -std::log(error[i]);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    const auto count = static_cast<double>(n.size());
    return (count * sxy - sx * sy) / (count * sxx - sx * sx);
}

nlohmann::json vessels_shown() {
    return {{"points",
             {{{"value", 60}, {"colour", {0.8, 0.2, 0.1}}, {"opacity", 0.0}},
              {{"value", 130}, {"colour", {0.9, 0.6, 0.4}}, {"opacity", 0.2}},
              {{"value", 200}, {"colour", {1.0, 1.0, 0.9}}, {"opacity", 0.5}}}}};
}

}  // namespace viscera::test
