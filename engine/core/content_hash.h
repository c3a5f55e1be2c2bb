#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace viscera {

/// 64 bits of what large data holds (voxels, files), at the speed of memory; the same on every machine
/// (XXH3). Not cryptographic. Keys made of several small things: Hash.
[[nodiscard]] std::uint64_t content_hash(std::span<const std::byte> data);

}  // namespace viscera
