#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "engine/io/volume.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"

// Curvilinear volumes whose geometry the scene gives, beside a conversion of their samples in double
// precision.
namespace viscera::test {
namespace {

using nlohmann::json;

using std::numbers::pi;

/// Samples on axes of their own, mixed linearly; `wrap`: axis around which the first follows the last.
struct Samples {
    glm::ivec3 dims{1};
    std::vector<double> values;
    int wrap = -1;

    [[nodiscard]] double at(glm::ivec3 i) const {
        if (wrap >= 0) {
            i[wrap] = (i[wrap] % dims[wrap] + dims[wrap]) % dims[wrap];
        }
        i = glm::clamp(i, glm::ivec3(0), dims - 1);
        return values[(static_cast<std::size_t>(i.z) * static_cast<std::size_t>(dims.y) +
                       static_cast<std::size_t>(i.y)) *
                          static_cast<std::size_t>(dims.x) +
                      static_cast<std::size_t>(i.x)];
    }
    [[nodiscard]] double mixed(const glm::dvec3& index) const {
        const glm::dvec3 low = glm::floor(index);
        const glm::dvec3 a = index - low;
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
            const glm::dvec3 w = glm::mix(1.0 - a, a, glm::dvec3(step));
            sum += w.x * w.y * w.z * at(glm::ivec3(low) + step);
        }
        return sum;
    }
};

/// A picture whose pixels lie on a plane: pixel (x, y), from the bottom left, at first + x across + y up.
struct Raster {
    int width = 0;
    int height = 0;
    double pixel_mm = 0.0;
    glm::dvec3 middle{0.0};
    glm::dvec3 across{1.0, 0.0, 0.0};
    glm::dvec3 up{0.0, 1.0, 0.0};

    [[nodiscard]] glm::dvec3 at(int x, int y) const {
        return middle + pixel_mm * ((x + 0.5 - 0.5 * width) * across + (y + 0.5 - 0.5 * height) * up);
    }
    [[nodiscard]] json plane() const {
        const glm::dvec3 n = glm::cross(across, up);
        return {{"oblique",
                 {{"point_mm", {middle.x, middle.y, middle.z}},
                  {"normal", {n.x, n.y, n.z}},
                  {"up", {up.x, up.y, up.z}}}}};
    }
};

/// The values of a file on a raster, in floats; 2 beside the volume. `range`: what is drawn as 1.
json slice_scene(const std::filesystem::path& file, const json& geometry, const Raster& raster,
                 const std::string& filter, double range) {
    return {{"version", 1},
            {"resolution", {raster.width, raster.height}},
            {"passes",
             {{{"name", "slice"},
               {"effect", "volume.slice"},
               {"parameters",
                {{"volume", {{"file", file.string()}, {"geometry", geometry}}},
                 {"plane", raster.plane()},
                 {"height_mm", raster.height * raster.pixel_mm},
                 {"sampling", {{"filter", filter}}},
                 {"transfer_function", {{"window", {{"width", range}, {"level", 0.5 * range}}}}},
                 {"background", {2, 2, 2, 1}}}}}}},
            {"targets", {{"volume.slice", {{"format", "rgba32f"}}}}},
            {"outputs", {"volume.slice"}}};
}

struct Deviation {
    double worst = 0.0;
    double rms = 0.0;
    int pixels = 0;
};

/// wanted(place): none where the volume ends so near that rounding decides; 2 beside it.
template <class Wanted>
Deviation deviation(Stage& stage, const json& scene, const Raster& raster, const Wanted& wanted) {
    stage.load(scene);
    const Image image = stage.shot("volume.slice", 0.0);
    Deviation result;
    double squares = 0.0;
    for (int y = 0; y < raster.height; ++y) {
        for (int x = 0; x < raster.width; ++x) {
            const std::optional<double> due = wanted(raster.at(x, y));
            if (!due) {
                continue;
            }
            const double off = std::abs(static_cast<double>(image.at(x, y, 0)) - *due);
            result.worst = std::isfinite(off) ? std::max(result.worst, off) : 1e30;
            squares += off * off;
            ++result.pixels;
        }
    }
    result.rms = std::sqrt(squares / result.pixels);
    return result;
}

class CurvilinearData : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }

    TempFolder folder_;
    Stage stage_;
};

/// Index along an axis, or none near its ends; outside: -1.
constexpr double edge = 1e-3;
enum class Side { inside, outside, edge };
Side side_of(double index, int count) {
    const double depth = std::min(index, count - 1 - index);
    return depth > edge ? Side::inside : depth < -edge ? Side::outside : Side::edge;
}

