#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/io/volume_head.h"

namespace viscera::io {

// Fields of text headers. `field` names the field in errors; all throw Error(file).

[[nodiscard]] std::string_view trim(std::string_view text);
[[nodiscard]] std::string lower(std::string_view text);
/// At most 40 characters of a text from a file, others than printable ASCII as '?': fit for a message.
[[nodiscard]] std::string printable(std::string_view text);

/// Numbers parted by white space; at least one.
[[nodiscard]] std::vector<double> numbers_of(std::string_view text, std::string_view field,
                                             const Reading& reading);
[[nodiscard]] double one_number(std::string_view text, std::string_view field, const Reading& reading);
/// A whole number within [low, high].
[[nodiscard]] double whole_number(std::string_view text, std::string_view field, double low, double high,
                                  const Reading& reading);
/// Sizes of the first three axes; axes that are missing are 1.
[[nodiscard]] glm::ivec3 dims_of(std::span<const double> sizes, std::string_view field,
                                 const Reading& reading);

/// Files of slices that are numbered.
struct NumberedFiles {
    std::string before;  ///< of the number
    std::string after;
    std::size_t width = 0;  ///< to which numbers are filled up
    bool zeros = false;     ///< with zeros in place of blanks
    int first = 0;
    int last = 0;
    int step = 1;

    [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>((last - first) / step) + 1; }
    [[nodiscard]] std::string name(std::size_t file) const;
};
/// Names of slices as a pattern, which libraries hand to printf and count by: `text` must be a name with one
/// %d, perhaps of a width, and the first number, the last and the step.
[[nodiscard]] NumberedFiles numbered_files(std::string_view text, std::string_view field,
                                           const Reading& reading);

/// Throws Error(file) when not even the whole folder of the file could hold the voxels packed, and
/// Error(limit) when memory cannot: for voxels that a library reads from places of its own.
void require_plausible(const VolumeHead& head, const Reading& reading);

}  // namespace viscera::io
