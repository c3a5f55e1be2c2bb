#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace viscera::io {

/// The whole file. Throws Error(file) when it is missing, a folder, unreadable, or larger than `most_bytes`.
[[nodiscard]] std::string read_file(const std::filesystem::path& file,
                                    std::size_t most_bytes = std::size_t{4} << 30U);

/// Writes beside the final name and renames, so that a reader sees the old file, the whole new one, or none.
/// Throws Error(file) on a missing or unwritable folder or a full disk; nothing is then left behind.
void write_file(const std::filesystem::path& file, std::string_view bytes);
/// The same of parts, one after another.
void write_file(const std::filesystem::path& file, std::span<const std::string_view> parts);

/// The extension in lower case with its dot: ".exr"; empty when there is none.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& file);

}  // namespace viscera::io
