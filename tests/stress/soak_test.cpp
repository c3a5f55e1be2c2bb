#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <random>

#include "tests/stress/stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

std::size_t resident_bytes() {
    std::size_t total = 0;
    std::size_t resident = 0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Objects alive among the first names of each kind.
std::array<int, 5> object_counts(const gl::Functions& gl) {
    std::array<int, 5> counts{};
    for (GLuint name = 1; name < 4096; ++name) {
        counts[0] += gl.IsTexture(name);
        counts[1] += gl.IsBuffer(name);
        counts[2] += gl.IsFramebuffer(name);
        counts[3] += gl.IsProgram(name);
        counts[4] += gl.IsVertexArray(name);
    }
    return counts;
}

using Soak = Stage;

/// Frames of random times, cameras, sizes and parameters. VISCERA_SOAK_FRAMES: how many (default 40).
TEST_F(Soak, NothingGrowsAndAllStaysFinite) {
    const char* wanted = std::getenv("VISCERA_SOAK_FRAMES");
    const int frames = wanted == nullptr ? 40 : std::atoi(wanted);
    std::mt19937 random(7U);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    load(chain());
    std::array<int, 5> objects_at_half{};
    std::size_t bytes_at_half = 0;
    for (int i = 0; i < frames; ++i) {
        switch (random() % 6) {
            case 0:
                renderer().set_parameter("vessels", "/cloud/radius_mm", uniform(0.0, 10.0));
                break;
            case 1:
                renderer().set_parameter("vessels", "/bolus/duration_s", uniform(0.1, 3.0));
                break;
            case 2:
                renderer().set_parameter("reflux", "/emitters/0/size", uniform(0.1, 3.0));
                break;
            case 3:
                renderer().set_parameter("vessels", "/vessel/geodesic/speed_mm_s", uniform(5.0, 50.0));
                break;
            default:
                break;
        }
        Frame frame = renderer().still(uniform(-1.0, 5.0));
        frame.index = static_cast<std::uint64_t>(i);
        frame.width = 8 << (random() % 4);
        frame.height = 8 << (random() % 4);
        CameraParams camera = renderer().scene().camera;
        camera.eye_mm = {uniform(-80.0, 80.0), uniform(-80.0, -5.0), uniform(-40.0, 60.0)};
        frame.eyes[0] = make_view(camera, frame.aspect(), frame.time_s);
        (void)render(frame);
        if (i == frames / 2) {
            objects_at_half = object_counts(gl());
            bytes_at_half = resident_bytes();
        }
    }
    const std::array<int, 5> objects = object_counts(gl());
    for (std::size_t kind = 0; kind < objects.size(); ++kind) {
        EXPECT_LE(objects[kind], objects_at_half[kind] + 24) << "kind " << kind;
    }
    EXPECT_LE(resident_bytes(), bytes_at_half + (std::size_t{48} << 20U));
    EXPECT_LE(renderer().asset_count(), 64U);
}

}  // namespace
}  // namespace viscera::test
