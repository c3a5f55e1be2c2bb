#include "engine/io/disk_cache.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <iostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

namespace fs = std::filesystem;
using io::DiskCache;
using testing::HasSubstr;

std::vector<std::byte> bytes_like(std::size_t count, unsigned seed) {
    std::vector<std::byte> bytes(count);
    for (std::size_t i = 0; i < count; ++i) {
        bytes[i] = static_cast<std::byte>((i * 31U + seed * 7U) & 255U);
    }
    return bytes;
}

class DiskCacheTest : public testing::Test {
  protected:
    [[nodiscard]] DiskCache cache(std::uint64_t most_bytes = DiskCache::default_most_bytes) {
        return {folder_ / "cache", log_, most_bytes};
    }
    [[nodiscard]] std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        if (fs::exists(folder_ / "cache")) {
            for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
                found.push_back(entry.path());
            }
        }
        return found;
    }
    void make_older(std::string_view part_of_name, std::chrono::hours by) {
        for (const fs::path& file : files()) {
            if (file.filename().string().find(part_of_name) != std::string::npos) {
                fs::last_write_time(file, fs::last_write_time(file) - by);
            }
        }
    }
    [[nodiscard]] std::uint64_t faults(std::string_view key) const {
        const auto all = log_.faults();
        const auto found = all.find(key);
        return found == all.end() ? 0 : found->second;
    }

    TempFolder folder_;
    std::string said_;
    Log log_{[this](LogLevel, std::string_view message) { said_ += std::string(message) + "\n"; }};
};

TEST_F(DiskCacheTest, GivesBackWhatWasStored) {
    EXPECT_EQ(cache().load("a", 1), std::nullopt);
    const auto first = bytes_like(1000, 1);
    const auto second = bytes_like(77, 2);
    const std::vector<std::byte> nothing;
    cache().store("a", 1, first);
    cache().store("a", 2, second);
    cache().store("b", 1, nothing);
    EXPECT_EQ(cache().load("a", 1), first);
    EXPECT_EQ(cache().load("a", 2), second);
    EXPECT_EQ(cache().load("b", 1), nothing);
    EXPECT_EQ(cache().load("b", 2), std::nullopt);
    cache().store("a", 1, second);
    EXPECT_EQ(cache().load("a", 1), second);
    EXPECT_EQ(files().size(), 3U);
    EXPECT_TRUE(log_.faults().empty()) << said_;
}

TEST_F(DiskCacheTest, WithoutAFolderNothingIsKept) {
    const DiskCache off({}, log_);
    EXPECT_FALSE(off.enabled());
    off.store("a", 1, bytes_like(10, 1));
    EXPECT_EQ(off.load("a", 1), std::nullopt);
    EXPECT_TRUE(log_.faults().empty());
}

TEST_F(DiskCacheTest, TheFolderIsMadeWithTheFirstEntryForTheUserAlone) {
    const DiskCache made = cache();
    EXPECT_EQ(made.load("a", 1), std::nullopt);
    EXPECT_FALSE(fs::exists(folder_ / "cache"));
    made.store("a", 1, bytes_like(10, 1));
    EXPECT_EQ(fs::status(folder_ / "cache").permissions(), fs::perms::owner_all);
}

TEST_F(DiskCacheTest, WhateverIsDamagedCountsAsAbsent) {
    const auto bytes = bytes_like(500, 3);
    cache().store("a", 1, bytes);
    const fs::path file = files().at(0);
    const std::string whole = slurp(file);
    const auto damaged = [&](const std::string& content) {
        const std::uint64_t before = faults("cache.damaged");
        std::ofstream(file, std::ios::binary) << content;
        EXPECT_EQ(cache().load("a", 1), std::nullopt);
        EXPECT_EQ(faults("cache.damaged"), before + 1);
    };
    for (std::size_t at = 0; at < whole.size(); at += at < 40 ? 1 : 23) {
        std::string content = whole;
        content[at] = static_cast<char>(content[at] ^ 4);
        damaged(content);
        damaged(whole.substr(0, at));
    }
    damaged(whole + "x");
    EXPECT_THAT(said_, HasSubstr(file.string() + " is damaged"));
    cache().store("a", 1, bytes);
    EXPECT_EQ(cache().load("a", 1), bytes);
}

