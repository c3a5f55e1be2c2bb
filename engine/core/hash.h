#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace viscera {

/// Incremental 64-bit FNV-1a with a final mix, for content keys: equal inputs give equal keys on every
/// machine. Not cryptographic.
class Hash {
  public:
    Hash& bytes(std::span<const std::byte> data) {
        for (const std::byte b : data) {
            state_ = (state_ ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3ULL;
        }
        return *this;
    }
    Hash& add(std::string_view text) {
        bytes(std::as_bytes(std::span(text)));
        return add(text.size());
    }
    /// Any value without padding: numbers, enumerations, GLM vectors and matrices.
    template <class T>
    requires std::is_trivially_copyable_v<T> Hash& add(const T& value) {
        return bytes(std::as_bytes(std::span(&value, 1)));
    }
    /// Never 0, so that 0 can stand for "no content".
    [[nodiscard]] std::uint64_t value() const {
        std::uint64_t x = state_;
        x = (x ^ (x >> 33)) * 0xff51afd7ed558ccdULL;
        x = (x ^ (x >> 33)) * 0xc4ceb9fe1a85ec53ULL;
        x ^= x >> 33;
        return x == 0 ? 1 : x;
    }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

}  // namespace viscera
