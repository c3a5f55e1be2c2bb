#include "engine/io/file_bytes.h"

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

/// The names of what is made in a folder while this lives, in order.
class Births {
  public:
    explicit Births(const std::filesystem::path& folder) {
        EXPECT_GE(inotify_add_watch(queue_, folder.c_str(), IN_CREATE), 0);
    }
    Births(const Births&) = delete;
    Births& operator=(const Births&) = delete;
    ~Births() { ::close(queue_); }

    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> names;
        std::array<char, 65536> events{};
        for (ssize_t bytes = 0; (bytes = ::read(queue_, events.data(), events.size())) > 0;) {
            for (std::size_t at = 0; at < static_cast<std::size_t>(bytes);) {
                inotify_event event{};
                std::memcpy(&event, events.data() + at, sizeof event);
                names.emplace_back(events.data() + at + sizeof event);
                at += sizeof event + event.len;
            }
        }
        return names;
    }

  private:
    int queue_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
};

// Whoever clears away what a dead process left must not hit the next file by the same name.
TEST(FileBytesTest, UnfinishedFilesHaveNoNameASecondTime) {
    constexpr std::size_t files = 50;
    const TempFolder folder;
    const Births births(folder / "");
    for (std::size_t i = 0; i < files; ++i) {
        io::write_file(folder / "same.txt", std::to_string(i));
    }
    const std::vector<std::string> names = births.names();
    EXPECT_EQ(names.size(), files);
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), files) << names.front();
    EXPECT_EQ(io::read_file(folder / "same.txt"), std::to_string(files - 1));
}

TEST(FileBytesTest, NothingIsLeftBesideAFileThatCannotBeWritten) {
    const TempFolder folder;
    std::filesystem::create_directories(folder / "taken" / "by a folder");
    EXPECT_THROW(io::write_file(folder / "taken", "bytes"), Error);
    std::vector<std::filesystem::path> left;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
        left.push_back(entry.path().filename());
    }
    EXPECT_EQ(left, std::vector<std::filesystem::path>{"taken"});
}

}  // namespace
}  // namespace viscera::test
