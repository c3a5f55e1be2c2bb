#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace viscera {
namespace {

// Linked, libGL and libOSMesa get in each other's way, and a host without one of them could not start.
TEST(Link, NoOpenGlLibraryIsNeededToStart) {
    const std::string command = "ldd '" + std::filesystem::read_symlink("/proc/self/exe").string() + "'";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
    ASSERT_NE(pipe, nullptr);
    std::string listed;
    std::array<char, 512> chunk{};
    while (std::fgets(chunk.data(), static_cast<int>(chunk.size()), pipe.get()) != nullptr) {
        listed += chunk.data();
    }
    ASSERT_NE(listed.find("libc.so"), std::string::npos) << listed;
    for (const char* name : {"libGL.", "libGLX", "libOpenGL", "libGLdispatch", "libEGL", "libOSMesa",
                             "libglfw", "libGLEW", "libepoxy"}) {
        EXPECT_EQ(listed.find(name), std::string::npos) << name << " in\n" << listed;
    }
}

}  // namespace
}  // namespace viscera