// The frames of a convex probe as they come from its beams, on the raster of the maker's own conversion.
TEST_F(CurvilinearData, FramesOfAProbeAreConvertedAsInDoublePrecision) {
    const std::filesystem::path file =
        std::filesystem::path(VISCERA_DATA_DIR) / "ultrasound/UltrasonixCurvilinearBrightnessData.igs.mha";
    if (std::string_view(VISCERA_DATA_DIR).empty() || !std::filesystem::exists(file)) {
        GTEST_SKIP() << "VISCERA_DATA_DIR names no folder with real data";
    }
    Log log;
    const Volume volume = io::load_volume(file, {}, log);
    const glm::ivec3 dims = volume.grid.dims;
    ASSERT_EQ(dims, glm::ivec3(3640, 96, 5));
    Samples samples{.dims = dims, .values = {}};
    for (const std::byte b : volume.voxels) {
        samples.values.push_back(std::to_integer<int>(b) / 255.0);
    }
    double steepest = 0.0;
    for (std::size_t i = 1; i < samples.values.size(); ++i) {
        steepest =
            std::max(steepest, i % 3640 == 0 ? 0.0 : std::abs(samples.values[i] - samples.values[i - 1]));
    }
    // Frames follow each other in time; 1 mm apart they are a stack.
    const json geometry = {
        {"kind", "cylindrical"},    {"r_min_mm", 10.0},   {"r_max_mm", 10.0 + 72.0 * 3639.0 / 3640.0},
        {"first_angle_deg", -75.0}, {"angle_deg", 150.0}, {"height_mm", 4.0}};
    // Pixel (410, 87) from the top left is the probe's surface; beams go down, and x leads away from the
    // probe.
    Raster raster{.width = 820, .height = 616, .pixel_mm = 0.15, .across = {0, 1, 0}, .up = {-1, 0, 0}};
    const auto wanted = [&](const glm::dvec3& p) -> std::optional<double> {
        const double line = (std::atan2(p.y, p.x) * 180.0 / pi + 75.0) * 95.0 / 150.0;
        const double sample = (std::hypot(p.x, p.y) - 10.0) * 3640.0 / 72.0;
        const std::array sides{side_of(line, dims.y), side_of(sample, dims.x)};
        if (std::ranges::find(sides, Side::outside) != sides.end()) {
            return 2.0;
        }
        if (std::ranges::find(sides, Side::edge) != sides.end()) {
            return std::nullopt;
        }
        return samples.mixed({sample, line, p.z});
    };
    for (const double frame : {0.0, 2.0, 2.5}) {
        raster.middle = {10.0 + (307.5 - 87.0) * 0.15, (409.5 - 410.0) * 0.15, frame};
        for (const char* filter : {"linear", "linear_fp32"}) {
            const Deviation found =
                deviation(stage_, slice_scene(file, geometry, raster, filter, 255.0), raster, wanted);
            RecordProperty(std::string(filter) + "_worst_" + std::to_string(frame),
                           std::to_string(found.worst));
            RecordProperty(std::string(filter) + "_rms_" + std::to_string(frame), std::to_string(found.rms));
            EXPECT_GT(found.pixels, 400000);
            // A texture coordinate is a float, rounded when it is made and when it is used: together 4.4e-4
            // of the way between two of 3640 samples, which differ by up to `steepest`.
            EXPECT_LE(found.worst, 2.0 * 3640.0 * 0x1.0p-24 * steepest) << filter << " " << frame;
            EXPECT_LE(found.rms, 1.5e-5) << filter << " " << frame;
        }
    }
}

template <class T>
std::string big_endian(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    std::ranges::reverse(bytes);
    return {bytes.begin(), bytes.end()};
}

/// A legacy file of structured points, binary; value(i) by indices.
template <class T, class Value>
std::string vtk(std::string_view type, const glm::ivec3& dims, const Value& value) {
    std::string text = "# vtk DataFile Version 3.0\nsamples\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS " +
                       std::to_string(dims.x) + " " + std::to_string(dims.y) + " " + std::to_string(dims.z) +
                       "\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA " +
                       std::to_string(dims.x * dims.y * dims.z) + "\nSCALARS s " + std::string(type) +
                       " 1\nLOOKUP_TABLE default\n";
    glm::ivec3 i;
    for (i.z = 0; i.z < dims.z; ++i.z) {
        for (i.y = 0; i.y < dims.y; ++i.y) {
            for (i.x = 0; i.x < dims.x; ++i.x) {
                text += big_endian(static_cast<T>(value(i)));
            }
        }
    }
    return text;
}

