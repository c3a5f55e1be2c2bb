#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "engine/context/context.h"
#include "engine/context/context_info.h"
#include "engine/context/shared_library.h"
#include "engine/context/window.h"
#include "tests/context/environment.h"
#include "tests/context/offscreen.h"
#include "tests/core/error_of.h"

namespace viscera {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::ScopedVariable;
using testing::HasSubstr;

TEST(Refusal, GlfwWithoutADisplayNamesTheVariables) {
    const ScopedVariable display("DISPLAY", std::nullopt);
    const ScopedVariable wayland("WAYLAND_DISPLAY", std::nullopt);
    const auto error = error_of([] { (void)create_context(Backend::glfw); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::context);
    EXPECT_EQ(error->where(), "glfw");
    EXPECT_THAT(error->what(), HasSubstr("neither DISPLAY nor WAYLAND_DISPLAY is set"));
    EXPECT_THAT(error->what(), HasSubstr("xvfb-run"));
}

TEST(Refusal, AnEglDeviceThatIsNotThereNamesHowManyAre) {
    for (const int index : {-1, 99}) {
        ContextOptions options;
        options.egl_device = index;
        const auto error = error_of([&] { (void)create_context(Backend::egl_device, options); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::context);
        EXPECT_THAT(error->what(), HasSubstr("there is no EGL device " + std::to_string(index)));
        EXPECT_THAT(error->what(), HasSubstr("counted from 0"));
    }
}

TEST(Refusal, LeavesTheCurrentContextCurrent) {
    const auto kept = create_context(Backend::egl_surfaceless);
    const auto gl = gl::Functions::load(kept->proc_address());
    test::mark(*gl, 0.25F);
    ContextOptions options;
    options.egl_device = 99;
    EXPECT_THROW((void)create_context(Backend::egl_device, options), Error);
    options = {};
    options.require_hardware = true;
    EXPECT_THROW((void)create_context(Backend::osmesa, options),
                 Error);  // after its context was made current
    EXPECT_EQ(test::read_mark(*gl), 0.25F);
}

TEST(Refusal, SoftwareWhereHardwareIsRequired) {
    ContextOptions options;
    options.require_hardware = true;
    const auto error = error_of([&] { (void)create_context(Backend::osmesa, options); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::context);
    EXPECT_EQ(static_cast<int>(error->code()), 5);
    EXPECT_THAT(error->what(), HasSubstr("hardware is required"));
    EXPECT_THAT(error->what(), HasSubstr(create_context(Backend::osmesa)->info().renderer));
}

TEST(Refusal, HardwareIsNeverReportedOfSoftware) {
    ContextOptions options;
    options.require_hardware = true;
    std::vector<Refusal> refusals;
    try {
        const auto context = create_first_context(parse_backends("auto"), options, refusals);
        EXPECT_FALSE(context->info().software);
        EXPECT_EQ(context->info().renderer.find("llvmpipe"), std::string::npos);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::context);
        ASSERT_EQ(refusals.size(), 3U);
        for (const Refusal& refusal : refusals) {
            EXPECT_THAT(error.what(), HasSubstr(refusal.why));
            EXPECT_THAT(refusal.why, HasSubstr(std::string(to_string(refusal.backend))));
        }
    }
}

TEST(Refusal, TheNextBackendIsTakenAndTheReasonKept) {
    const ScopedVariable display("DISPLAY", std::nullopt);
    const ScopedVariable wayland("WAYLAND_DISPLAY", std::nullopt);
    std::vector<Refusal> refusals;
    const std::array order{Backend::glfw, Backend::current, Backend::osmesa};
    const auto context = create_first_context(order, {}, refusals);
    EXPECT_EQ(context->info().backend, Backend::osmesa);
    ASSERT_EQ(refusals.size(), 2U);
    EXPECT_EQ(refusals[0].backend, Backend::glfw);
    EXPECT_THAT(refusals[1].why, HasSubstr("wrap_current_context"));
}

TEST(Refusal, ALibraryThatIsNotThereNamesItsPackage) {
    const auto error = error_of([] {
        (void)SharedLibrary::open("osmesa", {"libviscera-none.so.8", "libviscera-none.so"},
                                  "install the Debian package libosmesa6");
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::context);
    EXPECT_THAT(error->what(), HasSubstr("libviscera-none.so.8"));
    EXPECT_THAT(error->what(), HasSubstr("install the Debian package libosmesa6"));
}

TEST(Refusal, ALibraryWithoutAFunctionNamesBoth) {
    const auto library = SharedLibrary::open("egl", {"libEGL.so.1"}, "");
    void (*function)() = nullptr;
    const auto error = error_of([&] { library.require("egl", "eglNoSuchThing", function); });
    ASSERT_TRUE(error);
    EXPECT_STREQ(error->what(), "egl: libEGL.so.1 lacks the function eglNoSuchThing");
}

// Mesa reads its version override once in a process, so this needs a process of its own.
TEST(RefusalDeathTest, ADriverBelow33) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    for (const Backend backend : {Backend::egl_surfaceless, Backend::osmesa}) {
        const ScopedVariable version("MESA_GL_VERSION_OVERRIDE", "3.1");
        EXPECT_EXIT(
            {
                const auto error = error_of([&] { (void)create_context(backend); });
                std::fputs(error ? error->what() : "not refused", stderr);
                std::_Exit(error ? static_cast<int>(error->code()) : 0);
            },
            testing::ExitedWithCode(5), "no OpenGL 3.3 core context|OpenGL 3.3 core is needed");
    }
}

class NvidiaRemark : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(root_ / "dev"); }
    void TearDown() override { fs::remove_all(root_); }
    void put(const fs::path& file) const {
        fs::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << "x";
    }
    // One folder a test: they run side by side.
    fs::path root_ =
        fs::path(testing::TempDir()) / (std::string("viscera_nvidia_remark_") +
                                        testing::UnitTest::GetInstance()->current_test_info()->name());

  private:
    ScopedVariable files_{"__EGL_VENDOR_LIBRARY_FILENAMES", std::nullopt};
    ScopedVariable folders_{"__EGL_VENDOR_LIBRARY_DIRS", std::nullopt};
};

TEST_F(NvidiaRemark, NothingToSayWithoutTheDevice) {
    EXPECT_EQ(nvidia_remark(root_), "");
}

TEST_F(NvidiaRemark, DeviceWithoutVendorFileIsSaid) {
    put("dev/nvidiactl");
    put("usr/share/glvnd/egl_vendor.d/50_mesa.json");
    EXPECT_THAT(nvidia_remark(root_), HasSubstr("no EGL vendor file"));
}

TEST_F(NvidiaRemark, NothingToSayWithBoth) {
    put("dev/nvidiactl");
    put("usr/share/glvnd/egl_vendor.d/10_nvidia.json");
    EXPECT_EQ(nvidia_remark(root_), "");
}

TEST(SoftwareRenderer, IsToldByName) {
    for (const char* name : {"llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "Software Rasterizer",
                             "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device))", "zink (llvmpipe)"}) {
        EXPECT_TRUE(is_software_renderer(name)) << name;
    }
    for (const char* name : {"NVIDIA H200/PCIe/SSE2", "Mesa Intel(R) UHD Graphics 630 (CFL GT2)",
                             "AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6)", ""}) {
        EXPECT_FALSE(is_software_renderer(name)) << name;
    }
}

}  // namespace
}  // namespace viscera
