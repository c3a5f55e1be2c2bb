#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/log.h"

namespace viscera::io {

/// A folder that keeps what was long in the making, beyond the process: each entry is a file known by its
/// kind and by a hash of everything it is made from. A cache never fails: what is damaged counts as absent,
/// what cannot be written is not kept, and both are said once, as faults of the log. Processes may share a
/// folder: entries are written beside and renamed, so a reader sees a whole one or none. Entries are readable
/// by the user alone if the folder is made here, since they may hold a patient's data.
class DiskCache {
  public:
    /// What the folder's entries may take together [bytes], unless said otherwise.
    static constexpr std::uint64_t default_most_bytes = std::uint64_t{4} << 30U;

    /// folder empty: nothing is kept. The folder is made with the first entry. `log` outlives the cache.
    DiskCache(std::filesystem::path folder, Log& log, std::uint64_t most_bytes = default_most_bytes);

    [[nodiscard]] bool enabled() const { return !folder_.empty(); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

    /// The bytes stored last under kind and key; none when there are none or they are damaged. `kind`: a word
    /// of [a-z0-9_-] which also names the version of what the bytes mean ("bspline-1"); a reader must still
    /// check their size.
    [[nodiscard]] std::optional<std::vector<std::byte>> load(std::string_view kind, std::uint64_t key) const;
    /// Keeps the bytes; then the entries that lie unused for longest go until the rest is within the limit.
    /// What is larger than the limit is not kept.
    void store(std::string_view kind, std::uint64_t key, std::span<const std::byte> bytes) const;

  private:
    [[nodiscard]] std::filesystem::path file_of(std::string_view kind, std::uint64_t key) const;
    void write(const std::filesystem::path& file, std::uint64_t key, std::span<const std::byte> bytes) const;
    void make_room() const;

    std::filesystem::path folder_;
    Log& log_;
    std::uint64_t most_bytes_;
};

}  // namespace viscera::io
