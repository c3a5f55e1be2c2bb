#include "engine/io/vtk_data.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace viscera::io {

namespace {

template <class T>
T load_number(const char* bytes, bool big_endian) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (big_endian != (std::endian::native == std::endian::big)) {
        std::ranges::reverse(raw);
    }
    return std::bit_cast<T>(raw);
}

template <class T>
std::vector<double> widen(std::string_view bytes, bool big_endian) {
    if (bytes.size() % sizeof(T) != 0) {
        throw std::runtime_error("an array ends within a value");
    }
    std::vector<double> values(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<double>(load_number<T>(bytes.data() + i * sizeof(T), big_endian));
    }
    return values;
}

std::vector<double> widen(std::string_view bytes, std::string_view type, bool big_endian) {
    using Widen = std::vector<double> (*)(std::string_view, bool);
    struct Type {
        std::string_view name;
        Widen widen;
    };
    static constexpr std::array<Type, 10> types{{{"Float32", widen<float>},
                                                 {"Float64", widen<double>},
                                                 {"Int8", widen<std::int8_t>},
                                                 {"UInt8", widen<std::uint8_t>},
                                                 {"Int16", widen<std::int16_t>},
                                                 {"UInt16", widen<std::uint16_t>},
                                                 {"Int32", widen<std::int32_t>},
                                                 {"UInt32", widen<std::uint32_t>},
                                                 {"Int64", widen<std::int64_t>},
                                                 {"UInt64", widen<std::uint64_t>}}};
    const auto* const found = std::ranges::find(types, type, &Type::name);
    if (found == types.end()) {
        throw std::runtime_error("type '" + std::string(type) + "' is unknown");
    }
    return found->widen(bytes, big_endian);
}

/// Takes unsigned integers of the header's width off the front of an array.
class HeaderReader {
  public:
    HeaderReader(std::string_view bytes, const VtkEncoding& encoding) : bytes_(bytes), encoding_(encoding) {}

    std::size_t next() {
        const std::size_t width = encoding_.header_64bit ? 8 : 4;
        if (bytes_.size() < width) {
            throw std::runtime_error("an array is cut off");
        }
        const std::uint64_t value = encoding_.header_64bit
                                        ? load_number<std::uint64_t>(bytes_.data(), encoding_.big_endian)
                                        : load_number<std::uint32_t>(bytes_.data(), encoding_.big_endian);
        bytes_.remove_prefix(width);
        return value;
    }
    [[nodiscard]] std::string_view rest() const { return bytes_; }

  private:
    std::string_view bytes_;
    const VtkEncoding& encoding_;
};

void unpack_block(std::string_view packed, std::size_t size, std::string& out) {
    constexpr std::size_t best_compression = 1100;  // zlib's own limit is 1032
    if (size / best_compression > packed.size() + 1) {
        throw std::runtime_error("a packed array claims more than its bytes can hold");
    }
    const std::size_t before = out.size();
    out.resize(before + size);
    uLongf got = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(out.data() + before), &got,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (status != Z_OK || got != size) {
        throw std::runtime_error("a packed array is damaged");
    }
}

std::string unpack(std::string_view bytes, const VtkEncoding& encoding) {
    HeaderReader header(bytes, encoding);
    const std::size_t blocks = header.next();
    const std::size_t block_size = header.next();
    const std::size_t last_size = header.next();
    if (blocks > bytes.size()) {
        throw std::runtime_error("a packed array is cut off");
    }
    std::vector<std::size_t> packed_sizes(blocks);
    for (std::size_t& size : packed_sizes) {
        size = header.next();
    }
    std::string_view rest = header.rest();
    std::string out;
    for (std::size_t b = 0; b < blocks; ++b) {
        if (packed_sizes[b] > rest.size()) {
            throw std::runtime_error("a packed array is cut off");
        }
        const bool partial = b + 1 == blocks && last_size != 0;
        unpack_block(rest.substr(0, packed_sizes[b]), partial ? last_size : block_size, out);
        rest.remove_prefix(packed_sizes[b]);
    }
    return out;
}

int base64_value(char c) {
    if (c >= 'A' && c <= 'Z') {
        return c - 'A';
    }
    if (c >= 'a' && c <= 'z') {
        return c - 'a' + 26;
    }
    if (c >= '0' && c <= '9') {
        return c - '0' + 52;
    }
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

bool is_space(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

}  // namespace

std::vector<double> parse_vtk_text(std::string_view text) {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
        at = std::find_if_not(at, end, is_space);
        if (at == end) {
            return values;
        }
        double value = 0.0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc{} || (next != end && !is_space(*next))) {
            throw std::runtime_error(
                "'" + std::string(at, std::find_if(at, std::min(end, at + 20), is_space)) + "' is no number");
        }
        values.push_back(value);
        at = next;
    }
}

std::string decode_base64(std::string_view text) {
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t bits = 0;
    int digits = 0;
    const auto flush = [&] {
        for (int b = 0; b + 1 < digits; ++b) {
            bytes.push_back(static_cast<char>((bits >> (6 * digits - 8 * (b + 1))) & 0xFFU));
        }
        bits = 0;
        digits = 0;
    };
    for (const char c : text) {
        const int value = base64_value(c);
        if (value >= 0) {
            bits = (bits << 6U) | static_cast<std::uint32_t>(value);
            if (++digits == 4) {
                flush();
            }
        } else if (c == '=') {
            flush();
        } else if (!is_space(c)) {
            throw std::runtime_error("base64 text holds another character");
        }
    }
    flush();
    return bytes;
}

std::string decode_vtk_bytes(std::string_view bytes, const VtkEncoding& encoding) {
    if (encoding.zlib) {
        return unpack(bytes, encoding);
    }
    HeaderReader header(bytes, encoding);
    const std::size_t size = header.next();
    if (size > header.rest().size()) {
        throw std::runtime_error("an array is cut off");
    }
    return std::string(header.rest().substr(0, size));
}

std::vector<double> decode_vtk_array(std::string_view bytes, std::string_view type,
                                     const VtkEncoding& encoding) {
    return widen(decode_vtk_bytes(bytes, encoding), type, encoding.big_endian);
}

}  // namespace viscera::io