TEST_F(DiskCacheTest, AnEntryUnderAnotherNameIsNotTaken) {
    cache().store("a", 1, bytes_like(100, 1));
    const fs::path one = files().at(0);
    cache().store("a", 2, bytes_like(100, 2));
    for (const fs::path& file : files()) {
        if (file != one) {
            fs::copy_file(one, file, fs::copy_options::overwrite_existing);
        }
    }
    EXPECT_TRUE(cache().load("a", 1).has_value());
    EXPECT_EQ(cache().load("a", 2), std::nullopt);
}

TEST_F(DiskCacheTest, AFolderThatCannotBeWrittenIsSaidOnce) {
    std::ofstream(folder_ / "cache") << "a file, no folder";
    const DiskCache here = cache();
    here.store("a", 1, bytes_like(10, 1));
    here.store("a", 2, bytes_like(10, 1));
    EXPECT_EQ(here.load("a", 1), std::nullopt);
    EXPECT_EQ(faults("cache.write"), 2U);
    EXPECT_EQ(said_.find("nothing is kept in the cache"), said_.rfind("nothing is kept in the cache"));
    EXPECT_THAT(said_, HasSubstr((folder_ / "cache").string()));
}

TEST_F(DiskCacheTest, WhatLiesUnusedForLongestGoesFirst) {
    const DiskCache small = cache(3500);  // three entries of 1000 bytes
    for (const std::uint64_t key : {1, 2, 3}) {
        small.store("a", key, bytes_like(1000, static_cast<unsigned>(key)));
        make_older(".000000000000000" + std::to_string(key), std::chrono::hours(10 - key));
    }
    EXPECT_TRUE(small.load("a", 1).has_value());  // now the newest
    small.store("a", 4, bytes_like(1000, 4));
    EXPECT_EQ(small.load("a", 2), std::nullopt);
    EXPECT_TRUE(small.load("a", 1).has_value());
    EXPECT_TRUE(small.load("a", 3).has_value());
    EXPECT_TRUE(small.load("a", 4).has_value());
    small.store("a", 5, bytes_like(4000, 5));
    EXPECT_EQ(small.load("a", 5), std::nullopt) << "larger than all that may be kept";
    EXPECT_EQ(files().size(), 3U);
    EXPECT_TRUE(log_.faults().empty()) << said_;
}

TEST_F(DiskCacheTest, WhatOthersLeaveInTheFolderStaysButForRestsOfDeadProcesses) {
    cache().store("a", 1, bytes_like(10, 1));
    std::ofstream(folder_ / "cache/notes.txt") << std::string(9000, 'x');
    std::ofstream(folder_ / "cache/.a.0000000000000001.vcache.1234.part") << "old";
    make_older(".part", std::chrono::hours(48));
    std::ofstream(folder_ / "cache/.a.0000000000000002.vcache.1234.part") << "being written";
    cache(200).store("a", 3, bytes_like(10, 1));
    EXPECT_TRUE(fs::exists(folder_ / "cache/notes.txt"));
    EXPECT_FALSE(fs::exists(folder_ / "cache/.a.0000000000000001.vcache.1234.part"));
    EXPECT_TRUE(fs::exists(folder_ / "cache/.a.0000000000000002.vcache.1234.part"));
    EXPECT_TRUE(cache().load("a", 1).has_value());
}

TEST_F(DiskCacheTest, ProcessesThatShareAFolderSeeWholeEntriesOrNone) {
    constexpr int processes = 3;
    constexpr int rounds = 60;
    std::vector<pid_t> children;
    for (unsigned process = 0; process < processes; ++process) {
        const pid_t child = fork();
        if (child == 0) {
            int wrong = 0;
            // So small that they also remove each other's entries.
            const DiskCache shared(folder_ / "cache", log_, 400000);
            for (unsigned round = 0; round < rounds; ++round) {
                const std::uint64_t key = round % 5;
                shared.store("a", key, bytes_like(100000 + 1000 * process, process));
                const auto got = shared.load("a", key);
                bool known = !got;
                for (unsigned writer = 0; writer < processes && got; ++writer) {
                    known = known || *got == bytes_like(100000 + 1000 * writer, writer);
                }
                wrong += known ? 0 : 1;
            }
            std::cerr << said_ << (wrong == 0 ? "" : std::to_string(wrong) + " entries are nobody's\n");
            _exit(wrong == 0 && log_.faults().empty() ? 0 : 1);
        }
        children.push_back(child);
    }
    for (const pid_t child : children) {
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    for (const fs::path& file : files()) {
        EXPECT_EQ(file.extension(), ".vcache") << file;
    }
}

}  // namespace
}  // namespace viscera::test
