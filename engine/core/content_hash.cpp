#include "engine/core/content_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace viscera {

std::uint64_t content_hash(std::span<const std::byte> data) {
    return XXH3_64bits(data.data(), data.size());
}

}  // namespace viscera
