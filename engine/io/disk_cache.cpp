#include "engine/io/disk_cache.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "engine/core/content_hash.h"
#include "engine/core/error.h"
#include "engine/io/file_bytes.h"

namespace viscera::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view extension = ".vcache";
constexpr std::string_view unfinished = ".part";  // of write_file()
constexpr auto abandoned_after = std::chrono::hours(24);

/// What stands before the bytes of an entry; little-endian, as all of viscera.
struct Head {
    std::array<char, 8> magic{'v', 'i', 's', 'c', 'a', 'c', 'h', '1'};
    std::uint64_t key = 0;
    std::uint64_t size = 0;
    std::uint64_t checksum = 0;
    bool operator==(const Head&) const = default;
};

Head head_of(std::uint64_t key, std::span<const std::byte> bytes) {
    return {.key = key, .size = bytes.size(), .checksum = content_hash(bytes)};
}

struct Entry {
    fs::path file;
    fs::file_time_type used;
    std::uint64_t bytes = 0;
};

/// The entries of a folder, oldest use first. What others remove meanwhile is left out, as is what is not
/// ours; unfinished files of processes that died are removed.
std::vector<Entry> entries_of(const fs::path& folder) {
    std::vector<Entry> entries;
    const auto now = fs::file_time_type::clock::now();
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        // Two questions to the file system, which others may change in between: each has its own answer.
        std::error_code no_time;
        std::error_code no_size;
        const Entry entry{at->path(), at->last_write_time(no_time), at->file_size(no_size)};
        if (no_time || no_size) {
            continue;
        }
        const std::string name = entry.file.filename().string();
        if (name.ends_with(extension)) {
            entries.push_back(entry);
        } else if (name.find(extension) != std::string::npos && name.ends_with(unfinished) &&
                   now - entry.used > abandoned_after) {
            std::error_code ignored;  // another process may have been faster
            fs::remove(entry.file, ignored);
        }
    }
    std::ranges::sort(entries, {}, &Entry::used);
    return entries;
}

}  // namespace

DiskCache::DiskCache(fs::path folder, Log& log, std::uint64_t most_bytes)
    : folder_(std::move(folder)), log_(log), most_bytes_(most_bytes) {}

fs::path DiskCache::file_of(std::string_view kind, std::uint64_t key) const {
    std::array<char, 17> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(key));
    return folder_ / (std::string(kind) + "." + digits.data() + std::string(extension));
}

std::optional<std::vector<std::byte>> DiskCache::load(std::string_view kind, std::uint64_t key) const {
    if (!enabled()) {
        return std::nullopt;
    }
    const fs::path file = file_of(kind, key);
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in) {
        return std::nullopt;
    }
    const auto damaged = [&] {
        log_.fault("cache.damaged", file.string() + " is damaged; what it held is made anew");
        return std::nullopt;
    };
    Head head;
    // Of the file that is open: another process may have put a new one in its place.
    const auto file_bytes = static_cast<std::uint64_t>(in.tellg());
    in.seekg(0);
    if (!in.read(reinterpret_cast<char*>(&head), sizeof head) || head.size != file_bytes - sizeof head) {
        return damaged();
    }
    std::vector<std::byte> bytes(head.size);
    if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())) ||
        head != head_of(key, bytes)) {
        return damaged();
    }
    // Not the access time, which many file systems do not keep.
    std::error_code ignored;
    fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
    return bytes;
}

void DiskCache::store(std::string_view kind, std::uint64_t key, std::span<const std::byte> bytes) const {
    if (!enabled() || sizeof(Head) + bytes.size() > most_bytes_) {
        return;
    }
    try {
        if (fs::create_directories(folder_)) {
            fs::permissions(folder_, fs::perms::owner_all);
        }
        write(file_of(kind, key), key, bytes);
        make_room();
    } catch (const std::exception& error) {
        log_.fault("cache.write", std::string("nothing is kept in the cache: ") + error.what());
    }
}

void DiskCache::write(const fs::path& file, std::uint64_t key, std::span<const std::byte> bytes) const {
    const Head head = head_of(key, bytes);
    write_file(file, std::array{std::string_view(reinterpret_cast<const char*>(&head), sizeof head),
                                std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())});
}

void DiskCache::make_room() const {
    const std::vector<Entry> entries = entries_of(folder_);
    std::uint64_t total = 0;
    for (const Entry& entry : entries) {
        total += entry.bytes;
    }
    for (auto entry = entries.begin(); entry != entries.end() && total > most_bytes_; ++entry) {
        std::error_code ignored;  // another process may have been faster
        fs::remove(entry->file, ignored);
        total -= entry->bytes;
    }
}

}  // namespace viscera::io
