#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "engine/io/png.h"
#include "tests/context/xvfb.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

const std::filesystem::path scene = VISCERA_SOURCE_DIR "/assets/scenes/angiography.json";

std::string in_quotes(const std::filesystem::path& path) {
    return "'" + path.string() + "'";
}

/// Left the host's triangle on its background, right viscera's picture.
void expect_both_halves(const std::filesystem::path& file) {
    const Image image = io::read_image(file);
    ASSERT_EQ(image.width, 1024);
    ASSERT_EQ(image.height, 512);
    const auto byte = [&](int x, int y, int c) {
        return static_cast<int>(image.at(x, y, c) * 255.0F + 0.5F);
    };
    EXPECT_EQ(byte(256, 200, 0), 255);  // inside the triangle
    EXPECT_EQ(byte(256, 200, 1), 153);
    EXPECT_EQ(byte(256, 200, 2), 51);
    EXPECT_EQ(byte(5, 5, 0), 13);  // beside it: the host's clear colour
    EXPECT_EQ(byte(5, 5, 2), 51);
    EXPECT_EQ(byte(511, 256, 2), 51);
    int darkest = 255;
    int brightest = 0;
    for (int y = 0; y < 512; ++y) {
        for (int x = 512; x < 1024; ++x) {
            ASSERT_EQ(byte(x, y, 0), byte(x, y, 1)) << x << ", " << y;
            ASSERT_EQ(byte(x, y, 0), byte(x, y, 2)) << x << ", " << y;
            darkest = std::min(darkest, byte(x, y, 0));
            brightest = std::max(brightest, byte(x, y, 0));
        }
    }
    EXPECT_LT(darkest, 60) << "no contrast in the vessels";
    EXPECT_GT(brightest, 160) << "no background";
}

class Samples : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(scene.parent_path() / "../meshes/coronary.glb")) {
            GTEST_SKIP() << "the assets are not made yet (target `assets`)";
        }
    }
    TempFolder folder_;
};

TEST_F(Samples, HostEglShowsItsOwnDrawingAndViscera) {
    const std::string program = VISCERA_HOST_EGL;
    if (program.empty()) {
        GTEST_SKIP() << "host_egl is not built: libegl-dev is not there";
    }
    const auto file = folder_ / "egl.png";
    ASSERT_EQ(std::system((in_quotes(program) + " " + in_quotes(scene) + " " + in_quotes(file)).c_str()), 0);
    expect_both_halves(file);
    EXPECT_NE(std::system((in_quotes(program) + " missing.json " + in_quotes(file) + " 2>/dev/null").c_str()),
              0);
}

TEST_F(Samples, HostGlfwShowsItsOwnDrawingAndViscera) {
    const std::string program = VISCERA_HOST_GLFW;
    if (program.empty()) {
        GTEST_SKIP() << "host_glfw is not built: libglfw3-dev is not there";
    }
    const std::string& display = Xvfb::of_process().display();
    if (display.empty()) {
        GTEST_SKIP() << "no window tests: Xvfb is not there (Debian package xvfb)";
    }
    const auto file = folder_ / "glfw.png";
    // Sanitizers call what X11 and the driver keep a leak, since GLFW unloads both and their places with
    // them; no suppression names a library that is gone. The other host is looked at for leaks.
    ASSERT_EQ(std::system(("ASAN_OPTIONS=detect_leaks=0 DISPLAY=" + display + " " + in_quotes(program) + " " +
                           in_quotes(scene) + " 2 " + in_quotes(file))
                              .c_str()),
              0);
    expect_both_halves(file);
    EXPECT_NE(std::system(("env -u DISPLAY -u WAYLAND_DISPLAY " + in_quotes(program) + " " +
                           in_quotes(scene) + " 2>/dev/null")
                              .c_str()),
              0);
}

}  // namespace
}  // namespace viscera::test
