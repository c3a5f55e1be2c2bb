#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace viscera::fuzz {
namespace {

using namespace std::string_view_literals;

constexpr std::array<std::string_view, 26> words{"\0\0\0\0"sv,
                                                 "\xff\xff\xff\xff"sv,
                                                 "\xff\xff\xff\x7f"sv,
                                                 "\x00\x00\x00\x80"sv,
                                                 "\x00\x00\xc0\x7f"sv,
                                                 "\x00\x00\x80\x7f"sv,
                                                 "\0"sv,
                                                 "\xff"sv,
                                                 "\n"sv,
                                                 "-1"sv,
                                                 "0"sv,
                                                 "4294967296"sv,
                                                 "9223372036854775807"sv,
                                                 "99999999999999999999"sv,
                                                 "1e999"sv,
                                                 "-1e-999"sv,
                                                 "nan"sv,
                                                 "inf"sv,
                                                 "\""sv,
                                                 "{"sv,
                                                 "["sv,
                                                 "}"sv,
                                                 "<"sv,
                                                 "/"sv,
                                                 "\xed\xa0\x80"sv,
                                                 "\xf0\x9f\x98\x80"sv};

/// Not std::uniform_int_distribution, whose numbers differ between libraries.
std::size_t below(std::mt19937& random, std::size_t end) {
    return end == 0 ? 0 : random() % end;
}

void damage(std::string& bytes, std::span<const std::string> seeds, std::mt19937& random) {
    const std::size_t at = below(random, bytes.size() + 1);
    const std::size_t length = below(random, std::min<std::size_t>(bytes.size() - at, 40) + 1);
    switch (random() % 8) {
        case 0:
            if (at < bytes.size()) {
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
            }
            return;
        case 1:
            bytes.resize(at);
            return;
        case 2:
            bytes.erase(at, length);
            return;
        case 3:
            bytes.insert(at, bytes.substr(at, length));
            return;
        case 4:
            bytes.replace(at, std::min<std::size_t>(length, 8), words[below(random, words.size())]);
            return;
        case 5: {
            const std::string_view word = words[below(random, words.size())];
            bytes.replace(at, std::min(word.size(), bytes.size() - at), word);
            return;
        }
        case 6: {
            const std::string& other = seeds[below(random, seeds.size())];
            const std::size_t from = below(random, other.size() + 1);
            bytes.insert(at, other.substr(from, 1 + below(random, 60)));
            return;
        }
        default:
            if (at < bytes.size()) {
                bytes[at] = static_cast<char>(random());
            }
            return;
    }
}

}  // namespace

std::string mutate(std::span<const std::string> seeds, std::mt19937& random) {
    std::string bytes = seeds[below(random, seeds.size())];
    for (std::size_t changes = 1 + below(random, 6); changes > 0; --changes) {
        damage(bytes, seeds, random);
    }
    return bytes;
}

}  // namespace viscera::fuzz
