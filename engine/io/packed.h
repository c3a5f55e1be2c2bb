#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace viscera::io {

/// Numbers, structs of numbers without padding, and lists of them, one after another: what goes to the disk
/// cache.
class Packer {
  public:
    template <class T>
    requires std::is_trivially_copyable_v<T> Packer& add(const T& value) {
        return append(std::as_bytes(std::span(&value, 1)));
    }
    template <class T>
    Packer& add(const std::vector<T>& values) {
        add(static_cast<std::uint64_t>(values.size()));
        return append(std::as_bytes(std::span(values)));
    }
    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

  private:
    Packer& append(std::span<const std::byte> bytes) {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        return *this;
    }
    std::vector<std::byte> bytes_;
};

/// Reads them back in the same order.
class Unpacker {
  public:
    explicit Unpacker(std::span<const std::byte> bytes) : left_(bytes) {}

    template <class T>
    requires std::is_trivially_copyable_v<T> Unpacker& read(T& value) {
        take(&value, sizeof value);
        return *this;
    }
    template <class T>
    Unpacker& read(std::vector<T>& values) {
        std::uint64_t count = 0;
        read(count);
        if (count > left_.size() / sizeof(T)) {
            whole_ = false;
            return *this;
        }
        values.resize(static_cast<std::size_t>(count));
        take(values.data(), values.size() * sizeof(T));
        return *this;
    }
    /// Whether all that was asked for was there, and nothing is left.
    [[nodiscard]] bool complete() const { return whole_ && left_.empty(); }

  private:
    void take(void* to, std::size_t bytes) {
        if (bytes > left_.size()) {
            whole_ = false;
            return;
        }
        if (bytes > 0) {
            std::memcpy(to, left_.data(), bytes);
        }
        left_ = left_.subspan(bytes);
    }

    std::span<const std::byte> left_;
    bool whole_ = true;
};

}  // namespace viscera::io
