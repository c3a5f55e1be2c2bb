#include "engine/io/volume_text.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "engine/io/volume_readers.h"
#include "engine/io/words.h"

namespace viscera::io {

std::string_view trim(std::string_view text) {
    constexpr std::string_view space = " \t\r\n\f\v";
    const std::size_t first = text.find_first_not_of(space);
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(space) - first + 1);
}

std::string lower(std::string_view text) {
    std::string result(text);
    std::ranges::transform(result, result.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return result;
}

std::string printable(std::string_view text) {
    constexpr std::size_t most = 40;
    std::string result(text.substr(0, most));
    std::ranges::replace_if(
        result, [](char c) { return c < ' ' || c > '~'; }, '?');
    return result;
}

std::vector<double> numbers_of(std::string_view text, std::string_view field, const Reading& reading) {
    std::vector<double> numbers;
    for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
        const std::optional<double> number = to_number(word);
        if (!number) {
            reading.fail(std::string(field) + ": '" + printable(word) + "' is no number");
        }
        numbers.push_back(*number);
    }
    if (numbers.empty()) {
        reading.fail(std::string(field) + " is missing");
    }
    return numbers;
}

std::string NumberedFiles::name(std::size_t file) const {
    std::string digits = std::to_string(first + static_cast<int>(file) * step);
    digits.insert(0, width > digits.size() ? width - digits.size() : 0, zeros ? '0' : ' ');
    return before + digits + after;
}

NumberedFiles numbered_files(std::string_view text, std::string_view field, const Reading& reading) {
    std::string_view rest = text;
    const std::string_view pattern = take_word(rest);
    const std::size_t percent = pattern.find('%');
    const std::size_t kind =
        pattern.find_first_not_of("0123456789", std::min(percent, pattern.size() - 1) + 1);
    const bool one = percent != std::string_view::npos && kind != std::string_view::npos &&
                     kind < percent + 5 && pattern[kind] == 'd' &&
                     pattern.find('%', kind) == std::string_view::npos;
    const std::vector<double> numbers = one ? numbers_of(rest, field, reading) : std::vector<double>{};
    constexpr double most = 1e6;
    const bool whole =
        std::ranges::all_of(numbers, [](double n) { return n == std::floor(n) && n >= 0.0 && n <= most; });
    const bool counts = numbers.size() == 3 && numbers[0] <= numbers[1] && numbers[2] >= 1.0;
    if (!one || !whole || !counts) {
        reading.fail(std::string(field) + ": '" + printable(text) +
                     "' is no name with one %d and the numbers of the first file, the last and the step");
    }
    const std::string width(pattern.substr(percent + 1, kind - percent - 1));
    return {.before = std::string(pattern.substr(0, percent)),
            .after = std::string(pattern.substr(kind + 1)),
            .width = width.empty() ? 0 : static_cast<std::size_t>(std::stoi(width)),
            .zeros = width.starts_with('0'),
            .first = static_cast<int>(numbers[0]),
            .last = static_cast<int>(numbers[1]),
            .step = static_cast<int>(numbers[2])};
}

double one_number(std::string_view text, std::string_view field, const Reading& reading) {
    const std::vector<double> numbers = numbers_of(text, field, reading);
    if (numbers.size() != 1) {
        reading.fail(std::string(field) + ": '" + printable(text) + "' is not one number");
    }
    return numbers[0];
}

double whole_number(std::string_view text, std::string_view field, double low, double high,
                    const Reading& reading) {
    const double number = one_number(text, field, reading);
    if (!(number >= low && number <= high) || number != std::floor(number)) {
        reading.fail(std::string(field) + ": '" + printable(text) + "' is out of range");
    }
    return number;
}

glm::ivec3 dims_of(std::span<const double> sizes, std::string_view field, const Reading& reading) {
    constexpr double most = 5e8;  // four times that still is an int
    glm::ivec3 dims(1);
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
        if (!(sizes[axis] >= 1.0 && sizes[axis] <= most) || sizes[axis] != std::floor(sizes[axis])) {
            reading.fail(std::string(field) + ": the size of an axis is no whole number from 1 to 5e8");
        }
        if (axis < 3) {
            dims[static_cast<int>(axis)] = static_cast<int>(sizes[axis]);
        }
    }
    return dims;
}

void require_plausible(const VolumeHead& head, const Reading& reading) {
    constexpr std::uint64_t best_compression = 1100;
    const std::uint64_t due = head.bytes(reading);
    std::uint64_t there = 0;
    std::error_code ignored;
    const std::filesystem::path folder = std::filesystem::absolute(reading.file, ignored).parent_path();
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        if (entry.is_regular_file(ignored)) {
            const std::uint64_t size = entry.file_size(ignored);
            there += ignored ? 0 : size;
        }
    }
    if (due / best_compression > there) {
        reading.fail("lies about its size: needs " + std::to_string(due) + " bytes of voxels");
    }
    require_memory(head, due, reading);
}

std::string first_bytes(const std::filesystem::path& file, std::size_t size) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
        return {};
    }
    std::ifstream stream(file, std::ios::binary);
    const std::uintmax_t there = std::filesystem::file_size(file, ignored);
    std::string bytes(ignored ? 0 : std::min<std::uintmax_t>(size, there), '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return bytes;
}

}  // namespace viscera::io