/// Something of every direction, in [0, 1000].
double waves(const glm::ivec3& i) {
    return std::round(500.0 + 200.0 * std::sin(0.5 * i.x + 0.3 * i.z) +
                      250.0 * std::cos(0.7 * i.y - 0.2 * i.x));
}

template <class Value>
Samples samples_of(const glm::ivec3& dims, int wrap, const Value& value) {
    Samples samples{.dims = dims, .values = {}, .wrap = wrap};
    glm::ivec3 i;
    for (i.z = 0; i.z < dims.z; ++i.z) {
        for (i.y = 0; i.y < dims.y; ++i.y) {
            for (i.x = 0; i.x < dims.x; ++i.x) {
                samples.values.push_back(value(i) / 1000.0);
            }
        }
    }
    return samples;
}

TEST_F(CurvilinearData, LegacyFilesOfDoublesMayBeCylinders) {
    const glm::ivec3 dims(20, 31, 9);
    const std::filesystem::path file = folder_.write("a.vtk", vtk<double>("double", dims, waves));
    const Samples samples = samples_of(dims, 1, waves);
    const json geometry = {{"kind", "cylindrical"},   {"r_min_mm", 4.0},    {"r_max_mm", 30.0},
                           {"first_angle_deg", 20.0}, {"angle_deg", 360.0}, {"wrap", true},
                           {"height_mm", 16.0}};
    const Raster raster{.width = 90, .height = 80, .pixel_mm = 0.8, .middle = {1.0, -2.0, 7.3}};
    const Deviation found =
        deviation(stage_, slice_scene(file, geometry, raster, "linear_fp32", 1000.0), raster,
                  [&](const glm::dvec3& p) -> std::optional<double> {
                      const double radius = (std::hypot(p.x, p.y) - 4.0) * 19.0 / 26.0;
                      const Side side = side_of(radius, dims.x);
                      if (side != Side::inside) {
                          return side == Side::outside ? std::optional(2.0) : std::nullopt;
                      }
                      const double around = (std::atan2(p.y, p.x) * 180.0 / pi - 20.0) * 31.0 / 360.0;
                      return samples.mixed({radius, around, p.z * 8.0 / 16.0});
                  });
    EXPECT_GT(found.pixels, 7000);
    EXPECT_LE(found.worst, 5e-6);
}

TEST_F(CurvilinearData, LegacyFilesOfUnsignedShortsMayBeSpheres) {
    const glm::ivec3 dims(25, 17, 20);
    const std::filesystem::path file =
        folder_.write("a.vtk", vtk<std::uint16_t>("unsigned_short", dims, waves));
    const Samples samples = samples_of(dims, -1, waves);
    const json geometry = {{"kind", "spherical"},      {"r_min_mm", 10.0},   {"r_max_mm", 40.0},
                           {"first_angle_deg", -70.0}, {"angle_deg", 140.0}, {"latitude_deg", 100.0}};
    // Across the equator, so that longitude, latitude and radius all change.
    const Raster raster{.width = 90,
                        .height = 80,
                        .pixel_mm = 1.0,
                        .middle = {20.0, 1.0, 2.0},
                        .across = {0.6, 0.8, 0.0},
                        .up = {0.0, 0.0, 1.0}};
    const Deviation found =
        deviation(stage_, slice_scene(file, geometry, raster, "linear_fp32", 1000.0), raster,
                  [&](const glm::dvec3& p) -> std::optional<double> {
                      const double across = std::hypot(p.x, p.y);
                      const glm::dvec3 index((std::atan2(p.y, p.x) * 180.0 / pi + 70.0) * 24.0 / 140.0,
                                             (std::atan2(p.z, across) * 180.0 / pi + 50.0) * 16.0 / 100.0,
                                             (glm::length(p) - 10.0) * 19.0 / 30.0);
                      const std::array sides{side_of(index.x, dims.x), side_of(index.y, dims.y),
                                             side_of(index.z, dims.z)};
                      if (std::ranges::find(sides, Side::outside) != sides.end()) {
                          return 2.0;
                      }
                      if (std::ranges::find(sides, Side::edge) != sides.end()) {
                          return std::nullopt;
                      }
                      return samples.mixed(index);
                  });
    EXPECT_GT(found.pixels, 7000);
    EXPECT_LE(found.worst, 5e-6);
}

}  // namespace
}  // namespace viscera::test
