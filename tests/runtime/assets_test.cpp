#include "engine/runtime/assets.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "engine/core/log.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

/// As if a file had been written an hour later.
void grow_older(const std::filesystem::path& file) {
    std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + std::chrono::hours(1));
}

class AssetsTest : public testing::Test {
  protected:
    std::uint64_t key_now(const std::filesystem::path& file) {
        assets_.forget_files();
        return assets_.file_key(file);
    }
    Log log_;
    Assets assets_{log_};
    TempFolder folder_;
};

TEST_F(AssetsTest, AKeyTellsWhenAFileWasWritten) {
    std::set<std::uint64_t> keys;
    const auto file = folder_.write("a", "one");
    keys.insert(assets_.file_key(file));
    grow_older(file);
    keys.insert(assets_.file_key(file));
    EXPECT_EQ(keys.size(), 1U) << "a frame does not look at files";
    keys.insert(key_now(file));
    EXPECT_EQ(keys.size(), 2U) << "another time";
    const auto time = std::filesystem::last_write_time(file);
    (void)folder_.write("a", "three");
    std::filesystem::last_write_time(file, time);
    keys.insert(key_now(file));
    EXPECT_EQ(keys.size(), 3U) << "another size";
    keys.insert(key_now(file));
    EXPECT_EQ(keys.size(), 3U) << "nothing was written";
    std::filesystem::remove(file);
    keys.insert(key_now(file));
    EXPECT_EQ(keys.size(), 4U) << "it is gone";
    keys.insert(key_now(folder_ / "b"));
    keys.insert(key_now(""));
    EXPECT_EQ(keys.size(), 6U) << "others that are not there";
}

TEST_F(AssetsTest, AKeyOfAFolderTellsOfItsFiles) {
    std::set<std::uint64_t> keys;
    const auto one = folder_.write("1.png", "one");
    (void)folder_.write("2.png", "two");
    const auto time = std::filesystem::last_write_time(folder_.path());
    keys.insert(key_now(folder_.path()));
    grow_older(one);
    keys.insert(key_now(folder_.path()));
    EXPECT_EQ(keys.size(), 2U) << "a file was written";
    (void)folder_.write("3.png", "three");
    std::filesystem::last_write_time(folder_.path(), time);
    keys.insert(key_now(folder_.path()));
    EXPECT_EQ(keys.size(), 3U) << "a file has come";
    keys.insert(key_now(folder_.path()));
    EXPECT_EQ(keys.size(), 3U) << "nothing was written";
}

}  // namespace
}  // namespace viscera::test
